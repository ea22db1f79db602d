"""The friction of the road at places, against polygons of another library."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Point, Polygon
from shapely.affinity import rotate, translate

from drivora_service.observations.ground import (
    NO_PATCHES,
    axle_frictions,
    friction_at,
    frictions_along,
    patch_array,
    wheelbase_of,
)
from drivora_service.observations.trace import Actor, Role

Recorded = dict[str, float]

patches = st.fixed_dictionaries(
    {
        "x": st.floats(-20, 20),
        "y": st.floats(-20, 20),
        "z": st.sampled_from([0.0, 2.0, 6.0]),
        "yaw": st.floats(-7, 7),
        "length": st.floats(0.5, 40),
        "width": st.floats(0.5, 40),
        "friction": st.floats(0.02, 1.0),
    }
)


def outline(patch: Recorded) -> Polygon:
    half, side = 0.5 * patch["length"], 0.5 * patch["width"]
    box = Polygon([(half, side), (-half, side), (-half, -side), (half, -side)])
    turned = rotate(box, patch["yaw"], origin=(0, 0), use_radians=True)
    return translate(turned, patch["x"], patch["y"])


@given(
    known=st.lists(patches, max_size=4),
    x=st.floats(-25, 25),
    y=st.floats(-25, 25),
    road=st.floats(0.4, 1.0),
)
def test_the_least_friction_of_the_rectangles_around_a_place_counts(
    known: list[Recorded], x: float, y: float, road: float
) -> None:
    place, outlines = Point(x, y), [(outline(patch), patch) for patch in known]
    if any(one.boundary.distance(place) < 1e-6 for one, _ in outlines):
        return
    # A place at 0.5 m is less than 3 m below a patch at 2 m, and more below one at 6 m.
    here = [p["friction"] for one, p in outlines if one.contains(place) and p["z"] < 3.0]
    assert friction_at(x, y, 0.5, road, patch_array(known)) == min([road, *here])


def test_each_axle_has_the_friction_of_its_place() -> None:
    ice = patch_array(
        [{"x": 10.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "length": 4.0, "width": 2.0, "friction": 0.1}]
    )

    def at(x: float, y: float, yaw: float) -> tuple[float, float]:
        return axle_frictions(x, y, 0.0, math.cos(yaw), math.sin(yaw), 3.0, 0.9, ice)

    assert at(6.4, 0.0, 0.0) == (0.9, 0.9)
    assert at(6.6, 0.0, 0.0) == (0.1, 0.9)
    assert at(10.0, 0.0, 0.0) == (0.1, 0.1)
    assert at(13.4, 0.0, 0.0) == (0.9, 0.1)
    assert at(13.4, 0.0, math.pi) == (0.1, 0.9)
    assert at(10.0, 2.4, math.pi / 2) == (0.9, 0.1)
    assert at(10.0, 2.6, math.pi / 2) == (0.9, 0.9)


def test_a_vehicle_has_the_mean_of_its_axles_and_without_a_wheelbase_that_of_its_centre() -> None:
    ice = patch_array(
        [{"x": 10.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "length": 4.0, "width": 2.0, "friction": 0.1}]
    )
    poses = np.array([(0.0, 0.0, 0.0), (7.0, 0.0, 0.0), (10.0, 0.0, 0.0)])
    heights = np.zeros(3)
    assert frictions_along(poses, heights, 3.0, 0.9, ice) == pytest.approx([0.9, 0.5, 0.1])
    assert frictions_along(poses, heights, 0.0, 0.9, ice) == pytest.approx([0.9, 0.9, 0.1])
    assert frictions_along(poses, heights, 3.0, 0.9, NO_PATCHES).tolist() == [0.9] * 3


def test_the_wheelbase_is_that_of_the_model() -> None:
    def actor(model: str) -> Actor:
        return Actor(row=0, id="a", role=Role.EGO, model=model, length=5.0, width=2.0)

    assert wheelbase_of(actor("vehicle.lincoln.mkz_2017")) == 2.85
    assert wheelbase_of(actor("unknown")) == pytest.approx(3.0)
