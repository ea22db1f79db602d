"""Boxes that overlap: as Shapely finds them."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate, translate
from shapely.geometry import Polygon, box

from drivora_service.agents.adapters.overlap import overlap

PLACE = st.floats(-6.0, 6.0)
POSE = st.tuples(PLACE, PLACE, st.floats(-math.pi, math.pi))
SIZE = st.tuples(st.floats(0.3, 6.0), st.floats(0.3, 3.0))


def polygon(pose: tuple[float, float, float], size: tuple[float, float]) -> Polygon:
    long, wide = 0.5 * size[0], 0.5 * size[1]
    turned = rotate(box(-long, -wide, long, wide), pose[2], origin=(0, 0), use_radians=True)
    return translate(turned, pose[0], pose[1])


@given(POSE, SIZE, POSE, SIZE)
def test_boxes_overlap_as_polygons_do(
    one: tuple[float, float, float],
    size: tuple[float, float],
    other: tuple[float, float, float],
    other_size: tuple[float, float],
) -> None:
    met = overlap(np.array([one]), size, np.array([[other]]), np.array([other_size]))
    a, b = polygon(one, size), polygon(other, other_size)
    # Where they graze, rounding decides.
    if a.intersection(b).area > 1e-6:
        assert met.tolist() == [[True]]
    elif a.distance(b) > 1e-6:
        assert met.tolist() == [[False]]


def test_every_other_is_compared_at_every_time() -> None:
    mine = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    others = np.array([[[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]], [[12.0, 0.0, 0.0], [12.0, 0.0, 0.0]]])
    sizes = np.array([[4.0, 2.0], [4.0, 2.0]])
    assert overlap(mine, (4.0, 2.0), others, sizes).tolist() == [[True, False], [False, True]]
