from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.networks.projection import (
    lane_positions_near,
    nearest_lane_position,
    project_points,
)
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.segment_index import CELL, segment_index


def beside(lane: Lane, s: float, lateral: float) -> tuple[float, float, float]:
    x, y, heading = lane.position_at(s)
    return x - math.sin(heading) * lateral, y + math.cos(heading) * lateral, heading


def distance_to_lane(lane: Lane, x: float, y: float) -> float:
    """The plain way, for comparison."""
    start, step = lane.shape[:-1], np.diff(lane.shape, axis=0)
    to_point = np.array([x, y]) - start
    t = np.clip((to_point * step).sum(axis=1) / (step**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(to_point - t[:, None] * step).T).min())


@given(data=st.data())
def test_recovers_the_lane_position_of_a_point_built_from_one(
    loop: RoadNetwork, data: st.DataObject
) -> None:
    lane = loop.lane(data.draw(st.sampled_from(["a_1", "a_2", "b_0", "b_1", "c_0"])))
    s = data.draw(st.floats(0.01, float(lane.arc[-1]) - 0.01))
    lateral = data.draw(st.floats(-1.4, 1.4))
    x, y, heading = beside(lane, s, lateral)
    position = nearest_lane_position(loop, x, y, heading=heading)
    assert position is not None
    assert position.lane == lane.index
    assert position.s == pytest.approx(s, abs=1e-6)
    assert position.lateral == pytest.approx(lateral, abs=1e-6)
    assert position.heading == pytest.approx(heading)


def test_agrees_with_the_plain_way_on_real_towns(town: RoadNetwork) -> None:
    rng = np.random.default_rng(7)
    lanes = [lane for lane in town.lanes if lane.drivable]
    for _ in range(60):
        lane = lanes[rng.integers(len(lanes))]
        x, y, _ = beside(lane, rng.uniform(0.0, lane.arc[-1]), rng.normal(0.0, 6.0))
        plain = {one.index: distance_to_lane(one, x, y) for one in lanes}
        near = lane_positions_near(town, x, y, max_distance=25.0)
        assert {p.lane for p in near} == {i for i, d in plain.items() if d <= 25.0}
        for position in near:
            assert abs(position.lateral) == pytest.approx(plain[position.lane], abs=1e-6)
            foot = beside(town.lanes[position.lane], position.s, 0.0)
            assert math.hypot(foot[0] - x, foot[1] - y) == pytest.approx(
                plain[position.lane], abs=1e-6
            )
        distances = [abs(p.lateral) for p in near]
        assert distances == sorted(distances)
        for heading in (None, rng.uniform(-math.pi, math.pi)):
            ranked = lane_positions_near(town, x, y, max_distance=25.0, heading=heading)
            nearest = nearest_lane_position(town, x, y, max_distance=25.0, heading=heading)
            assert nearest == ranked[0]
            assert {p.lane for p in ranked} == {p.lane for p in near}


def test_lateral_is_positive_to_the_left(loop: RoadNetwork) -> None:
    left = nearest_lane_position(loop, 30.0, -0.5)
    right = nearest_lane_position(loop, 230.0, 1.0)
    assert left is not None
    assert right is not None
    assert (left.lateral, right.lateral) == pytest.approx((-0.5, 1.0))


def test_heading_decides_between_lanes_that_cross(loop: RoadNetwork) -> None:
    """The corner of d: one lane goes north there; c's end goes east."""
    x, y = 259.9, 0.2
    eastwards = nearest_lane_position(loop, x, y, heading=0.0)
    northwards = nearest_lane_position(loop, x, y, heading=math.pi / 2)
    assert eastwards is not None
    assert northwards is not None
    assert loop.lanes[eastwards.lane].id == "c_0"
    assert loop.lanes[northwards.lane].id == "d_0"


def test_only_drivable_lanes_unless_asked(loop: RoadNetwork) -> None:
    on_sidewalk = (30.0, -2.6)
    drivable = nearest_lane_position(loop, *on_sidewalk)
    every = nearest_lane_position(loop, *on_sidewalk, drivable=False)
    assert drivable is not None
    assert every is not None
    assert loop.lanes[drivable.lane].id == "a_1"
    assert loop.lanes[every.lane].id == "a_0"


