"""The situations of failures: kinds of failures, told apart further by place and speeds.

A situation is a discrete key of one failure alone. So the number of situations of a campaign
depends on nothing but its own failures, more failures never make fewer situations, and situations
of several campaigns can be put together. Groups (``campaigns.search.failure_grouping``)
have none of that: their scale is the spread of the failures, and chains of neighbours merge.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from drivora_service.oracles.verdict import Verdict

PLACE = 10.0
"""Metres, the side of the squares of a fixed grid by which places are distinguished: two lengths
of a car."""
SPEED = 5.0
"""m/s by which speeds are distinguished."""

_EGO_SPEEDS = ("ego_speed", "speed")
_OTHER_SPEEDS = ("other_speed",)
"""Evidence with the speed of the ego and of the other actor; the first that an oracle has."""

Situation: TypeAlias = tuple[str, int | None, int | None, int | None, int | None]


def situation_of(kind: str, verdict: Verdict) -> Situation:
    """Returns the situation of a failure: its kind, and the cells of its place and speeds.

    Args:
        kind: Its kind (``campaigns.search.failure_kinds``): oracle, junction or road, relation
            of the other actor to the ego.
        verdict: The violation; what it does not measure tells nothing apart.
    """
    x, y = (None, None) if verdict.location is None else verdict.location
    return (
        kind,
        _cell(x, PLACE),
        _cell(y, PLACE),
        _cell(_first(verdict.evidence, _EGO_SPEEDS), SPEED),
        _cell(_first(verdict.evidence, _OTHER_SPEEDS), SPEED),
    )


def count_situations(failures: Iterable[tuple[str, Verdict]]) -> int:
    """Returns the number of different situations of failures, each with its kind."""
    return len({situation_of(kind, verdict) for kind, verdict in failures})


def _first(evidence: Mapping[str, Any], names: Iterable[str]) -> Any:
    return next((evidence[name] for name in names if name in evidence), None)


def _cell(value: Any, size: float) -> int | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return math.floor(value / size)
