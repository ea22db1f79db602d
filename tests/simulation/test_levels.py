"""Bridges: actors on different levels do not meet, on a town that has some."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.observations.trace import LEVEL_GAP, Col
from drivora_service.scenario.model import MapRegion, Scenario, Waypoint
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.simulation.episodes import Watching, car, ego


@pytest.fixture(scope="module")
def town(shared_data: Path) -> RoadNetwork:
    return load_network(shared_data / "maps" / "Town04.net.xml", "Town04")


def crossing(town: RoadNetwork) -> tuple[Lane, float, Lane, float]:
    """An upper and a lower lane that cross, with the arc lengths of the crossing."""
    lanes = [
        lane for lane in town.lanes if lane.drivable and not lane.is_internal and lane.length > 80
    ]
    samples = [
        (lane, s, *lane.position_at(s)[:2], float(np.interp(s, lane.arc, lane.heights)))
        for lane in lanes
        for s in np.arange(50.0, lane.length - 20.0, 2.0)
    ]
    x, y, z = (np.array([sample[k] for sample in samples]) for k in (2, 3, 4))
    for i, (lane, s, *_) in enumerate(samples):
        near = np.flatnonzero((np.hypot(x - x[i], y - y[i]) < 1.0) & (z[i] - z > LEVEL_GAP + 1.0))
        if len(near):
            return lane, float(s), samples[near[0]][0], float(samples[near[0]][1])
    raise AssertionError("no bridge found")


def at(lane: Lane, s: float) -> Waypoint:
    x, y, yaw = lane.position_at(s)
    return Waypoint(x=x, y=y, yaw=yaw, z=float(np.interp(s, lane.arc, lane.heights)))


def test_actors_on_different_levels_neither_collide_nor_see_each_other(town: RoadNetwork) -> None:
    upper, s, lower, below = crossing(town)
    eye = Watching()
    scenario = Scenario(
        ego_vehicles=(
            ego(at(upper, s - 40.0), at(upper, s + 15.0), name="crosses"),
            ego(at(lower, below), at(lower, below + 12.0), name="stands"),
        ),
        npc_vehicles=(car(at(upper, s - 15.0), at(upper, s + 18.0), name="ahead"),),
        map_region=MapRegion(town="Town04"),
        max_sim_time=12.0,
    )
    episode = Episode(plan_episode(scenario, town), [IdmAgent(), eye])
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert not trace.contacts
    heights = trace.states[:, :, Col.Z]
    assert np.nanmin(heights[:, 0] - heights[:, 1]) > LEVEL_GAP
    gap = np.hypot(*(trace.states[:, 0, :2] - trace.states[:, 1, :2]).T)
    assert np.nanmin(gap) < 3.0
    assert all(len(objects) == 0 for objects in eye.seen)
