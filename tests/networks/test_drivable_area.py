from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.networks.drivable_area import drivable_area, near_area, outside_distance
from drivora_service.networks.road_network import RoadNetwork


def centre_lines(network: RoadNetwork) -> np.ndarray:
    return np.concatenate(
        [
            np.array([lane.position_at(s)[:2] for s in np.linspace(0.0, lane.arc[-1], 15)])
            for lane in network.lanes
            if lane.drivable
        ]
    )


def test_contains_every_drivable_centre_line(town: RoadNetwork) -> None:
    assert outside_distance(town, centre_lines(town)).max() < 0.02


def test_contains_every_drivable_centre_line_of_shipped_networks(
    shipped_network: RoadNetwork,
) -> None:
    assert outside_distance(shipped_network, centre_lines(shipped_network)).max() < 0.02


def test_near_are_those_that_are_no_further_outside(shipped_network: RoadNetwork) -> None:
    rng = np.random.default_rng(4)
    lines = centre_lines(shipped_network)
    points = lines[rng.integers(0, len(lines), 400)] + rng.normal(0.0, 5.0, (400, 2))
    near = near_area(shipped_network, points, 1.5)
    assert near.tolist() == (outside_distance(shipped_network, points) <= 1.5).tolist()
    assert 0 < near.sum() < len(near)


def test_distances_are_those_from_the_whole_area(town: RoadNetwork) -> None:
    rng = np.random.default_rng(3)
    lines = centre_lines(town)
    points = lines[rng.integers(0, len(lines), 800)] + rng.normal(0.0, 5.0, (800, 2))
    plain = shapely.distance(drivable_area(town), shapely.points(points))
    assert (plain > 0.0).any()
    assert outside_distance(town, points) == pytest.approx(plain, abs=1e-9)


@given(x=st.floats(5.0, 90.0), y=st.floats(-30.0, -1.6))
def test_distance_beside_a_straight_lane(loop: RoadNetwork, x: float, y: float) -> None:
    assert outside_distance(loop, np.array([[x, y]]))[0] == pytest.approx(-1.6 - y, abs=1e-6)


@pytest.mark.parametrize(
    ("place", "outside"),
    [
        ((50.0, 1.6), 0.0),  # the border between two lanes
        ((150.0, 1.6), 0.0),  # b's lanes are 3.0 m wide and 3.2 m apart: a gap of 0.2 m
        ((105.0, 4.0), 0.0),  # in the junction
        ((50.0, -2.6), 1.0),  # on the sidewalk
        ((201.0, 3.2), 1.0),  # beyond the end of a lane
        ((10.0, -2.0), 0.4),
    ],
)
def test_what_is_drivable(loop: RoadNetwork, place: tuple[float, float], outside: float) -> None:
    assert outside_distance(loop, np.array([place]))[0] == pytest.approx(outside, abs=1e-6)


def test_unknown_places_are_not_measured(loop: RoadNetwork) -> None:
    distance = outside_distance(loop, np.array([[50.0, 0.0], [math.nan, 0.0], [0.0, math.inf]]))
    assert distance[0] == 0.0
    assert np.isnan(distance[1:]).all()
    assert outside_distance(loop, np.empty((0, 2))).shape == (0,)
