"""Checks of options against one another and the seed scenario."""

from __future__ import annotations

from collections.abc import Iterator

from drivora_service.errors import SearchError
from drivora_service.scenario import fields
from drivora_service.scenario.model import NpcBehavior, Scenario
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts

MAX_WAIT = 60.0
"""Seconds, the time after which an ego behind the vehicle is stuck."""
MAX_MIN_SPEED = 20.0
SLICE_TIMES = (0.5, 60.0)
"""Seconds."""


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
        *_out_of_range("max_wait", options.max_wait, 0.0, MAX_WAIT),
        *_out_of_range("min_speed", options.min_speed, 0.0, MAX_MIN_SPEED),
        *_out_of_range("max_speed_factor", options.max_speed_factor, 0.1, 3.0),
        *_out_of_range("max_walker_delay", options.max_walker_delay, 0.0, fields.MAX_START_TIME),
        *_out_of_range("max_ego_delay", options.max_ego_delay, 0.0, fields.MAX_START_TIME),
    ]
    for name, value, (low, high) in (
        ("slice_time", options.slice_time, SLICE_TIMES),
        ("max_deceleration", options.max_deceleration, fields.ACCELERATIONS),
        ("max_lateral_acceleration", options.max_lateral_acceleration, fields.ACCELERATIONS),
    ):
        if value != 0.0:
            problems += _out_of_range(name, value, low, high)
    problems += _contradictions(options)
    if 1 < options.egos < len(seed.ego_vehicles):
        problems.append(
            f"`egos` is {options.egos}, but the seed scenario has {len(seed.ego_vehicles)} egos: "
            "ask for at least as many, or for 1 to leave them as they are"
        )
    if problems:
        raise SearchError("; ".join(problems))


def _contradictions(options: SpaceOptions) -> Iterator[str]:
    if options.starts is VehicleStarts.FIXED and options.egos > 1:
        yield (
            f"`starts` is fixed, but `egos` is {options.egos}: fixed starts are near the "
            "scenario's own egos; use one ego, or free starts"
        )
    if options.slice_time > 0.0 and options.max_wait > 0.0:
        yield (
            f"`slice_time` and `max_wait` ({options.max_wait:g} s) are both given: in slices of "
            "time a vehicle stands where its speed is 0; leave `max_wait` out, and set `min_speed` "
            "to 0"
        )
    if options.behavior is NpcBehavior.SUMO:
        told = [
            name
            for name in ("at_end", "max_wait", "max_deceleration", "max_lateral_acceleration")
            if getattr(options, name) != getattr(SpaceOptions(), name)
        ]
        told += ["slice_time"] if options.slice_time else []
        if told:
            yield (
                f"`behavior` is sumo, but {', '.join(f'`{name}`' for name in told)} cannot be told "
                "to SUMO, which drives by its own models: use reactive or replay"
            )


def _out_of_range(name: str, value: float, low: float, high: float) -> list[str]:
    if low <= value <= high:
        return []
    return [f"`{name}` is {value:g}; {low:g} to {high:g} are allowed"]
