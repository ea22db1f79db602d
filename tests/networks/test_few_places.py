"""Places that are projected without machine code are exactly those of the kernels."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.compilation import load_compiler
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks import few_places, projection
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.segment_index import segment_index

UNCERTAIN = (0.0, 0.5, 3.0, 30.0, 300.0)
"""Metres by which places are scattered around lanes."""


def scattered(network: RoadNetwork, count: int, seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    places = []
    for _ in range(count):
        shape = network.lanes[rng.integers(len(network.lanes))].shape
        places.append(shape[rng.integers(len(shape))] + rng.normal(0.0, rng.choice(UNCERTAIN), 2))
    return np.array(places)


def assert_same(one: tuple[np.ndarray, ...], other: tuple[np.ndarray, ...]) -> None:
    for left, right in zip(one, other, strict=True):
        assert left.dtype == right.dtype
        assert left.shape == right.shape
        assert left.tobytes() == right.tobytes()


@pytest.mark.parametrize("drivable", [True, False])
def test_lanes_near_a_place(town: RoadNetwork, drivable: bool) -> None:
    index = segment_index(town, drivable)
    found = 0
    for x, y in scattered(town, 300, seed=1).tolist():
        for radius in (3.0, 20.0, 100.0):
            near = projection._near(index, x, y, radius)
            assert_same(near, few_places.lanes_near(index, x, y, radius))
            found += len(near[0])
    assert found > 300


@pytest.mark.parametrize("headed", [True, False])
def test_lanes_of_a_trajectory(town: RoadNetwork, headed: bool) -> None:
    index = segment_index(town, True)
    points = np.repeat(scattered(town, 300, seed=2), 2, axis=0)
    rng = np.random.default_rng(3)
    headings = rng.uniform(-4.0, 4.0, len(points)) if headed else np.full(len(points), np.nan)
    kernel = projection._project(index, points, headings)
    assert_same(kernel, few_places.project(index, points, headings))
    assert (kernel[0] >= 0).sum() > 100


@given(x=st.floats(-150.0, 350.0), y=st.floats(-150.0, 350.0), radius=st.floats(0.0, 400.0))
def test_any_place_and_radius(loop: RoadNetwork, x: float, y: float, radius: float) -> None:
    index = segment_index(loop, True)
    near = projection._near(index, x, y, radius)
    assert_same(near, few_places.lanes_near(index, x, y, radius))
    points, headings = np.array([[x, y]]), np.array([radius])
    kernel = projection._project(index, points, headings)
    assert_same(kernel, few_places.project(index, points, headings))


def test_a_process_with_the_compiler_calls_the_kernels(
    loop: RoadNetwork, monkeypatch: pytest.MonkeyPatch
) -> None:
    load_compiler()
    monkeypatch.delattr(few_places, "lanes_near")
    monkeypatch.delattr(few_places, "project")
    x, y = loop.lanes[0].shape[0]
    assert projection.lane_positions_near(loop, x, y, drivable=False)
    assert len(projection.project_points(loop, np.array([[x, y]])).lane) == 1
