"""Signals on drives whose values are known."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Light, Role
from drivora_service.oracles.laws.law_signals import BY_NAME, FAR, FAST, SIGNALS, signal_values
from drivora_service.oracles.laws.law_tokens import WORDS
from drivora_service.testing.networks import EAST, EAST_LEFT
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.oracles.judging import ROAD, on_lane
from tests.oracles.streets import along, on_network, steady, way
from tests.simulation.episodes import network

TOWN = network("tee-town")


def ego_of(ego: SyntheticEgo, *others: SyntheticActor) -> EgoView:
    return RunView(make_trace([ego], others), ROAD).egos[0]


@pytest.mark.parametrize("name", BY_NAME)
def test_every_signal_is_a_number_in_every_row_of_every_run(name: str) -> None:
    for trace in example_runs():
        for ego in RunView(trace, ROAD).egos:
            values = signal_values(ego, name)
            assert values.shape == (ego.count,)
            assert np.isfinite(values).all()
            if BY_NAME[name].is_flag:
                assert set(np.unique(values)) <= {0.0, 1.0}


def test_signals_have_names_of_their_own() -> None:
    assert len(BY_NAME) == len(SIGNALS)
    assert not WORDS & set(BY_NAME)
    for signal in SIGNALS:
        assert signal.scale > 0.0
        assert signal.meaning.endswith(".")


def test_motion() -> None:
    x = np.concatenate((np.zeros(2), np.cumsum(np.arange(100) * 0.05 * 0.05 * 2.0)))
    motion = Motion.along(x, 0.0, yaw=0.0)
    ego = ego_of(on_lane(motion=motion))
    assert signal_values(ego, "speed")[50] == pytest.approx(motion.states[50, 3])
    assert signal_values(ego, "acceleration")[50] == pytest.approx(2.0, abs=0.01)
    assert signal_values(ego, "speed_limit")[50] == 10.0
    off = ego_of(SyntheticEgo(motion=Motion.steady(0.0, -50.0, steps=10, speed=2.0)))
    assert signal_values(off, "speed_limit")[0] == FAST


def test_braking_is_negative_also_when_driving_west() -> None:
    x = 100.0 - np.cumsum(np.linspace(10.0, 5.0, 100) * 0.05)
    ego = ego_of(on_lane(motion=Motion.along(x, 0.0, yaw=np.pi)))
    assert signal_values(ego, "acceleration")[50] == pytest.approx(-1.01, abs=0.02)


def test_lights_of_the_route_do_not_apply_beside_it() -> None:
    motion = Motion.steady(0.0, 0.0, steps=10, speed=5.0)
    near = ego_of(on_lane(motion=motion, light=Light.RED, light_distance=12.0))
    assert signal_values(near, "light_red").all()
    assert not signal_values(near, "light_green").any()
    assert (signal_values(near, "light_distance") == 12.0).all()
    beside = ego_of(on_lane(motion=motion, light=Light.RED, light_distance=12.0, route_lateral=9.0))
    assert not signal_values(beside, "light_red").any()
    assert (signal_values(beside, "light_distance") == FAR).all()


def test_the_vehicle_ahead() -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=10, speed=5.0))
    ahead = SyntheticActor(motion=Motion.steady(20.0, 0.0, steps=10, speed=4.0))
    oncoming = SyntheticActor(motion=Motion.steady(12.0, 0.0, steps=10, speed=4.0, yaw=np.pi))
    assert signal_values(ego_of(ego, ahead), "leader_gap")[0] == pytest.approx(15.5)
    assert signal_values(ego_of(ego, ahead), "leader_speed")[0] == pytest.approx(4.0)
    assert signal_values(ego_of(ego, oncoming), "leader_gap")[0] == FAR
    assert signal_values(ego_of(ego, oncoming), "leader_speed")[0] == FAST
    assert signal_values(ego_of(ego, ahead), "time_to_collision")[0] == FAR
    towards = signal_values(ego_of(ego, oncoming), "time_to_collision")[0]
    assert towards == pytest.approx((12.0 - 4.5) / 9.0)


def test_the_nearest_walker() -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=10))
    walkers = [
        SyntheticActor(
            motion=Motion.steady(0.0, y, steps=10),
            id=f"w{y}",
            role=Role.NPC_WALKER,
            length=0.6,
            width=0.6,
        )
        for y in (10.0, -7.0)
    ]
    radius = 0.5 * (np.hypot(4.5, 1.8) + np.hypot(0.6, 0.6))
    assert signal_values(ego_of(ego, *walkers), "walker_distance")[0] == pytest.approx(7.0 - radius)
    assert signal_values(ego_of(ego), "walker_distance")[0] == FAR


@pytest.mark.parametrize("between", [0, 3])
def test_changes_of_lanes(between: int) -> None:
    lanes = np.full(60, EAST)
    lanes[20 : 20 + between] = -1
    lanes[20 + between :] = EAST_LEFT
    lanes[40:] = EAST
    ego = ego_of(on_lane(motion=Motion.steady(0.0, 0.0, steps=60, speed=5.0), lane=lanes))
    assert np.flatnonzero(signal_values(ego, "lane_change_left")).tolist() == [20 + between]
    assert np.flatnonzero(signal_values(ego, "lane_change_right")).tolist() == [40]
    assert np.flatnonzero(signal_values(ego, "lane_change")).tolist() == [20 + between, 40]
    assert np.flatnonzero(signal_values(ego, "fast_lane")).tolist() == list(range(20 + between, 40))
    assert signal_values(ego, "slow_lane")[:20].all()


def test_a_stay_off_the_road_is_no_change_of_lanes() -> None:
    lanes = np.full(80, EAST)
    lanes[20:50] = -1
    lanes[50:] = EAST_LEFT
    ego = ego_of(on_lane(motion=Motion.steady(0.0, 0.0, steps=80, speed=5.0), lane=lanes))
    assert not signal_values(ego, "lane_change").any()


def test_the_vehicle_behind_counts_after_a_change_of_lanes() -> None:
    rows = np.arange(100)
    lanes = np.where(rows < 20, EAST, EAST_LEFT)
    ego = on_lane(motion=Motion.steady(60.0, 3.5, steps=100, speed=10.0), lane=lanes)
    behind = SyntheticActor(motion=Motion.steady(30.0, 3.5, steps=100, speed=14.0))
    aside = SyntheticActor(motion=Motion.steady(30.0, 0.0, steps=100, speed=30.0), id="aside")
    values = signal_values(ego_of(ego, behind, aside), "follower_time")
    assert values[20] == pytest.approx((30.0 - 4.5 - 20 * 0.05 * 4.0) / 4.0)
    assert (values[:20] == FAR).all()
    assert values[60] < FAR
    assert (values[61:] == FAR).all()


def test_a_turn_at_a_junction() -> None:
    lanes = ("-church_1_0", "high_3_0")
    line = way(TOWN, *lanes)
    length = float(TOWN.lane(lanes[0]).arc[-1])
    fronts = steady(6.0, 400)
    view = RunView(make_trace([on_network(TOWN, along(line, fronts))]), TOWN).egos[0]
    (left,) = np.flatnonzero(np.diff(signal_values(view, "turning_left"), prepend=0.0) > 0.0)
    assert fronts[left - 1] <= length < fronts[left]
    assert (signal_values(view, "turning") == signal_values(view, "turning_left")).all()
    assert not signal_values(view, "turning_right").any()
    assert not signal_values(view, "wrong_lane").any()
    last = np.flatnonzero(signal_values(view, "turning_left"))[-1]
    assert last == np.flatnonzero(signal_values(view, "in_junction"))[-1]
    distance = signal_values(view, "junction_distance")
    before = np.flatnonzero(distance < FAR)
    before = before[before < left]
    assert distance[before] == pytest.approx(length - fronts[before], abs=0.3)
    assert (signal_values(view, "yield_gap") == FAR).all()


def test_values_are_computed_once() -> None:
    ego = ego_of(on_lane(motion=Motion.steady(0.0, 0.0, steps=10)))
    assert signal_values(ego, "junction_distance") is signal_values(ego, "junction_distance")