@pytest.mark.parametrize("place", [(1e6, 1e6), (-1e9, 3.0), (130.0, 30.0), (math.nan, 0.0)])
def test_nothing_is_near_a_place_far_away(loop: RoadNetwork, place: tuple[float, float]) -> None:
    assert nearest_lane_position(loop, *place) is None
    assert project_points(loop, np.array([place])).lane.tolist() == [-1]


def test_projects_a_drive_through_the_lanes(loop: RoadNetwork) -> None:
    x = np.arange(1.0, 259.0, 0.5)
    seen = project_points(loop, np.column_stack((x, np.full_like(x, 0.1))), np.zeros_like(x))
    names = list(dict.fromkeys(loop.lanes[i].id for i in seen.lane))
    assert [name for name in names if name != ":n2_0_0"] == ["a_1", ":n1_0_0", "b_0", "c_0"]
    assert seen.lateral == pytest.approx(np.full_like(x, 0.1))
    on_a = seen.lane == loop.lane_by_id["a_1"]
    assert seen.s[on_a] == pytest.approx(x[on_a])


def test_off_every_lane_nothing_is_known(loop: RoadNetwork) -> None:
    seen = project_points(loop, np.array([[30.0, 0.0], [30.0, 6.0], [30.0, 3.0]]))
    assert seen.lane.tolist() == [loop.lane_by_id["a_1"], -1, loop.lane_by_id["a_2"]]
    assert np.isnan([seen.s[1], seen.lateral[1], seen.heading[1]]).all()


def test_a_lane_ends_where_it_ends(loop: RoadNetwork) -> None:
    """b_1 is a dead end at x = 200: a metre behind it is the end of it, two are off it."""
    seen = project_points(loop, np.array([[200.9, 3.2], [202.1, 3.2]]))
    assert seen.lane.tolist() == [loop.lane_by_id["b_1"], -1]


def test_stays_on_its_lane_between_two_that_are_equally_near(loop: RoadNetwork) -> None:
    x = np.arange(10.0, 90.0)
    y = np.full_like(x, 1.6)
    for first in ("a_1", "a_2"):
        y[0] = loop.lane(first).shape[0, 1]
        seen = project_points(loop, np.column_stack((x, y)), np.zeros_like(x))
        assert set(seen.lane.tolist()) == {loop.lane_by_id[first]}


def test_going_the_wrong_way_still_is_on_the_lane(loop: RoadNetwork) -> None:
    seen = project_points(loop, np.array([[30.0, 0.0]]), np.array([math.pi]))
    assert seen.lane.tolist() == [loop.lane_by_id["a_1"]]
    assert seen.heading.tolist() == [0.0]


def test_projects_along_every_lane_of_real_towns(town: RoadNetwork) -> None:
    for lane in town.lanes:
        s = np.linspace(0.02, 0.98, 20) * lane.arc[-1]
        poses = np.array([lane.position_at(v) for v in s])
        seen = project_points(town, poses[:, :2], poses[:, 2])
        assert (seen.lane >= 0).all()
        assert (np.abs(seen.lateral) < 1.0).all()
        assert (np.cos(seen.heading - poses[:, 2]) > 0.8).all()


def test_no_points(loop: RoadNetwork) -> None:
    assert project_points(loop, np.empty((0, 2))).lane.shape == (0,)


def test_every_segment_is_in_every_cell_it_touches(town: RoadNetwork) -> None:
    index = segment_index(town, True)
    assert (index.segments[:, 4] <= CELL + 1e-9).all()
    for t in (0.0, 0.3, 0.5, 1.0):
        at = index.segments[:, :2] + t * index.segments[:, 2:4] * index.segments[:, 4:5]
        column, row = ((at - index.origin) // CELL).astype(int).T
        for number, cell in enumerate(row * index.columns + column):
            members = index.cell_items[index.cell_starts[cell] : index.cell_starts[cell + 1]]
            assert number in members
