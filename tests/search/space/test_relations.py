"""The relations of walks to a route, on a road with known lanes."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.lane_walks import LaneWalk
from drivora_service.search.space.relations import (
    Relation,
    RouteSurroundings,
    closest_relation,
    spread_out,
)
from drivora_service.testing.networks import EAST, EAST_LEFT, WEST, straight_road
from tests.search.space.seeds import SHIPPED, space_around

ROAD = straight_road()


def surroundings(reach: float = 50.0) -> RouteSurroundings:
    """The ego drives from x = 0 m to x = 200 m."""
    route = plan_route(ROAD, [RoutePoint(x=0.0, y=0.0), RoutePoint(x=200.0, y=0.0)])
    return RouteSurroundings(ROAD, DrivenPath(ROAD, route), reach)


@pytest.mark.parametrize(
    ("lane", "start", "end", "relation"),
    [
        (EAST, 530.0, 800.0, Relation.LEADING),
        (EAST, 430.0, 700.0, Relation.TRAILING),
        (EAST, 100.0, 400.0, None),
        (EAST_LEFT, 450.0, 700.0, Relation.BESIDE),
        (WEST, 250.0, 450.0, Relation.ONCOMING),
        (WEST, 600.0, 800.0, None),
    ],
)
def test_lanes_of_one_road(lane: int, start: float, end: float, relation: Relation | None) -> None:
    walk = LaneWalk(lanes=(lane,), start_s=start, end_s=end)
    assert surroundings().relation(walk) is relation
    assert closest_relation(walk, [surroundings()]) is relation


def test_the_length_of_a_lane_within_reach() -> None:
    around = surroundings()
    low, high = around.stretch_within(EAST) or (0.0, 0.0)
    assert (low, high) == pytest.approx((450.0, 750.0), abs=2.1)
    assert around.gap_at(EAST, 480.0) == pytest.approx(20.0, abs=1.1)
    assert around.gap_at(EAST, 10.0) == math.inf


@pytest.mark.parametrize("town", SHIPPED)
def test_relations_are_what_they_are_called(town: str) -> None:
    space = space_around(town)
    route = space.routes[0].path
    line = shapely.LineString(route.line)
    for path in space.paths:
        driven = shapely.LineString(path.path.line)
        begins_on_route = line.distance(shapely.Point(path.path.line[0])) < 1.0
        if path.relation is Relation.CROSSING:
            assert driven.distance(line) < 1.6
            assert not begins_on_route
        elif path.relation is Relation.MERGING:
            assert driven.intersection(line.buffer(1.2)).length > 8.0
            assert not begins_on_route
        elif path.relation is Relation.LEADING:
            assert begins_on_route
        elif path.relation is Relation.ONCOMING:
            assert 1.6 <= driven.distance(line) < 8.0
        elif path.relation is Relation.BESIDE:
            assert 1.2 <= driven.distance(line) < 5.0
        else:
            assert not begins_on_route
            assert driven.distance(shapely.Point(route.line[0])) < 6.0


def test_spread_out_takes_what_differs_most() -> None:
    cells = np.array(
        [[1, 1, 0, 0, 0], [1, 1, 0, 0, 0], [1, 1, 1, 0, 0], [0, 0, 0, 1, 1]], dtype=np.float64
    )
    assert spread_out(cells, 2) == (0, 3)
    # The second is equal to the first, and not taken at all.
    assert spread_out(cells, 4) == (0, 3, 2)
