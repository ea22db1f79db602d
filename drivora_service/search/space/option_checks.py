"""Checks of options against one another and the seed scenario."""

from __future__ import annotations

from drivora_service.errors import SearchError
from drivora_service.scenario import fields
from drivora_service.scenario.model import Scenario
from drivora_service.search.space.options import SpaceOptions


def check_options(seed: Scenario, options: SpaceOptions) -> None:
    """Checks options.

    Raises:
        SearchError: Options contradict one another or the seed; every contradiction is named.
    """
    problems = [
        *_out_of_range("egos", options.egos, 1, fields.MAX_EGOS),
        *_out_of_range("vehicles", options.vehicles, 0, fields.MAX_NPC_VEHICLES),
        *_out_of_range("walkers", options.walkers, 0, fields.MAX_NPC_WALKERS),
        *_out_of_range("obstacles", options.obstacles, 0, fields.MAX_NPC_OBSTACLES),
        *_out_of_range("patches", options.patches, 0, fields.MAX_FRICTION_PATCHES),
        *_out_of_range("slices", options.slices, 1, 50),
        *_out_of_range("paths", options.paths, 1, 1000),
        *_out_of_range("reach", options.reach, 10.0, 1000.0),
        *_out_of_range("max_speed_factor", options.max_speed_factor, 0.1, 3.0),
        *_out_of_range("max_walker_delay", options.max_walker_delay, 0.0, fields.MAX_START_TIME),
        *_out_of_range("max_ego_delay", options.max_ego_delay, 0.0, fields.MAX_START_TIME),
    ]
    if 1 < options.egos < len(seed.ego_vehicles):
        problems.append(
            f"`egos` is {options.egos}, but the seed scenario has {len(seed.ego_vehicles)} egos: "
            "ask for at least as many, or for 1 to leave them as they are"
        )
    if problems:
        raise SearchError("; ".join(problems))


def _out_of_range(name: str, value: float, low: float, high: float) -> list[str]:
    if low <= value <= high:
        return []
    return [f"`{name}` is {value:g}; {low:g} to {high:g} are allowed"]
