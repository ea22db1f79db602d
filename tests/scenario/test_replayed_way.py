from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.scenario.replayed_way import MOST_CUT, ReplayedWay, lay_way
from drivora_service.scenario.waypoint_speeds import most_lateral
from drivora_service.simulation.followers.follower_path import FollowerPath, build_path

SIDE = most_lateral(None, 1.0)


def two_legs(degrees: float, length: float = 60.0) -> FloatArray:
    turn = math.radians(degrees)
    there = (length * (1.0 + math.cos(turn)), length * math.sin(turn))
    return np.array([(0.0, 0.0), (length, 0.0), there])


def lay(points: FloatArray, *speeds: float, waits: tuple[int, ...] = ()) -> ReplayedWay:
    given = np.array(speeds if len(speeds) > 1 else speeds * len(points))
    return lay_way(points, given, np.isin(np.arange(len(points)), waits), SIDE)


def drive(way: ReplayedWay, *speeds: float) -> FollowerPath:
    given = np.array(speeds if len(speeds) > 1 else speeds * len(way.marks))
    return build_path(
        way.line, given, way.marks, None, 1.0, 3.4, is_vehicle=True, is_sampled=way.is_sampled
    )


def cut(way: ReplayedWay, waypoint: FloatArray) -> float:
    return float(np.hypot(*(way.line - waypoint).T).min())


@pytest.mark.parametrize("degrees", [10.0, 15.0, 20.0, -15.0])
def test_a_gentle_bend_is_driven_at_the_asked_speed(degrees: float) -> None:
    points = two_legs(degrees)
    plain = build_path(points, np.full(3, 26.0), arc_lengths(points), None, 1.0, 3.4, True)
    assert plain.wanted.min() < 9.0
    way = lay(points, 26.0)
    path = drive(way, 26.0)
    assert path.wanted.min() == 26.0
    assert not way.slow_corners
    bend = np.abs(np.gradient(path.yaw, path.arc))
    assert (bend * path.wanted**2).max() <= SIDE
    assert 0.0 < cut(way, points[1]) < MOST_CUT
    assert np.array_equal(path.line[[0, -1]], points[[0, -1]])


def test_the_waypoint_is_the_middle_of_its_arc() -> None:
    points = two_legs(20.0)
    way = lay(points, 26.0)
    middle = way.line[np.searchsorted(arc_lengths(way.line), way.marks[1])]
    assert np.hypot(*(middle - points[1])) == pytest.approx(cut(way, points[1]))
    assert np.hypot(*(middle - points[0])) == pytest.approx(np.hypot(*(middle - points[2])))


def test_an_arc_keeps_half_of_each_line_and_two_metres_of_its_waypoint() -> None:
    short = lay(two_legs(10.0, length=12.0), 26.0)
    (corner,) = short.slow_corners
    # Half of a line, 6 m, at half of the angle.
    radius = 6.0 / math.tan(math.radians(5.0))
    assert corner.speed == pytest.approx(math.sqrt(SIDE * radius), rel=0.03)
    points = two_legs(30.0)
    (corner,) = lay(points, 26.0).slow_corners
    assert cut(lay(points, 26.0), points[1]) == pytest.approx(MOST_CUT, abs=0.01)
    assert (corner.number, corner.asked) == (1, 26.0)
    assert 17.0 < corner.speed < 20.0


def test_a_sharp_corner_stays_a_corner() -> None:
    points = two_legs(60.0)
    way = lay(points, 13.0)
    assert not way.is_sampled
    assert np.array_equal(way.line, points)
    (corner,) = way.slow_corners
    assert math.degrees(corner.turn) == pytest.approx(60.0)
    assert corner.speed == pytest.approx(drive(way, 13.0).wanted.min(), rel=0.02)


def test_what_is_driven_at_its_speed_stays_as_it_is() -> None:
    points = two_legs(10.0)
    way = lay(points, 8.0)
    assert way.line is points
    assert np.array_equal(way.marks, arc_lengths(points))
    assert not way.is_sampled


def test_it_need_be_no_faster_than_the_slower_of_two_speeds() -> None:
    points = two_legs(10.0)
    assert not lay(points, 26.0, 26.0, 7.0).is_sampled
    assert not lay(points, 26.0, 7.0, 26.0).is_sampled
    assert lay(points, 7.0, 26.0, 26.0).is_sampled


def test_a_vehicle_stands_at_the_very_waypoint() -> None:
    points = two_legs(15.0)
    assert lay(points, 26.0, waits=(1,)).line is points


def test_close_waypoints_of_a_bend_are_driven_at_its_speed() -> None:
    # A bend of 60 m, by waypoints 8 m apart: 15 m/s are within the grip.
    angles = np.arange(0.0, 1.5, 8.0 / 60.0)
    points = np.column_stack((60.0 * np.sin(angles), 60.0 * (1.0 - np.cos(angles))))
    plain = build_path(
        points, np.full(len(points), 15.0), arc_lengths(points), None, 1.0, 3.4, True
    )
    assert plain.wanted.min() < 9.5
    way = lay(points, 15.0)
    assert not way.slow_corners
    assert drive(way, 15.0).wanted.min() == 15.0
    assert max(cut(way, point) for point in points) < 0.2


def test_waypoints_at_one_place_are_no_corner() -> None:
    points = np.array([(0.0, 0.0), (30.0, 0.0), (30.0, 0.0), (60.0, 5.0)])
    way = lay(points, 26.0)
    assert np.isfinite(way.line).all()
    assert np.isfinite(drive(way, 26.0).wanted).all()
    parked = np.zeros((1, 2))
    assert lay(parked, 0.0).line is parked
