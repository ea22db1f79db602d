"""The feedback of DoppelTest: distances, decisions and conflicts of several egos."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.errors import SearchError
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.doppeltest import DOPPELTEST, least_ego_distance
from drivora_service.feedback.ego_decisions import Decision
from drivora_service.feedback.measurement import FeedbackChoice, Measurement
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Light, Role, TerminalEvent
from drivora_service.testing.networks import EAST, EAST_LEFT, straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

STEP = 0.05
TIMES = STEP * np.arange(600)
SQUARE = np.array([(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)])
CROSSING = replace(straight_road(), junction_shapes={"crossing": SQUARE})


def drive(speeds: list[tuple[float, float]]) -> FloatArray:
    """Returns the distance driven at each step, of a speed profile through (s, m/s)."""
    times, values = zip(*speeds, strict=True)
    speed = np.interp(TIMES, times, values)
    return np.concatenate(([0.0], np.cumsum(0.5 * STEP * (speed[1:] + speed[:-1]))))


def eastwards(name: str, x: float, way: FloatArray, y: float = 0.0, **more: Any) -> SyntheticEgo:
    """Drives along y = 0 m; the route reaches from x to 120 m."""
    motion = Motion.along(x + way, np.full(len(way), y), yaw=0.0)
    route = np.column_stack((np.arange(x, 120.5), np.full(len(np.arange(x, 120.5)), y)))
    return SyntheticEgo(motion=motion, id=name, route=route, route_s=way, **more)


def northwards(name: str, y: float, way: FloatArray, x: float = 0.0, **more: Any) -> SyntheticEgo:
    """Drives along x = 0 m; the route reaches from y to 120 m."""
    motion = Motion.along(np.full(len(way), x), y + way, yaw=0.5 * np.pi)
    route = np.column_stack((np.full(len(np.arange(y, 120.5)), x), np.arange(y, 120.5)))
    return SyntheticEgo(motion=motion, id=name, route=route, route_s=way, **more)


def measured(*egos: SyntheticEgo, others: tuple[SyntheticActor, ...] = ()) -> Measurement:
    trace = make_trace(egos, others, step_length=STEP)
    return DOPPELTEST.create({}).measure(RunView(trace, CROSSING))


def decisions(measurement: Measurement) -> set[tuple[int, Decision]]:
    return {(int(row), Decision(int(code))) for row, code in measurement.features["decisions"]}


STEADY = drive([(0, 10), (30, 10)])
HALTING = drive([(0, 10), (4, 10), (6, 0), (30, 0)])
"""50 m, then it stands from 6 s on."""

STOPPING = drive([(0, 10), (4, 10), (6, 0), (12, 0), (14, 10), (30, 10)])
"""50 m from the start until it stands, from 6 s to 12 s."""


def test_the_distance_is_the_least_gap_of_any_two_egos() -> None:
    found = measured(
        eastwards("a", -100.0, STEADY),
        eastwards("b", -120.0, STEADY),
        eastwards("c", -98.0, STEADY, y=7.0),
    )
    assert found.objectives["ego_distance"] == pytest.approx(7.0 - 1.8)


@given(st.integers(0, 2**32 - 1), st.integers(2, 5))
@settings(max_examples=30)
def test_the_distance_is_that_of_looking_at_every_pair_at_every_step(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    egos = [
        SyntheticEgo(
            motion=Motion.steady(
                *random.uniform(-60.0, 60.0, 2),
                steps=60,
                speed=random.uniform(0.0, 15.0),
                yaw=random.uniform(-np.pi, np.pi),
            ),
            id=f"ego_{i}",
        )
        for i in range(count)
    ]
    trace = make_trace(egos, step_length=STEP)
    every = [gaps_between(trace, i, j).min() for i in range(count) for j in range(i)]
    assert least_ego_distance(RunView(trace, CROSSING)) == min(every)


def test_an_actor_on_a_bridge_is_not_near() -> None:
    above = northwards("b", -50.0, STEADY)
    above.motion.states[:, Col.Z] = 5.0
    found = measured(eastwards("a", -50.0, STEADY), above)
    assert found.objectives["ego_distance"] is None


def test_a_touch_is_no_distance() -> None:
    found = measured(eastwards("a", -50.0, STEADY), northwards("b", -50.0, STEADY))
    assert found.objectives["ego_distance"] == 0.0


def test_one_ego_alone_has_no_distance() -> None:
    assert measured(eastwards("a", -100.0, STEADY)).objectives["ego_distance"] is None


def test_an_ego_that_waits_for_its_start_is_in_the_way() -> None:
    waiting = eastwards("b", 0.0, np.zeros(len(TIMES)), start_time=25.0)
    found = measured(eastwards("a", -50.0, STOPPING), waiting)
    assert found.objectives["ego_distance"] == 0.0


def test_egos_that_both_have_ended_come_no_nearer() -> None:
    ended: dict[str, Any] = {"end": TerminalEvent.STUCK, "end_step": 100}
    found = measured(
        eastwards("a", -100.0, STEADY, **ended), northwards("b", -100.0, STEADY, **ended)
    )
    # After 5 s each is 50 m from the crossing of their paths.
    assert found.objectives["ego_distance"] == pytest.approx(np.hypot(1, 1) * 46.85, abs=0.01)


def test_going_straight_on_alone_decides_nothing() -> None:
    found = measured(eastwards("a", -100.0, STEADY), eastwards("b", -150.0, STEADY))
    assert decisions(found) == set()
    assert found.objectives["decisions"] == 0.0


def test_a_stop_without_a_reason() -> None:
    assert decisions(measured(eastwards("a", -100.0, STOPPING))) == {(0, Decision.STOP_ELSEWHERE)}


def test_standing_at_the_start_is_no_stop() -> None:
    waiting = drive([(0, 0), (5, 0), (7, 10), (30, 10)])
    assert decisions(measured(eastwards("a", -100.0, waiting))) == set()


def test_a_short_stand_is_no_stop() -> None:
    brief = drive([(0, 10), (4, 10), (6, 0), (6.5, 0), (8, 10), (30, 10)])
    assert decisions(measured(eastwards("a", -100.0, brief))) == set()


@pytest.mark.parametrize(("light", "stops"), [(Light.RED, True), (Light.GREEN, False)])
def test_a_stop_at_a_signal(light: Light, stops: bool) -> None:
    # The stop line is 54 m from the start; the bumper stands 1.75 m before it.
    ego = eastwards("a", -100.0, STOPPING, light=light, light_distance=54.0 - STOPPING - 2.25)
    expected = Decision.STOP_AT_SIGNAL if stops else Decision.STOP_ELSEWHERE
    assert decisions(measured(ego)) == {(0, expected)}


@pytest.mark.parametrize("role", [Role.NPC_VEHICLE, Role.NPC_OBSTACLE])
def test_a_stop_behind_a_vehicle_in_a_queue_at_a_signal(role: Role) -> None:
    ego = eastwards("a", -100.0, HALTING, light=Light.RED, light_distance=57.0 - HALTING)
    lead = SyntheticActor(motion=Motion.steady(-42.0, 0.0, steps=len(TIMES)), role=role)
    assert decisions(measured(ego, others=(lead,))) == {(0, Decision.STOP_BEHIND_VEHICLE)}


@pytest.mark.parametrize(
    ("y", "expected"),
    [(0.0, Decision.STOP_FOR_WALKER), (-4.0, Decision.STOP_FOR_WALKER), (9.0, None)],
)
def test_a_stop_for_a_walker_on_or_beside_the_way(y: float, expected: Decision | None) -> None:
    walker = SyntheticActor(
        motion=Motion.steady(-45.0, y, steps=len(TIMES)),
        role=Role.NPC_WALKER,
        length=0.5,
        width=0.5,
    )
    found = decisions(measured(eastwards("a", -100.0, STOPPING), others=(walker,)))
    assert found == {(0, expected or Decision.STOP_ELSEWHERE)}


def test_actors_behind_or_beside_are_no_reason_to_stop() -> None:
    follower = SyntheticActor(motion=Motion.along(-110.0 + HALTING, 0.0, yaw=0.0))
    beside = SyntheticActor(motion=Motion.steady(-43.0, 3.5, steps=len(TIMES)), id="beside")
    found = decisions(measured(eastwards("a", -100.0, HALTING), others=(follower, beside)))
    assert found == {(0, Decision.STOP_ELSEWHERE)}


def test_changing_lanes_to_both_sides() -> None:
    lanes = np.full(len(TIMES), EAST)
    lanes[200:300] = EAST_LEFT
    found = decisions(measured(eastwards("a", -100.0, STEADY, lane=lanes)))
    assert found == {(0, Decision.CHANGE_LEFT), (0, Decision.CHANGE_RIGHT)}


def test_leaving_the_lanes_is_no_change() -> None:
    lanes = np.full(len(TIMES), EAST)
    lanes[200:300] = -1
    assert decisions(measured(eastwards("a", -100.0, STEADY, lane=lanes))) == set()


def passing(*, side: float, speed: float = 4.0, yaw: float = 0.0) -> set[tuple[int, Decision]]:
    """Lets an ego pass ``side`` metres from an actor that is 40 m ahead."""
    ego = eastwards("a", -100.0, STEADY)
    x = np.interp(TIMES, [0, 2, 4, 30], [0, 0, side, side])
    states = ego.motion.states.copy()
    states[:, 1] = x
    slow = SyntheticActor(
        motion=Motion.steady(-80.0, 0.0, steps=len(TIMES), speed=speed, yaw=yaw), length=4.5
    )
    return decisions(measured(replace(ego, motion=Motion(states=states)), others=(slow,)))


def test_overtaking_a_vehicle_that_was_ahead_in_its_lane() -> None:
    assert passing(side=3.5) == {(0, Decision.OVERTAKE)}


def test_passing_a_vehicle_far_aside_or_oncoming_is_no_overtaking() -> None:
    assert passing(side=20.0) == set()
    assert passing(side=3.5, yaw=np.pi, speed=1.0) == set()


def test_staying_behind_is_no_overtaking() -> None:
    assert passing(side=0.0, speed=10.0) == set()


def test_the_second_at_a_crossing_yields_and_the_first_goes_first() -> None:
    # The one from the south stops 10 m before the crossing while the other passes.
    found = measured(eastwards("a", -70.0, STEADY), northwards("b", -60.0, STOPPING))
    assert decisions(found) >= {(0, Decision.GO_FIRST), (1, Decision.YIELD)}
    assert (0, Decision.YIELD) not in decisions(found)
    assert (1, Decision.GO_FIRST) not in decisions(found)


def test_slowing_down_is_yielding_too() -> None:
    slowing = drive([(0, 10), (3, 10), (5, 5), (30, 5)])
    found = measured(eastwards("a", -60.0, STEADY), northwards("b", -60.0, slowing))
    assert decisions(found) == {(0, Decision.GO_FIRST), (1, Decision.YIELD)}


def test_an_ego_that_arrives_later_at_constant_speed_does_not_yield() -> None:
    found = measured(eastwards("a", -60.0, STEADY), northwards("b", -80.0, STEADY))
    assert decisions(found) == {(0, Decision.GO_FIRST)}


def test_a_distant_ego_does_not_yield() -> None:
    found = measured(eastwards("a", -60.0, STEADY), northwards("b", -120.0, STEADY))
    assert decisions(found) == set()
    assert found.objectives["conflicts"] == -1.0


def test_an_ego_held_by_a_signal_does_not_yield() -> None:
    held: dict[str, Any] = {"light": Light.RED, "light_distance": 55.0 - STOPPING - 2.25}
    found = measured(eastwards("a", -70.0, STEADY), northwards("b", -60.0, STOPPING, **held))
    assert decisions(found) == {(1, Decision.STOP_AT_SIGNAL)}


def test_an_ego_that_has_not_started_does_not_yield() -> None:
    waiting = drive([(0, 0), (20, 0), (22, 10), (30, 10)])
    found = measured(
        eastwards("a", -70.0, STEADY), northwards("b", -20.0, waiting, start_time=20.0)
    )
    assert decisions(found) == set()


def test_different_decisions_are_counted_once_each() -> None:
    found = measured(eastwards("a", -100.0, STOPPING), eastwards("b", -300.0, STOPPING))
    assert len(decisions(found)) == 2
    assert found.objectives["decisions"] == -1.0


def test_conflicts_count_pairs_of_routes_not_of_egos() -> None:
    found = measured(
        eastwards("a", -60.0, STEADY),
        eastwards("b", -80.0, STEADY),
        northwards("c", -120.0, STEADY),
        northwards("d", -90.0, STEADY, x=4.0),
    )
    assert found.features["conflicts"] == ((0.0, 2.0), (0.0, 3.0), (1.0, 2.0), (1.0, 3.0))
    assert found.objectives["conflicts"] == -2.0


def test_the_measurement_is_a_plain_table_of_finite_numbers() -> None:
    found = measured(eastwards("a", -70.0, STEADY), northwards("b", -60.0, STOPPING))
    assert tuple(found.objectives) == DOPPELTEST.create({}).objectives
    for table in found.features.values():
        assert np.isfinite(np.array(table)).all()
        assert all(type(value) is float for row in table for value in row)


def test_its_thresholds_are_its_parameters() -> None:
    choice = FeedbackChoice(name="doppeltest", parameters={"stop_time": 10.0})
    patient = FeedbackCatalogue().create(choice)
    trace = make_trace([eastwards("a", -100.0, STOPPING)], step_length=STEP)
    assert patient.measure(RunView(trace, CROSSING)).features["decisions"] == ()
    with pytest.raises(SearchError, match=r"feedback 'doppeltest' has no parameter 'patience'"):
        DOPPELTEST.create({"patience": 1.0})
