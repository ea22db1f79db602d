"""All cases of responsibility."""

from __future__ import annotations

from functools import lru_cache

from tests.oracles.responsibility import (
    junctions,
    oncoming,
    roadside,
    same_direction,
    signals_and_stops,
)
from tests.oracles.responsibility.case import Case


@lru_cache(maxsize=1)
def all_cases() -> tuple[Case, ...]:
    """In the order of the documentation."""
    families = (same_direction, oncoming, junctions, signals_and_stops, roadside)
    return tuple(case for family in families for case in family.cases())
