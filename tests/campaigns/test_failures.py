"""Kinds and groups of failures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from sklearn.cluster import DBSCAN

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.search.failure_grouping import Grouping, scale, situation_features
from drivora_service.campaigns.search.failure_kinds import FailureKinds, junction_of
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.failure_facts import relation


def violation(
    oracle: str = "collision",
    *,
    location: tuple[float, float] | None = (0.0, 0.0),
    time: float | None = 1.0,
    **evidence: Any,
) -> Verdict:
    return Verdict(
        oracle=oracle,
        ego="ego_0",
        outcome=Outcome.VIOLATED,
        message="",
        at_fault=True,
        time=time,
        location=location,
        counterpart="npc",
        evidence=evidence,
    )


@pytest.fixture(scope="module")
def keys(catalogues: Catalogues) -> FailureKinds:
    return FailureKinds(catalogues.networks.get("tee-town"))


def test_a_kind_names_oracle_place_and_relation(keys: FailureKinds) -> None:
    network = keys.network
    road = next(lane for lane in network.lanes if lane.drivable and not lane.is_internal)
    x, y, _ = road.position_at(0.5 * float(road.arc[-1]))
    key = keys(violation(location=(x, y), counterpart_role="npc_vehicle", face="side"))
    assert key == f"collision|road {road.edge_id}|npc_vehicle, side"


def test_all_of_a_junction_is_one_place(keys: FailureKinds) -> None:
    inside: dict[str, set[str]] = {}
    for lane in keys.network.lanes:
        if lane.drivable and lane.is_internal:
            x, y, _ = lane.position_at(0.5 * float(lane.arc[-1]))
            place = keys.place(violation(location=(x, y)))
            inside.setdefault(junction_of(lane.edge_id), set()).add(place)
    assert inside
    assert set(inside) <= set(keys.network.junction_shapes)
    assert inside == {junction: {f"junction {junction}"} for junction in inside}


def test_lanes_of_one_road_are_one_place_and_its_directions_are_two(keys: FailureKinds) -> None:
    edges = {lane.edge_id for lane in keys.network.lanes if lane.drivable and not lane.is_internal}
    places = set()
    for lane in keys.network.lanes:
        if lane.drivable and not lane.is_internal:
            x, y, _ = lane.position_at(0.5 * float(lane.arc[-1]))
            places.add(keys.place(violation(location=(x, y))))
    assert places == {f"road {edge}" for edge in edges}


def test_what_is_not_known_is_left_out(keys: FailureKinds) -> None:
    assert keys(violation("blocked", location=None)) == "blocked"
    assert keys(violation("off_road", location=(1e5, 1e5))) == "off_road|off every road"


@pytest.mark.parametrize(
    ("evidence", "said"),
    [
        ({"counterpart_role": "walker", "face": "front"}, "walker, front"),
        ({"face": "rear"}, "rear"),
        ({"cycle": ["ego_0", "ego_1", "ego_2"]}, "cycle of 3"),
        ({"speed": 3.0}, ""),
    ],
)
def test_the_relation_is_what_the_oracle_tells(evidence: dict[str, Any], said: str) -> None:
    assert relation(evidence) == said


def test_junctions_with_underlines_in_their_names() -> None:
    assert junction_of(":C_north_12") == "C_north"


def test_near_failures_are_a_group_and_far_ones_are_not() -> None:
    here = [violation(location=(0.3 * i, 0.0), time=5.0, ego_speed=6.0) for i in range(4)]
    there = [violation(location=(80.0 + 0.3 * i, 40.0), time=9.0, ego_speed=2.0) for i in range(3)]
    alone = violation(location=(0.0, 90.0), time=30.0, ego_speed=6.0)
    labels = Grouping().label([*here, alone, *there])
    assert len(set(labels[:4])) == len(set(labels[5:])) == 1
    assert len({labels[0], labels[4], labels[5]}) == 3


def test_groups_are_within_an_oracle() -> None:
    verdicts = [violation("collision"), violation("off_road"), violation("collision")]
    assert Grouping().label(verdicts) == (0, 0, 0)


def test_a_failure_without_neighbours_is_a_group() -> None:
    alone = violation(location=(0.0, 90.0), time=30.0)
    assert Grouping().label([alone]) == (0,)
    far = violation(location=(80.0, 0.0), time=5.0)
    assert Grouping().label([alone, far]) == (0, 1)


@pytest.mark.parametrize("count", [2, 30, 300])
def test_groups_are_those_of_dbscan_with_single_failures_as_cores(count: int) -> None:
    random = np.random.default_rng(count)
    verdicts = [
        violation(location=(float(x), float(y)), time=float(t), ego_speed=float(v))
        for x, y, t, v in random.uniform(0.0, 30.0, (count, 4))
    ]
    points = scale(situation_features(verdicts)) / 2.0
    expected = DBSCAN(eps=0.15, min_samples=1).fit_predict(points)
    assert Grouping().label(verdicts) == tuple(expected.tolist())


def test_small_differences_are_not_stretched() -> None:
    nearly = [violation(location=(0.1 * i, 0.0), time=5.0 + 0.05 * i) for i in range(5)]
    assert set(Grouping().label(nearly)) == {0}


def test_words_of_a_fixed_set_are_features_and_messages_are_not() -> None:
    one = situation_features(
        [violation(face="front", reason="a"), violation(face="side", reason="b")]
    )
    assert one.tolist() == [[0.0, 0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 0.0, 1.0]]


def test_features_are_those_that_all_have() -> None:
    verdicts = [
        violation(speed=1.0, gap=math.nan, standing=True),
        violation(speed=2.0, gap=1.0, standing=False, extra=5.0),
    ]
    assert situation_features(verdicts)[:, 3:].tolist() == [[1.0], [2.0]]
    nowhere = [violation(location=None, time=None), violation()]
    assert situation_features(nowhere).shape == (2, 0)
    assert Grouping().label(nowhere) == (0, 0)
    assert Grouping().label([]) == ()


def test_scaling_is_by_least_and_greatest() -> None:
    scaled = scale(np.array([[0.0, 5.0], [50.0, 5.5], [100.0, 5.2]]))
    assert scaled[:, 0].tolist() == [0.0, 0.5, 1.0]
    assert scaled[:, 1] == pytest.approx([0.0, 0.5, 0.2])


def test_the_order_of_failures_does_not_change_groups() -> None:
    random = np.random.default_rng(4)
    verdicts = [
        violation(location=(float(x), float(y)), time=float(t))
        for x, y, t in random.uniform(0.0, 60.0, (30, 3))
    ]
    labels = Grouping().label(verdicts)
    order = random.permutation(30)
    shuffled = Grouping().label([verdicts[i] for i in order])
    pairs = {(labels[i], shuffled[k]) for k, i in enumerate(order)}
    assert len(pairs) == len(set(labels)) == len(set(shuffled))
