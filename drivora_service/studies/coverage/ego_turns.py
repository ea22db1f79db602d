"""How the egos of scenarios turn from the start to the end of their routes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from drivora_service.networks.projection import project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import Scenario, Waypoint
from drivora_service.studies.coverage.coverage_values import Turn

_TURN = math.radians(45.0)
_BACK = math.radians(135.0)


def turns_of(network: RoadNetwork, scenarios: Sequence[Scenario]) -> list[set[Turn]]:
    """Returns the turns of the egos of each scenario on a network.

    Where the ends of a route have no heading, it is that of the lane there.
    """
    ends = [
        end
        for scenario in scenarios
        for ego in scenario.ego_vehicles
        for end in (ego.route[0], ego.route[-1])
    ]
    places = project_points(network, np.array([(end.x, end.y) for end in ends]))
    headings = iter(
        _heading(network, end, int(lane), float(s))
        for end, lane, s in zip(ends, places.lane, places.s, strict=True)
    )
    return [
        {_turn(next(headings), next(headings)) for _ in scenario.ego_vehicles}
        for scenario in scenarios
    ]


def _heading(network: RoadNetwork, end: Waypoint, lane: int, s: float) -> float | None:
    if end.yaw is not None or lane < 0:
        return end.yaw
    return network.lanes[lane].position_at(s)[2]


def _turn(start: float | None, end: float | None) -> Turn:
    if start is None or end is None:
        return Turn.UNKNOWN
    angle = math.remainder(end - start, math.tau)
    if abs(angle) > _BACK:
        return Turn.BACK
    if abs(angle) <= _TURN:
        return Turn.STRAIGHT
    return Turn.LEFT if angle > 0.0 else Turn.RIGHT
