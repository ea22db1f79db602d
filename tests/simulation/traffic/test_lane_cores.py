"""The cores of lanes, against all lanes of the network."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.simulation.traffic.lane_cores import LATERAL, lane_cores
from tests.simulation.episodes import network


def distances(shape: FloatArray, x: float, y: float) -> float:
    """Metres from a place to a line."""
    begin, step = shape[:-1], np.diff(shape, axis=0)
    along = ((np.array((x, y)) - begin) * step).sum(axis=1)
    t = np.clip(along / np.maximum((step**2).sum(axis=1), 1e-12), 0.0, 1.0)
    foot = begin + t[:, None] * step
    return float(np.hypot(foot[:, 0] - x, foot[:, 1] - y).min())


@pytest.mark.parametrize("name", ["tee-town", "roundabout", "signal-grid", "highway"])
def test_on_its_core_a_vehicle_is_nearest_to_its_own_lane(name: str) -> None:
    town = network(name)
    cores = lane_cores(town)
    rng = np.random.default_rng(1)
    checked = 0
    for lane in town.lanes:
        begin, end = cores.begin[lane.index], cores.end[lane.index]
        if end <= begin:
            continue
        assert lane.drivable
        assert not lane.is_internal
        for s in rng.uniform(begin, end, 4):
            x, y, yaw = lane.position_at(float(s))
            aside = float(rng.uniform(-LATERAL, LATERAL))
            x, y = x - aside * np.sin(yaw), y + aside * np.cos(yaw)
            mine = distances(lane.shape, x, y)
            others = [
                distances(one.shape, x, y)
                for one in town.lanes
                if one.drivable and one.index != lane.index
            ]
            assert min(others) > mine
            checked += 1
    assert checked > 50


def test_most_of_a_long_lane_is_its_core() -> None:
    town = network("highway")
    cores = lane_cores(town)
    long = [lane for lane in town.lanes if lane.drivable and lane.arc[-1] > 300.0]
    shares = [
        (cores.end[lane.index] - cores.begin[lane.index]) / lane.arc[-1]
        for lane in long
        if np.isfinite(cores.begin[lane.index])
    ]
    assert len(shares) > 0.8 * len(long)
    assert np.median(shares) > 0.8
