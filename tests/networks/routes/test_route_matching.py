"""Polylines that are not exactly on the lanes: no lap that the polyline does not make."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from drivora_service.errors import NoRoute
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.projection import lane_positions_near
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.route_matching import MAX_DETOURS
from drivora_service.networks.routes.routing import RoutePoint, match_route, plan_route

LONGEST = 1.15
"""Lengths of its polyline that a route through waypoints has at most."""


def polyline(points: Sequence[RoutePoint]) -> float:
    return sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(points))


def on_lane(network: RoadNetwork, lane: int, share: float) -> RoutePoint:
    one = network.lanes[lane]
    x, y, heading = one.position_at(share * float(one.arc[-1]))
    return RoutePoint(x=x, y=y, yaw=heading)


def drives(network: RoadNetwork, random: np.random.Generator, count: int) -> list[LaneRoute]:
    """Routes of at least 300 m between random places, without a lap."""
    lanes = [one for one in network.lanes if one.drivable and not one.is_internal]
    found: list[LaneRoute] = []
    for _ in range(50 * count):
        first, last = (int(random.integers(len(lanes))) for _ in range(2))
        try:
            route = plan_route(
                network, [on_lane(network, lanes[i].index, 0.5) for i in (first, last)]
            )
        except NoRoute:
            continue
        if route.length > 300.0 and len(set(route.edges)) == len(route.edges):
            found.append(route)
        if len(found) == count:
            return found
    raise AssertionError(f"{len(found)} routes of {count} on {network.name}")


def scattered(
    network: RoadNetwork, route: LaneRoute, spacing: int, random: np.random.Generator
) -> list[RoutePoint]:
    """Waypoints along a drive, each on any lane of its edge, some twice: on two lanes abreast."""
    points = [RoutePoint(x=float(route.line[0, 0]), y=float(route.line[0, 1]))]
    for row in range(spacing, len(route.line) - 1, spacing):
        lane = network.lanes[int(route.point_lanes[row])]
        if lane.is_internal:
            continue
        x, y = (float(value) for value in route.line[row])
        foot = next(p for p in lane_positions_near(network, x, y) if p.lane == lane.index)
        share = foot.s / float(lane.arc[-1])
        abreast = [i for i in network.edge_lanes[lane.edge_id] if network.lanes[i].drivable]
        chosen = random.choice(abreast, size=int(random.integers(1, 3)))
        points += [on_lane(network, int(index), share) for index in chosen]
    return points


@pytest.mark.parametrize("town", ["arterial", "highway", "signal-grid"])
def test_waypoints_abreast_cost_no_lap(town: str) -> None:
    network = NetworkCatalogue(shipped_networks()).get(town)
    random = np.random.default_rng(7)
    for route in drives(network, random, 8):
        for spacing in (15, 60):
            points = scattered(network, route, spacing, random)
            if len(points) < 3:
                continue
            # Changing between the lanes is part of the polyline, the way along them is the drive.
            assert plan_route(network, points).length <= max(
                LONGEST * polyline(points), route.length + 1.0
            ), (town, spacing, points)


@pytest.mark.parametrize("aside", [1, 2, 3])
def test_a_waypoint_abreast_of_the_one_before(aside: int) -> None:
    """Lanes over in less than a metre: no vehicle can change there, and no lap is meant."""
    network = NetworkCatalogue(shipped_networks()).get("highway")
    lane = next(
        one
        for one in network.lanes
        if not one.is_internal
        and len(network.edge_lanes[one.edge_id]) == 4
        and one.lane_number == 0
        and one.arc[-1] > 150.0
    )
    abreast = network.edge_lanes[lane.edge_id]
    points = [
        on_lane(network, abreast[0], 0.1),
        on_lane(network, abreast[0], 0.4),
        on_lane(network, abreast[aside], 0.401),
        on_lane(network, abreast[aside], 0.8),
    ]
    route = plan_route(network, points)
    assert route.length <= LONGEST * polyline(points)
    # Where there is room, the lane that the waypoints name is driven.
    assert math.dist(route.line[-1], (points[-1].x, points[-1].y)) < 0.1
    assert match_route(network, points).left_out == ()


def test_a_dense_track_with_a_waypoint_on_the_wrong_road(loop: RoadNetwork) -> None:
    """A point of the road behind, 60 m away by the lanes' direction but 3 m beside the track."""
    track = [RoutePoint(x=float(x), y=0.0, yaw=0.0) for x in range(10, 100, 15)]
    behind = [*track[:4], RoutePoint(x=30.0, y=0.0, yaw=0.0), *track[4:]]
    assert match_route(loop, track).left_out == ()
    match = match_route(loop, behind)
    assert len(match.left_out) >= 1
    assert plan_route(loop, behind).length == pytest.approx(75.0, abs=0.1)


def test_a_short_list_of_places_is_meant_as_it_is(loop: RoadNetwork) -> None:
    places = [
        RoutePoint(x=x, y=0.0, yaw=0.0) for x in (40.0, 20.0, 60.0)
    ]  # the second lies behind the start: a lap is asked for
    match = match_route(loop, places)
    assert match.left_out == ()
    assert plan_route(loop, places).length > 600.0


def test_a_polyline_that_goes_here_and_there_keeps_its_waypoints() -> None:
    """Places all over a town are an errand, not a track with outliers; and no search is long."""
    network = NetworkCatalogue(shipped_networks()).get("signal-grid")
    random = np.random.default_rng(5)
    lanes = [one for one in network.lanes if one.drivable and one.arc[-1] > 60.0]
    points = [on_lane(network, lanes[int(random.integers(len(lanes)))].index, 0.5)]
    while len(points) < 40:
        points.append(on_lane(network, lanes[int(random.integers(len(lanes)))].index, 0.5))
    match = match_route(network, points)
    assert sum(leg.is_detour for leg in match.legs) > MAX_DETOURS
    assert match.left_out == ()
