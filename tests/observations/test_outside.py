"""How far a box is off the road, wherever it is: in bends, at the ends of lanes, across them."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.drivable_area import outside_distance
from drivora_service.networks.projection import project_points
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace

NETWORKS = NetworkCatalogue(shipped_networks())
BOXES = 2000


def boxes_on_lanes(town: str, length: float, width: float) -> EgoView:
    """An ego that is at random places of all lanes, more or less along them."""
    network = NETWORKS.get(town)
    random = np.random.default_rng(7)
    lanes = [lane for lane in network.lanes if lane.drivable]
    states = np.zeros((BOXES, len(Col)))
    for k in range(BOXES):
        lane = lanes[random.integers(len(lanes))]
        x, y, heading = lane.position_at(random.uniform(0.0, lane.arc[-1]))
        left = random.uniform(-0.5, 0.5) * lane.width
        states[k, Col.X] = x - left * np.sin(heading)
        states[k, Col.Y] = y + left * np.cos(heading)
        states[k, Col.YAW] = heading + random.choice([0.0, random.normal(0.0, 0.1)])
    found = project_points(network, states[:, :2].copy(), states[:, Col.YAW].copy())
    ego = SyntheticEgo(
        motion=Motion(states=states),
        length=length,
        width=width,
        lane=found.lane,
        lane_lateral=found.lateral,
        lane_heading=found.heading,
    )
    return RunView(make_trace([ego]), network).egos[0]


@pytest.mark.parametrize("town", NETWORKS.names())
@pytest.mark.parametrize(("length", "width"), [(4.5, 1.8), (10.3, 2.5)])
def test_corners_off_the_road_are_seen_in_bends(town: str, length: float, width: float) -> None:
    ego = boxes_on_lanes(town, length, width)
    measured = outside_distance(ego.network, ego.corners.reshape(-1, 2)).reshape(-1, 4).max(axis=1)
    assert np.count_nonzero(measured > 0.3) > 20
    assert np.abs(ego.outside - measured).max() == 0.0
