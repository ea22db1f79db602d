"""Shorter versions of a document: fewer vehicles, less time, and routes that end sooner.

Each function returns lists of alternatives, one list for each thing that can be shortened; of a
list at most one is taken, and the first one is the shortest. Documents are in the network's plane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.errors import NetworkError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.conversion import waypoint
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import EgoDocument
from drivora_service.scenario.frames import FrameTransform
from drivora_service.suites.minimization.edits import REMOVED, Edit, Place

AFTER_S = (1.0, 2.0, 5.0, 10.0, 20.0)
"""Whole seconds after the failure at which an episode may end."""
AFTER_M = (5.0, 10.0, 20.0, 40.0, 80.0)
"""Metres after the failure at which an ego's route may end."""
_LEAST_M = 5.0
"""Metres by which a route must become shorter."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """The failure as a run of the document shows it.

    Attributes:
        time: Simulation time at which it begins, seconds; ``None`` if the oracle tells none.
        location: Place in the network's plane, metres; ``None`` if the oracle tells none.
        sim_time_s: Simulation time at which the run ended.
    """

    time: float | None
    location: tuple[float, float] | None
    sim_time_s: float


def fewer_vehicles(document: ScenarioDocument) -> list[list[Edit]]:
    """Returns smaller numbers of vehicles of the background traffic."""
    traffic = document.background_traffic
    if traffic is None or traffic.count is None or traffic.count < 2:
        return []
    count = traffic.count
    fewer = sorted({count // 4, count // 2, 3 * count // 4, count - 1} - {0})
    place: Place = ("background_traffic", "count")
    return [
        [Edit(changes=((place, n),), label=f"background traffic of {n} vehicles") for n in fewer]
    ]


def less_time(document: ScenarioDocument, failure: Failure) -> list[list[Edit]]:
    """Returns earlier ends of the episode, and that it has none if it ends by itself."""
    place: Place = ("max_sim_time",)
    if document.max_sim_time is not None and failure.sim_time_s < document.max_sim_time - 1e-6:
        return [[Edit(changes=((place, REMOVED),), label="without max_sim_time")]]
    if failure.time is None:
        return []
    ends = [math.ceil(failure.time) + seconds for seconds in AFTER_S]
    return [
        [
            Edit(changes=((place, end),), label=f"ends at {end:.0f} s")
            for end in ends
            if end < failure.sim_time_s - 1e-6
        ]
    ]


def sooner_ends(
    document: ScenarioDocument, failure: Failure, network: RoadNetwork
) -> list[list[Edit]]:
    """Returns nearer destinations of each ego, behind the place of the failure on its route."""
    if failure.location is None:
        return []
    found = []
    for index, ego in enumerate(document.ego_vehicles):
        route = _route(ego, network)
        if route is not None:
            found.append(_ends(ego, index, route, failure.location))
    return found


def _ends(
    ego: EgoDocument, index: int, route: LaneRoute, location: tuple[float, float]
) -> list[Edit]:
    passed = [_arc_near(route, (place.x, place.y)) for place in ego.route[1:-1]]
    failed, last = _arc_near(route, location), len(ego.route) - 1
    found = []
    for metres in AFTER_M:
        end = failed + metres
        if end > route.length - _LEAST_M:
            break
        x, y = _point_at(route, end)
        destination: Place = ("ego_vehicles", index, "route", last)
        beyond = [number for number, arc in enumerate(passed, 1) if arc > end - 1.0]
        found.append(
            Edit(
                changes=(
                    (destination, {"x": round(x, 1), "y": round(y, 1)}),
                    *((("ego_vehicles", index, "route", number), REMOVED) for number in beyond),
                ),
                label=f"{ego.id} drives {end:.0f} m",
            )
        )
    return found


def route_lengths(document: ScenarioDocument, network: RoadNetwork) -> dict[str, float]:
    """Returns the metres of the route of each ego, by its id."""
    routes = {ego.id: _route(ego, network) for ego in document.ego_vehicles}
    return {ego: 0.0 if route is None else route.length for ego, route in routes.items()}


def _route(ego: EgoDocument, network: RoadNetwork) -> LaneRoute | None:
    places = [waypoint(place, FrameTransform()) for place in ego.route]
    try:
        return plan_route(network, route_points(places))
    except NetworkError:
        return None


def _arc_near(route: LaneRoute, point: Sequence[float]) -> float:
    """Returns the arc length of the point of a route that is nearest to a place."""
    away = np.hypot(route.line[:, 0] - point[0], route.line[:, 1] - point[1])
    return float(route.arc[int(np.argmin(away))])


def _point_at(route: LaneRoute, arc: float) -> tuple[float, float]:
    x, y = (float(np.interp(arc, route.arc, route.line[:, axis])) for axis in (0, 1))
    return x, y
