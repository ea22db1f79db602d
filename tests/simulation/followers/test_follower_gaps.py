"""The gap ahead of a follower, against a plain computation that looks at every actor."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.observations.trace import LEVEL_GAP, Col
from drivora_service.simulation.followers.follower_gaps import gap_ahead, order_actors
from drivora_service.simulation.followers.follower_path import PathCol, build_path, write_directions

REACH, HALF_LENGTH, HALF_WIDTH = 30.0, 2.2, 0.9


def way(rng: np.random.Generator, x: float, y: float) -> FloatArray:
    """Returns a path that begins at a place and winds."""
    turns = np.cumsum(rng.normal(0.0, 0.25, 40)) + rng.uniform(-math.pi, math.pi)
    steps = 1.7 * np.column_stack((np.cos(turns), np.sin(turns)))
    line = np.array([x, y]) + np.cumsum(steps, axis=0)
    path = build_path(
        line, np.array([5.0]), np.array([0.0]), None, friction=1.0, deceleration=4.0,
        is_vehicle=True,
    )  # fmt: skip
    points = np.zeros((len(path.arc), len(PathCol)))
    points[:, :2], points[:, PathCol.YAW], points[:, PathCol.ARC] = path.line, path.yaw, path.arc
    write_directions(points)
    return points


def plain_gap(
    row: int, path: FloatArray, s: float, states: FloatArray, sizes: FloatArray, present: BoolArray
) -> tuple[float, float, int]:
    """Checks every point of the path against every actor."""
    best = (math.inf, 0.0, -1)
    for j in np.flatnonzero(present).tolist():
        x, y, yaw, vx, vy = states[j, :5].tolist()
        length, width = sizes[j].tolist()
        size = 0.5 * math.hypot(length, width)
        if j == row or abs(states[j, Col.Z] - states[row, Col.Z]) > LEVEL_GAP:
            continue
        if math.hypot(x - path[0, 0], y - path[0, 1]) > REACH + HALF_LENGTH + size + 2.0:
            continue
        for point in path:
            at = float(point[PathCol.ARC]) - s
            if at > REACH + HALF_LENGTH + size:
                break
            dx, dy = x - float(point[PathCol.X]), y - float(point[PathCol.Y])
            near = HALF_WIDTH + size + 1.5
            if at < 0.0 or dx * dx + dy * dy > near * near:
                continue
            heading = float(point[PathCol.YAW])
            pcos, psin = math.cos(heading), math.sin(heading)
            along, side = dx * pcos + dy * psin, abs(-dx * psin + dy * pcos)
            c = abs(math.cos(yaw) * pcos + math.sin(yaw) * psin)
            d = abs(math.sin(yaw) * pcos - math.cos(yaw) * psin)
            across = 0.5 * (length * d + width * c)
            if abs(along) > 0.75 or side > HALF_WIDTH + across + 0.2:
                continue
            gap = at + along - HALF_LENGTH - 0.5 * (length * c + width * d)
            if gap < best[0]:
                best = (gap, vx * pcos + vy * psin, j)
            break
    return best


@pytest.mark.parametrize("tall", [False, True])
def test_the_gap_is_that_of_a_look_at_every_actor(tall: bool) -> None:
    rng = np.random.default_rng(3 + tall)
    found = 0
    for _ in range(60):
        count = int(rng.integers(1, 40))
        states = np.zeros((count, len(Col)))
        states[:, :2] = rng.uniform(-40.0, 40.0, (count, 2)) * ((1, 3) if tall else (3, 1))
        states[:, 2] = rng.uniform(-math.pi, math.pi, count)
        states[:, 3:5] = rng.normal(0.0, 5.0, (count, 2))
        states[:, Col.Z] = rng.choice([0.0, 8.0], count, p=[0.8, 0.2])
        sizes = rng.uniform((0.5, 0.5), (12.0, 2.5), (count, 2))
        present = rng.random(count) < 0.9
        order = order_actors(states, sizes, present)
        assert sorted(order.rows.tolist()) == np.flatnonzero(present).tolist()
        for row in range(count):
            path = way(rng, *states[row, :2].tolist())
            s = float(rng.uniform(0.0, path[1, PathCol.ARC]))
            expected = plain_gap(row, path, s, states, sizes, present)
            gap = gap_ahead(row, path, 0, s, REACH, HALF_LENGTH, HALF_WIDTH, states, sizes, order)
            assert gap == expected
            found += expected[2] >= 0
    assert found > 100


def test_of_two_actors_with_the_same_gap_the_first_counts() -> None:
    rng = np.random.default_rng(1)
    path = way(rng, 0.0, 0.0)
    states = np.zeros((3, len(Col)))
    states[1:, :2] = path[12, :2]
    sizes = np.full((3, 2), 2.0)
    present = np.ones(3, dtype=np.bool_)
    order = order_actors(states, sizes, present)
    found = gap_ahead(0, path, 0, 0.0, REACH, HALF_LENGTH, HALF_WIDTH, states, sizes, order)
    assert found[2] == 1
