"""Slow and standing cars on an ego's route, which are rare in generated traffic."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drivora_service.errors import NoRoute
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, Waypoint
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.vehicles.vehicle_genes import MODELS
from drivora_service.simulation.planning import plan_episode
from drivora_service.simulation.plans.episode_plan import EpisodePlan

_GAPS = (14.0, 50.0)
"""Metres along the route from the ego's start to the first car."""
_SPEEDS = (1.0, 6.0)
"""Speed of a moving car, m/s."""
_LASTS_S = (6.0, 20.0)
"""Seconds after which the first car is removed."""
_BEYOND = (25.0, 90.0)
"""Metres from there to a standing car."""
_STANDING_SHARE = 0.6
"""Share of the runs with a standing car, if the route is long enough."""
_LONGEST_S = 35.0
"""Duration of a run in seconds, since an ego that stops behind a standing car stays there."""
_END_MARGIN = 12.0
"""Metres that cars keep from the end of the lanes that the ego follows without a change."""


def with_leaders(plan: EpisodePlan, random: np.random.Generator) -> EpisodePlan:
    """Adds a slow car on the route of a run's single ego, and often a standing one after it.

    The slow car is removed after a while, so that the ego accelerates again before it
    reaches the other.

    Args:
        plan: Plan of a run without NPC vehicles.
        random: Random generator; the same draws yield the same cars.

    Returns:
        The plan of the changed run; unchanged if its route is too short.
    """
    (ego,) = plan.egos
    path = DrivenPath(plan.network, ego.route)
    limit = min(ego.route.runs[0].change_from - ego.route.runs[0].start_s, path.length)
    limit -= _END_MARGIN
    begin = path.on_road(float(random.uniform(*_GAPS)), 0.0)
    speed = float(random.uniform(*_SPEEDS))
    end = path.on_road(min(begin + speed * float(random.uniform(*_LASTS_S)), limit), begin)
    stands = path.on_road(end + float(random.uniform(*_BEYOND)), end)
    model = MODELS[int(random.integers(len(MODELS)))]
    cars = []
    if end - begin > 2.0 * speed:
        cars.append(_car("leader", model, _along(path, begin, end, speed)))
    if random.random() < _STANDING_SHARE and stands < limit:
        cars.append(_car("standing", model, (path.at(stands).waypoint(),)))
    if not cars:
        return plan
    scenario = replace(plan.scenario, npc_vehicles=tuple(cars), max_sim_time=_LONGEST_S)
    try:
        return plan_episode(scenario, plan.network)
    except NoRoute:
        # Between waypoints the planner may find no way on the ego's own lanes.
        return plan


def _car(name: str, model: str, route: tuple[Waypoint, ...]) -> NpcVehicle:
    return NpcVehicle(id=name, model=model, route=route, behavior=NpcBehavior.REACTIVE)


def _along(path: DrivenPath, begin: float, end: float, speed: float) -> tuple[Waypoint, ...]:
    """Returns waypoints from one place to another, one on every road between them."""
    middles = [
        0.5 * (low + high)
        for lane, low, high in path.lane_ranges
        if not path.network.lanes[lane].is_internal and begin < low and high < end
    ]
    return tuple(path.at(s).waypoint(speed) for s in (begin, *middles, end))
