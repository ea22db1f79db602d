from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.geometry.boxes import box_gap, overlap_depth, time_to_contact
from drivora_service.geometry.outlines import box_corners

angles = st.floats(-math.pi, math.pi)
places = st.floats(-12.0, 12.0)
sizes = st.floats(0.3, 12.0)
speeds = st.floats(-20.0, 20.0)
shapes = st.tuples(angles, sizes, sizes)


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    """Compiles before the first example, whose time is limited."""
    box_gap(9.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0)
    time_to_contact(9.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0)


def polygon(x: float, y: float, yaw: float, length: float, width: float) -> shapely.Polygon:
    corners = box_corners(np.array([x]), np.array([y]), np.array([yaw]), length, width)
    return shapely.Polygon(corners[0])


@given(places, places, shapes, shapes)
def test_gap_is_the_distance_between_the_polygons(
    dx: float, dy: float, one: tuple[float, ...], two: tuple[float, ...]
) -> None:
    expected = polygon(0.0, 0.0, *one).distance(polygon(dx, dy, *two))
    assert box_gap(dx, dy, *one, *two) == pytest.approx(expected, abs=1e-9)


@given(places, places, shapes, shapes)
def test_gap_is_zero_exactly_where_boxes_overlap(
    dx: float, dy: float, one: tuple[float, ...], two: tuple[float, ...]
) -> None:
    depth = overlap_depth(dx, dy, *one, *two)
    if abs(depth) > 1e-9:
        overlapping = polygon(0.0, 0.0, *one).intersects(polygon(dx, dy, *two))
        assert (box_gap(dx, dy, *one, *two) == 0.0) == (depth > 0.0) == overlapping


@given(places, places, shapes, shapes)
def test_gap_is_the_same_from_both_sides(
    dx: float, dy: float, one: tuple[float, ...], two: tuple[float, ...]
) -> None:
    there = box_gap(dx, dy, *one, *two)
    assert box_gap(-dx, -dy, *two, *one) == pytest.approx(there, abs=1e-9)


@given(places, places, shapes, shapes, angles)
def test_gap_does_not_depend_on_where_east_is(
    dx: float, dy: float, one: tuple[float, ...], two: tuple[float, ...], turn: float
) -> None:
    cos, sin = math.cos(turn), math.sin(turn)
    first, second = (one[0] + turn, *one[1:]), (two[0] + turn, *two[1:])
    turned = box_gap(dx * cos - dy * sin, dx * sin + dy * cos, *first, *second)
    assert turned == pytest.approx(box_gap(dx, dy, *one, *two), abs=1e-8)


@settings(max_examples=200)
@given(places, places, speeds, speeds, shapes, shapes)
def test_boxes_touch_at_the_time_to_contact_and_not_before(
    dx: float, dy: float, vx: float, vy: float, one: tuple[float, ...], two: tuple[float, ...]
) -> None:
    time = time_to_contact(dx, dy, vx, vy, *one, *two)
    for share in (0.0, 0.3, 0.7, 0.99):
        moment = 20.0 * share if math.isinf(time) else time * share
        before = box_gap(dx + vx * moment, dy + vy * moment, *one, *two)
        if math.isinf(time):
            assert overlap_depth(dx + vx * moment, dy + vy * moment, *one, *two) <= 1e-9
        elif time > 1e-6:
            assert before > 0.0
    if math.isfinite(time):
        assert box_gap(dx + vx * time, dy + vy * time, *one, *two) <= 1e-6


def test_time_to_contact_of_a_car_behind_another_is_gap_over_closing_speed() -> None:
    time = time_to_contact(24.5, 0.0, -8.0, 0.0, 0.0, 4.5, 1.8, 0.0, 4.5, 1.8)
    assert time == pytest.approx(20.0 / 8.0)


def test_boxes_side_by_side_never_touch() -> None:
    assert time_to_contact(20.0, 3.5, -8.0, 0.0, 0.0, 4.5, 1.8, 0.0, 4.5, 1.8) == math.inf


@given(st.lists(st.tuples(places, places, angles, sizes, sizes), min_size=1, max_size=9))
def test_boxes_of_different_sizes_are_those_of_each_alone(boxes: list[tuple[float, ...]]) -> None:
    corners = box_corners(*np.array(boxes).T)
    alone = [np.array(polygon(*box).exterior.coords)[:4] for box in boxes]
    assert np.array_equal(corners, alone)
