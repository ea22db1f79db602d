"""Violations that only follow from another violation of the same ego."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from drivora_service.oracles.verdict import Outcome, Verdict

_STANDS = ("collision", "deadlock", "junction_blocking", "blocked")
"""Reasons for which an ego stands to its end, the first that it violates is the cause."""

_ENDS = {"collision": ("collision",), "stuck": _STANDS, "route_deviation": ("route_deviation",)}
"""Oracles that judge the end of an ego's part, by the reason for which it missed its destination.
One that ran out of time may have stood to the end as well."""

_AT_THE_END_S = 0.1
"""Seconds before the last row within which standing goes on to the end."""


def fold_consequences(
    verdicts: Sequence[Verdict], ends: Mapping[str, float]
) -> tuple[Verdict, ...]:
    """Returns the verdicts of a run, each violation with the one that it follows from.

    - A missed destination follows from what ended the ego's part, or kept it standing to its end.
    - A block follows from a deadlock, from standing in a junction, or from a collision, if the ego
      stood for that.
    - A near miss follows from the collision with the same actor.

    A breach of traffic law before a collision is a violation of its own, and so is the collision.

    Args:
        verdicts: Verdicts of all oracles.
        ends: Simulation time in seconds of the last row of each ego's part, by the ego's id.
    """
    violated: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        if verdict.outcome is Outcome.VIOLATED:
            violated.setdefault(verdict.ego, []).append(verdict)
    if all(len(of_ego) < 2 for of_ego in violated.values()):
        return tuple(verdicts)
    return tuple(
        replace(verdict, follows=cause)
        if verdict.outcome is Outcome.VIOLATED
        and (cause := _cause(verdict, violated[verdict.ego], ends.get(verdict.ego, math.inf)))
        else verdict
        for verdict in verdicts
    )


def _cause(verdict: Verdict, others: Sequence[Verdict], end: float) -> str:
    """Returns the oracle of the violation from which one follows; "" if from none."""
    if verdict.oracle == "destination":
        return _cause_of_missing(verdict, others, end)
    if verdict.oracle == "blocked":
        begun, until = _lasts(verdict)
        standing = [one for one in others if _overlaps(one, begun, until)]
        return _first_of(("collision", "deadlock", "junction_blocking"), standing)
    if verdict.oracle == "near_miss":
        touched = [one for one in others if one.counterpart == verdict.counterpart]
        return _first_of(("collision",), touched)
    return ""


def _cause_of_missing(verdict: Verdict, others: Sequence[Verdict], end: float) -> str:
    reason = str(verdict.evidence.get("reason", ""))
    if reason == "timeout":
        lasting = [one for one in others if _lasts(one)[1] >= end - _AT_THE_END_S]
        return _first_of(("deadlock", "junction_blocking", "blocked"), lasting)
    return _first_of(_ENDS.get(reason, ()), others)


def _overlaps(cause: Verdict, begun: float, until: float) -> bool:
    if cause.oracle == "collision":
        # The ego stands because it has crashed, and not the other way round.
        return cause.time is not None and cause.time <= begun
    first, last = _lasts(cause)
    return first <= until and begun <= last


def _lasts(verdict: Verdict) -> tuple[float, float]:
    """Returns the simulation times in seconds from which on and up to which a violation lasts."""
    evidence = verdict.evidence
    time = -math.inf if verdict.time is None else verdict.time
    # Egos that wait for one another do so to their end: no other rule lets them go.
    until = math.inf if verdict.oracle == "deadlock" else float(evidence.get("until", time))
    return float(evidence.get("since", time)), until


def _first_of(oracles: Iterable[str], violated: Sequence[Verdict]) -> str:
    found = {one.oracle for one in violated}
    return next((oracle for oracle in oracles if oracle in found), "")
