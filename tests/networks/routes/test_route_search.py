"""The search for the cheapest way through lanes that passes places."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_graph import lane_graph
from drivora_service.networks.routes.route_search import Candidate, Way, search
from drivora_service.networks.routes.tight_turns import tight_turns

PAIRS = 150


def drawn_places(network: RoadNetwork, random: np.random.Generator) -> list[list[Candidate]]:
    """A few lane positions each of two places, with costs of their own."""
    lanes = [lane for lane in network.lanes if lane.drivable]
    return [
        [
            Candidate(
                lane=lane.index,
                s=float(random.uniform(0.0, lane.arc[-1])),
                cost=float(random.choice([0.0, 5.0, random.uniform(0.0, 400.0)])),
            )
            for lane in (lanes[random.integers(len(lanes))] for _ in range(random.integers(1, 5)))
        ]
        for _ in range(2)
    ]


def test_the_way_to_one_of_several_targets_is_the_cheapest_of_the_ways_to_each(
    shipped_network: RoadNetwork,
) -> None:
    # Whether a tight turn may be used depends on all candidates of a place.
    turns = {lane for turn in tight_turns(shipped_network) for lane in turn}
    graph, random = lane_graph(shipped_network), np.random.default_rng(5)
    found = 0
    for _ in range(PAIRS):
        sources, targets = drawn_places(shipped_network, random)
        ways = [search(graph, [sources, [target]]) for target in targets]
        costs = [way.cost for way in ways if isinstance(way, Way)]
        whole = search(graph, [sources, targets])
        if not costs:
            assert whole == 1
            continue
        assert isinstance(whole, Way)
        if turns.isdisjoint(one.lane for one in (*sources, *targets)):
            assert whole.cost == min(costs)
        (leg,) = whole.legs
        assert leg[-1].exit_lane in {target.lane for target in targets}
        found += 1
    assert found > PAIRS // 2


def test_a_place_in_between_is_passed_where_the_whole_way_is_cheapest(
    shipped_network: RoadNetwork,
) -> None:
    graph, random = lane_graph(shipped_network), np.random.default_rng(6)
    turns = {lane for turn in tight_turns(shipped_network) for lane in turn}
    for _ in range(PAIRS):
        first, middle = drawn_places(shipped_network, random)
        last, _ = drawn_places(shipped_network, random)
        if not turns.isdisjoint(one.lane for one in (*first, *middle, *last)):
            continue
        ways = [search(graph, [first, [one], last]) for one in middle]
        costs = [way.cost for way in ways if isinstance(way, Way)]
        whole = search(graph, [first, middle, last])
        assert (whole.cost if isinstance(whole, Way) else math.inf) == min(costs, default=math.inf)
