"""Verdicts of two judgements of a run, compared by oracle and ego."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.oracles.verdict import Answer, Outcome
from drivora_service.oracles.verdicts.accountability import IN_WORDS, accountable
from drivora_service.shapes import Shape

NOT_JUDGED = "not judged"
"""Instead of a verdict, where the oracle gave none."""
NOT_INSTALLED = "not installed"
"""In place of a verdict of an oracle that is not there any more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictChange(Shape):
    """An oracle whose verdict on an ego differs.

    Attributes:
        before: In words; ``not judged`` if there was no such oracle.
        after: In words; ``not judged`` if the oracle gave no verdict, ``not installed`` if there is
            no such oracle any more.
    """

    oracle: str
    ego: str
    before: str
    after: str


def verdict_changes(
    before: Iterable[Mapping[str, Any]],
    after: Iterable[Mapping[str, Any]],
    *,
    installed: Collection[str] | None = None,
) -> tuple[VerdictChange, ...]:
    """Returns the changes from one list of verdicts to another.

    Args:
        before: Verdicts as the values of their JSON; keys that older versions lack may be missing.
        after: The others, likewise.
        installed: Names of the oracles of the later judgement; ``None``: not known.
    """

    def missing(oracle: str) -> str:
        return NOT_JUDGED if installed is None or oracle in installed else NOT_INSTALLED

    old, new = _in_words(before), _in_words(after)
    pairs = [
        (key, old.get(key, NOT_JUDGED), new.get(key) or missing(key[0]))
        for key in dict.fromkeys((*new, *old))
    ]
    return tuple(
        VerdictChange(oracle=oracle, ego=ego, before=one, after=other)
        for (oracle, ego), one, other in pairs
        if one != other
    )


def _in_words(verdicts: Iterable[Mapping[str, Any]]) -> dict[tuple[str, str], str]:
    """Returns the verdicts of each oracle on each ego in words, several violations counted."""
    said: dict[tuple[str, str], Counter[str]] = {}
    for verdict in verdicts:
        key = (str(verdict["oracle"]), str(verdict["ego"]))
        said.setdefault(key, Counter())[_words(verdict)] += 1
    return {
        key: ", ".join(
            words if count == 1 else f"{count} times {words}"
            for words, count in sorted(counted.items())
        )
        for key, counted in said.items()
    }


def _words(verdict: Mapping[str, Any]) -> str:
    outcome = Outcome(verdict["outcome"])
    text = outcome.in_words
    if outcome is not Outcome.VIOLATED:
        return text
    avoidable = verdict.get("avoidable")
    words = IN_WORDS[
        accountable(
            verdict.get("at_fault"),
            None if avoidable is None else Answer(avoidable),
            undetermined=bool(verdict.get("undetermined")),
        )
    ]
    return f"{text} ({words})" if words else text
