"""Ways along lanes: connected, of the wanted length, in every direction."""

from __future__ import annotations

import pytest

from drivora_service.search.space.lane_walks import LaneWalk, walks_from
from drivora_service.testing.networks import EAST, WEST, straight_road
from tests.search.space.seeds import NETWORKS, SHIPPED


@pytest.mark.parametrize("town", SHIPPED)
def test_walks_are_connected_and_end_on_roads(town: str) -> None:
    network = NETWORKS.get(town)
    roads = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    for lane in roads[::5]:
        walks = list(walks_from(network, lane.index, 1.0, 150.0))
        assert walks
        assert len({walk.lanes for walk in walks}) == len(walks)
        for walk in walks:
            assert len(set(walk.lanes)) == len(walk.lanes)
            for here, there in zip(walk.lanes, walk.lanes[1:], strict=False):
                assert there in {link.to_lane for link in network.lanes[here].connections}
            last = network.lanes[walk.lanes[-1]]
            assert not last.is_internal
            assert 0.0 < walk.end_s <= float(last.arc[-1])


def test_a_walk_is_as_long_as_wanted() -> None:
    network = NETWORKS.get("tee-town")
    start = network.lane("-close_1_0")
    for walk in walks_from(network, start.index, 10.0, 150.0):
        lanes = [network.lanes[lane] for lane in walk.lanes]
        length = sum(float(lane.arc[-1]) for lane in lanes[:-1]) - 10.0 + walk.end_s
        # Those that would end inside a junction lead on behind it.
        assert 150.0 - 1e-6 <= length <= 150.0 + 30.0


def test_all_directions_are_taken() -> None:
    network = NETWORKS.get("tee-town")
    start = network.lane("-close_1_0")
    second = {walk.lanes[1] for walk in walks_from(network, start.index, 10.0, 150.0)}
    assert second == {link.to_lane for link in start.connections if link.direction != "t"}


def test_a_walk_ends_where_the_road_ends() -> None:
    road = straight_road()
    (walk,) = walks_from(road, WEST, 900.0, 300.0)
    assert walk == LaneWalk(lanes=(WEST,), start_s=900.0, end_s=1000.0)


def test_a_walk_along_one_lane() -> None:
    (walk,) = walks_from(straight_road(), EAST, 100.0, 300.0)
    assert walk == LaneWalk(lanes=(EAST,), start_s=100.0, end_s=400.0)
