"""Slow and standing cars on an ego's way, of which generated traffic has hardly any."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drivora_service.errors import NoRoute
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, Waypoint
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.vehicles import MODELS
from drivora_service.simulation.plan import EpisodePlan, plan_episode

_GAPS = (14.0, 50.0)
"""Metres along the way from the ego's start to the first car."""
_SPEEDS = (1.0, 6.0)
"""m/s of a car that drives."""
_LASTS_S = (6.0, 20.0)
"""Seconds for which the first car is on the way, before it leaves the road."""
_BEYOND = (25.0, 90.0)
"""Metres from there to a car that stands."""
_STANDING_SHARE = 0.6
"""Share of the runs with a car that stands, where the way is long enough for it."""
_LONGEST_S = 35.0
"""Seconds of a run: whoever has stopped behind a car that stands, stays."""
_END_MARGIN = 12.0
"""Metres that cars keep from the end of the lanes that the ego follows without a change."""


def with_leaders(plan: EpisodePlan, random: np.random.Generator) -> EpisodePlan:
    """Puts a slow car on the way of a run's one ego, and often one that stands beyond it.

    The slow one leaves the road after a while, so that the ego gets up to speed again before it
    comes to the other.

    Args:
        plan: Of a run without NPC vehicles.
        random: For every draw; the same draws give the same cars.

    Returns:
        The plan of the changed run; the run as it was where its way is too short.
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
        # Between waypoints the planner may find no way that the ego's own lanes allow.
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
