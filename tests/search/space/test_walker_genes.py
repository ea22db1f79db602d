"""Walkers from genes: from beside the road across an ego's way to the other side."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.drivable_area import outside_distance
from drivora_service.scenario.model import NpcWalker
from drivora_service.search.space.roadside import OFF_ROAD
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.walker_genes import AHEAD_OF_EGO
from tests.search.space.seeds import SHIPPED, block_named, drawn, space_around

OPTIONS = SpaceOptions(vehicles=0, walkers=1, weather=False)


def walker(space: ScenarioSpace, values: FloatArray, **genes: float) -> NpcWalker:
    changed = values.copy()
    for name, value in genes.items():
        changed[block_named(space, "walker_0").index(name)] = value
    return space.scenario(changed).npc_walkers[0]


@settings(max_examples=30)
@example(number=1703, town="tee-town")
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_it_crosses_the_way_of_the_ego(number: int, town: str) -> None:
    space = space_around(town, OPTIONS)
    one = walker(space, drawn(space, number))
    begin, end = one.route
    ends = np.array([(begin.x, begin.y), (end.x, end.y)])
    assert outside_distance(space.network, ends).min() > OFF_ROAD - 0.1
    route = space.routes[0].path
    way = shapely.LineString(ends)
    crossing = way.intersection(shapely.LineString(route.line))
    assert not crossing.is_empty
    # A route that comes back on the other side of the road is crossed twice, and may be so where it
    # begins; the place that was chosen is ahead.
    points = [part.centroid for part in shapely.get_parts(crossing)]
    assert max(route.place_of(at.x, at.y)[0] for at in points) >= AHEAD_OF_EGO - 6.0
    assert way.length < 60.0
    assert begin.speed == end.speed
    assert 1.25 <= (begin.speed or 0.0) <= 3.0
    assert 0.0 <= one.start_time <= 15.0


def test_the_side_says_from_where() -> None:
    space = space_around("tee-town", OPTIONS)
    values = drawn(space, 4)
    right, left = (walker(space, values, side=side) for side in (0.0, 1.0))
    assert right.route == tuple(reversed(left.route))


def test_the_angle_slants_the_way() -> None:
    space = space_around("rural", OPTIONS)
    values = drawn(space, 4)
    directions = []
    for angle in (-0.5, 0.0, 0.5):
        begin, end = walker(space, values, angle=angle, side=0.0).route
        directions.append(math.atan2(end.y - begin.y, end.x - begin.x))
    assert np.unwrap(directions) - directions[1] == pytest.approx([-0.5, 0.0, 0.5], abs=1e-3)


def test_the_place_is_a_share_of_the_route() -> None:
    space = space_around("rural", OPTIONS)
    route, values = space.routes[0].path, drawn(space, 1)
    places = []
    for share in (0.0, 0.5, 1.0):
        begin, end = walker(space, values, place=share, angle=0.0).route
        places.append(route.place_of(0.5 * (begin.x + end.x), 0.5 * (begin.y + end.y))[0])
    assert places == sorted(places)
    assert places[0] == pytest.approx(AHEAD_OF_EGO, abs=8.0)
    assert places[2] > 0.8 * route.length


def test_a_later_start_changes_nothing_else() -> None:
    space = space_around("old-town", OPTIONS)
    values = drawn(space, 6)
    early, late = (walker(space, values, start_time=time) for time in (1.0, 9.0))
    assert (early.start_time, late.start_time) == (1.0, 9.0)
    assert early.route == late.route
