"""The coverage of traffic laws by a campaign: the ways to violate them that some run showed.

It is read from the verdicts of the laws, which judge the runs of every method.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from drivora_service.oracles.verdict import Outcome, Verdict


def law_coverage(verdicts: Iterable[Verdict]) -> float | None:
    """Returns the share of the sub-violations of all laws that some run covered.

    Args:
        verdicts: Of all oracles on all runs.

    Returns:
        0 to 1; ``None`` if no law has judged.
    """
    ways: dict[str, int] = {}
    covered: set[tuple[str, str]] = set()
    for verdict in verdicts:
        number = verdict.evidence.get("ways")
        if not isinstance(number, int):
            continue
        ways[verdict.oracle] = number
        shown = verdict.evidence.get("sub_violations", ())
        covered.update((verdict.oracle, str(way)) for way in shown)
    return len(covered) / sum(ways.values()) if ways else None


def law_verdicts(verdicts: Iterable[Verdict]) -> tuple[Verdict, ...]:
    """Returns what :func:`law_coverage` needs of verdicts; equal ones are one object.

    The evaluations of hundreds of campaigns must fit in memory.
    """
    found: dict[int, Verdict] = {}
    for verdict in verdicts:
        ways = verdict.evidence.get("ways")
        if isinstance(ways, int):
            shown = verdict.evidence.get("sub_violations", ())
            short = _short(verdict.oracle, ways, tuple(map(str, shown)))
            found[id(short)] = short
    return tuple(found.values())


@lru_cache(maxsize=4096)
def _short(oracle: str, ways: int, shown: tuple[str, ...]) -> Verdict:
    evidence = {"ways": ways, "sub_violations": shown}
    outcome = Outcome.VIOLATED if shown else Outcome.PASSED
    return Verdict(oracle=oracle, ego="", outcome=outcome, message="", evidence=evidence)
