"""Lanes with pieces that run backwards, as converters write them by rounding."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.verdict import Outcome
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.simulation.episodes import ROAD, ego, place, scenario


def beside(lane: Lane, s: float, left: float) -> tuple[float, float]:
    x, y, yaw = lane.position_at(s)
    return x - left * math.sin(yaw), y + left * math.cos(yaw)


@pytest.fixture
def rough(tmp_path: Path) -> RoadNetwork:
    """tee-town, where every 5 m of a street run back by 0.4 m."""
    folder = shipped_networks() / "tee-town"
    text = (folder / "tee-town.net.xml").read_text(encoding="utf-8")
    smooth = NetworkCatalogue(shipped_networks()).get("tee-town").lane(ROAD)
    points = [smooth.position_at(0.0)[:2]]
    for s in np.arange(5.0, float(smooth.arc[-1]) - 5.0, 5.0).tolist():
        points += [beside(smooth, s, 0.1), beside(smooth, s - 0.4, -0.1)]
    points.append(smooth.position_at(float(smooth.arc[-1]))[:2])
    shape = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
    pattern = rf'(<lane id="{ROAD}"[^>]* shape=")[^"]*(")'
    changed, count = re.subn(pattern, rf"\g<1>{shape}\g<2>", text)
    assert count == 1
    (tmp_path / "tee-town.net.xml").write_text(changed, encoding="utf-8")
    return NetworkCatalogue(tmp_path).get("tee-town")


def test_backward_pieces_are_left_out(rough: RoadNetwork) -> None:
    smooth = NetworkCatalogue(shipped_networks()).get("tee-town").lane(ROAD)
    lane = rough.lane(ROAD)
    steps = np.diff(lane.shape, axis=0)
    assert all(float(a @ b) > 0.0 for a, b in pairwise(steps))
    assert float(lane.arc[-1]) == pytest.approx(float(smooth.arc[-1]), abs=0.2)
    for s in np.linspace(0.0, float(smooth.arc[-1]), 40).tolist():
        assert np.hypot(*(lane.shape - smooth.position_at(s)[:2]).T).min() < 6.0
    assert (lane.shape[0], lane.shape[-1]) == (
        pytest.approx(smooth.shape[0], abs=0.01),
        pytest.approx(smooth.shape[-1], abs=0.01),
    )


def test_driving_along_them_keeps_the_lane(rough: RoadNetwork) -> None:
    plan = plan_episode(scenario(ego(place(ROAD, 10), place(ROAD, 110)), seconds=40.0), rough)
    episode = Episode(plan, [IdmAgent()])
    while not episode.done:
        episode.step()
    (verdict,) = LaneKeeping().judge(RunView(episode.finish(), rough))
    assert verdict.outcome is Outcome.PASSED
