"""From CARLA's frame to the network's and back."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.scenario.frames import FrameTransform

metres = st.floats(-1e5, 1e5)


@given(metres, metres, metres, metres, st.booleans())
def test_places_are_moved_and_mirrored(
    x: float, y: float, offset_x: float, offset_y: float, mirrored: bool
) -> None:
    frame = FrameTransform(offset_x=offset_x, offset_y=offset_y, mirrored=mirrored)
    north = -y if mirrored else y
    east, up = frame.to_network(x, y)
    assert (east - offset_x, up - offset_y) == pytest.approx((x, north), abs=1e-9)


@given(st.floats(-180, 179.999), st.booleans())
def test_there_and_back_is_the_same_heading(degrees: float, mirrored: bool) -> None:
    frame = FrameTransform(mirrored=mirrored)
    back = frame.yaw_from_network(frame.yaw_to_network(degrees))
    assert math.cos(math.radians(back - degrees)) == pytest.approx(1.0)


@given(metres, metres, metres, metres)
def test_distances_stay(x: float, y: float, to_x: float, to_y: float) -> None:
    frame = FrameTransform(offset_x=3.0, offset_y=-5.0, mirrored=True)
    before = math.hypot(x - to_x, y - to_y)
    after = math.dist(frame.to_network(x, y), frame.to_network(to_x, to_y))
    assert after == pytest.approx(before, abs=1e-6)


def test_carla_counts_clockwise_from_east_with_y_to_the_south() -> None:
    frame = FrameTransform(offset_x=10.0, offset_y=330.0, mirrored=True)
    assert frame.to_network(5.0, 100.0) == (15.0, 230.0)
    assert frame.yaw_to_network(90.0) == pytest.approx(-math.pi / 2)
    assert frame.yaw_to_network(270.0) == pytest.approx(math.pi / 2)


def test_zero_has_no_sign() -> None:
    frame = FrameTransform(mirrored=True)
    assert math.copysign(1.0, frame.yaw_to_network(0.0)) == 1.0
    assert math.copysign(1.0, frame.to_network(-0.0, 0.0)[1]) == 1.0
