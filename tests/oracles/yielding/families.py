"""All situations of right of way."""

from __future__ import annotations

from functools import lru_cache

from tests.oracles.yielding import (
    background,
    distant_traffic,
    equal_rank,
    minor_roads,
    queues_in_exits,
    roundabouts,
    signals,
    standing_egos,
    turns,
    walkers,
)
from tests.oracles.yielding.situation import Situation


@lru_cache(maxsize=1)
def all_situations() -> tuple[Situation, ...]:
    """In the order of their families."""
    families = (
        *(minor_roads, turns, roundabouts, signals, equal_rank),
        *(walkers, distant_traffic, background, standing_egos, queues_in_exits),
    )
    return tuple(each for family in families for each in family.situations())
