"""All cases of responsibility."""

from __future__ import annotations

from functools import lru_cache

from tests.oracles.responsibility import (
    borders,
    earlier_breaches,
    further_junctions,
    further_meetings,
    junctions,
    narrow_streets_and_walkers,
    oncoming,
    own_breaches,
    rear_endings,
    rear_endings_ahead,
    roadside,
    same_direction,
    signals_and_stops,
    wrong_sides_and_speeds,
)
from tests.oracles.responsibility.case import Case


@lru_cache(maxsize=1)
def all_cases() -> tuple[Case, ...]:
    """In the order of the documentation."""
    families = (
        same_direction,
        oncoming,
        junctions,
        signals_and_stops,
        roadside,
        borders,
        own_breaches,
        wrong_sides_and_speeds,
        earlier_breaches,
        rear_endings,
        rear_endings_ahead,
        further_meetings,
        narrow_streets_and_walkers,
        further_junctions,
    )
    return tuple(case for family in families for case in family.cases())
