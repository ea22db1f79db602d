"""Overlap of oriented boxes, against polygons of a geometry library."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import Polygon

from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.geometry.outlines import box_corners
from drivora_service.simulation.motion.contacts import find_contacts

places = st.floats(-6, 6)
angles = st.floats(-math.pi, math.pi)
sizes = st.floats(0.3, 8.0)


def polygon(x: float, y: float, yaw: float, length: float, width: float) -> Polygon:
    corners = box_corners(np.array([x]), np.array([y]), np.array([yaw]), length, width)
    return Polygon(corners[0])


@settings(max_examples=300, deadline=None)
@given(x=places, y=places, a=angles, b=angles, l1=sizes, w1=sizes, l2=sizes, w2=sizes)
def test_agrees_with_polygons(
    x: float, y: float, a: float, b: float, l1: float, w1: float, l2: float, w2: float
) -> None:
    one, other = polygon(0.0, 0.0, a, l1, w1), polygon(x, y, b, l2, w2)
    shared = one.intersection(other).area
    assume(shared == 0.0 or shared > 1e-6)
    assume(one.distance(other) == 0.0 or one.distance(other) > 1e-6)
    overlap = boxes_overlap(0.0, 0.0, a, l1, w1, x, y, b, l2, w2)
    assert overlap == (shared > 0.0)
    assert overlap == boxes_overlap(x, y, b, l2, w2, 0.0, 0.0, a, l1, w1)


def test_a_pair_is_found_once_and_absent_actors_never() -> None:
    states = np.zeros((3, 9))
    states[1, 0] = 1.0
    states[2, 1] = 0.5
    size = np.full((3, 2), (4.0, 2.0))
    present = np.array([True, True, False])
    seen = np.zeros((1, 3), dtype=np.bool_)
    found = np.zeros((8, 2), dtype=np.int64)
    active = np.array([True])
    assert find_contacts(states, size, present, active, seen, found) == 1
    assert found[0].tolist() == [0, 1]
    assert find_contacts(states, size, present, active, seen, found) == 0
    present[2] = True
    assert find_contacts(states, size, present, active, seen, found) == 1
    assert found[0].tolist() == [0, 2]
