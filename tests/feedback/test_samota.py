"""SAMOTA's feedback: six requirements, each 0 exactly where its oracle finds it violated."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.catalogue import FeedbackCatalogue
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.feedback.samota import SamotaFeedback
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Contact, Light, Role, TerminalEvent, Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.testing.networks import EAST, WEST, straight_road
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

ROAD = straight_road()
STEPS = 200
LENGTH = 4.5
DISTANCES = ("vehicle_distance", "walker_distance", "static_distance")


def ego(**fields: Any) -> SyntheticEgo:
    defaults: dict[str, Any] = {
        "motion": Motion.steady(0.0, 0.0, steps=STEPS, speed=5.0),
        "lane": EAST,
        "lane_lateral": 0.0,
        "lane_heading": 0.0,
        "route": np.array([(0.0, 0.0), (100.0, 0.0)]),
    }
    return SyntheticEgo(**{**defaults, **fields})


def beside(y: float, role: Role = Role.NPC_VEHICLE, **fields: Any) -> SyntheticActor:
    """An actor of the ego's size that stands beside its path, 20 m ahead."""
    return SyntheticActor(motion=Motion.steady(20.0, y, steps=STEPS), role=role, **fields)


def measure(*actors: SyntheticEgo | SyntheticActor, **made: Any) -> dict[str, float | None]:
    egos = [one for one in actors if isinstance(one, SyntheticEgo)]
    others = [one for one in actors if isinstance(one, SyntheticActor)]
    trace = make_trace(egos, others, **made)
    return dict(SamotaFeedback().measure(RunView(trace, ROAD)).objectives)


def score(value: float, half: float) -> object:
    return pytest.approx(value / (value + half))


@pytest.mark.parametrize(
    ("role", "name"),
    [
        (Role.NPC_VEHICLE, "vehicle_distance"),
        (Role.BACKGROUND, "vehicle_distance"),
        (Role.NPC_WALKER, "walker_distance"),
        (Role.NPC_OBSTACLE, "static_distance"),
    ],
)
def test_a_distance_is_that_to_its_own_kind(role: Role, name: str) -> None:
    found = measure(ego(), beside(6.8, role))
    assert found[name] == score(5.0, 10.0)
    assert all(found[other] is None for other in DISTANCES if other != name)


def test_the_nearest_counts_even_if_its_centre_is_farther() -> None:
    long = beside(-9.0, length=40.0, width=14.0)
    assert measure(ego(), beside(6.8), long)["vehicle_distance"] == score(1.1, 10.0)


HIT = 62
"""Step at which the ego's front reaches an actor that stands on its path."""


@pytest.mark.parametrize(
    ("role", "name"), [(Role.NPC_VEHICLE, "vehicle_distance"), (Role.NPC_OBSTACLE, DISTANCES[2])]
)
def test_hitting_by_its_fault_is_the_violation(role: Role, name: str) -> None:
    runs_into = ego(end=TerminalEvent.COLLISION, end_step=HIT)
    made = {"contacts": [Contact(step=HIT, ego=0, other=1)]}
    assert measure(runs_into, beside(0.5, role), **made)[name] == 0.0
    assert collision(runs_into, beside(0.5, role), **made).at_fault is True
    almost = measure(ego(), beside(1.81, role))[name]
    assert almost is not None
    assert 0.0 < almost < 0.01


def rear_ender(**fields: Any) -> SyntheticActor:
    """A vehicle that comes from behind and hits the ego at step 50, at 2.5 s."""
    return SyntheticActor(
        motion=Motion.steady(-4.5 - 2.5 * 5.0, 0.0, steps=STEPS, speed=10.0), **fields
    )


def test_an_actor_that_hits_the_ego_by_its_own_fault_is_left_out() -> None:
    hit = ego(end=TerminalEvent.COLLISION, end_step=50)
    made = {"contacts": [Contact(step=50, ego=0, other=1)]}
    assert collision(hit, rear_ender(), **made).at_fault is False
    assert measure(hit, rear_ender(), **made)["vehicle_distance"] is None
    other = SyntheticActor(id="other", motion=Motion.steady(12.5, 6.8, steps=STEPS))
    alone = measure(hit, other)["vehicle_distance"]
    assert measure(hit, rear_ender(), other, **made)["vehicle_distance"] == alone
    # Without the hit it counts as any other.
    assert measure(ego(end_step=40), rear_ender())["vehicle_distance"] == score(2.5, 10.0)


def test_undetermined_fault_is_almost_a_violation() -> None:
    """Both are beside the road: no rule decides."""
    off: dict[str, Any] = {"lane": -1, "lane_lateral": np.nan, "lane_heading": np.nan}
    motion = Motion.steady(0.0, 30.0, steps=STEPS, speed=5.0)
    hit = ego(motion=motion, end=TerminalEvent.COLLISION, end_step=HIT, **off)
    other = SyntheticActor(motion=Motion.steady(20.0 + 62 * 0.05, 30.5, steps=STEPS, speed=-1.0))
    made = {"contacts": [Contact(step=HIT, ego=0, other=1)]}
    assert collision(hit, other, **made).undetermined
    assert measure(hit, other, **made)["vehicle_distance"] == score(0.01, 10.0)


def test_of_two_egos_the_one_at_fault_covers_the_distance() -> None:
    """The same collision is no violation of the ego that is hit."""
    hit = ego(id="hit", end=TerminalEvent.COLLISION, end_step=50)
    hitting = ego(
        id="hitting",
        motion=Motion.steady(-4.5 - 2.5 * 5.0, 0.0, steps=STEPS, speed=10.0),
        end=TerminalEvent.COLLISION,
        end_step=50,
    )
    contacts = [Contact(step=50, ego=0, other=1)]
    assert measure(hit, hitting, contacts=contacts)["vehicle_distance"] == 0.0
    trace = make_trace([hit, hitting], contacts=contacts)
    one, other = Collision().judge(RunView(trace, ROAD))
    assert (one.at_fault, other.at_fault) == (False, True)


def collision(one: SyntheticEgo, *others: SyntheticActor, contacts: list[Contact]) -> Verdict:
    (found,) = Collision().judge(RunView(make_trace([one], others, contacts=contacts), ROAD))
    return found


def test_farther_is_farther_however_far() -> None:
    found = [measure(ego(), beside(y))["vehicle_distance"] for y in (50.0, 100.0, 200.0)]
    assert found == sorted(set(found), key=lambda value: value or 0.0)


def test_no_actor_is_near_after_the_egos_end_or_on_another_level() -> None:
    passing = ego(end=TerminalEvent.COLLISION, end_step=20)
    assert measure(passing, beside(6.8))["vehicle_distance"] == score(np.hypot(10.5, 5.0), 10.0)
    bridge = Motion.steady(20.0, 0.0, steps=STEPS)
    bridge.states[:, Col.Z] = 6.0
    assert measure(ego(), SyntheticActor(motion=bridge))["vehicle_distance"] is None


def test_an_actor_never_present_together_with_the_ego_does_not_count() -> None:
    gone = beside(6.8, present=np.zeros(STEPS, dtype=bool))
    assert measure(ego(), gone)["vehicle_distance"] is None


def test_other_egos_are_vehicles_and_the_worst_ego_counts() -> None:
    far = ego(id="far", motion=Motion.steady(0.0, 6.8, steps=STEPS, speed=5.0), lane_lateral=1.0)
    found = measure(ego(), far)
    assert found["vehicle_distance"] == score(5.0, 10.0)
    assert found["lane_centre"] == pytest.approx(1.0 - 1.0 / 2.25)


@pytest.mark.parametrize(
    ("lateral", "expected"), [(0.0, 1.0), (-0.9, 0.6), (2.25, 0.0), (3.0, 0.0)]
)
def test_the_lane_is_left_half_a_metre_beyond_its_edge(lateral: float, expected: float) -> None:
    assert measure(ego(lane_lateral=lateral))["lane_centre"] == pytest.approx(expected)


@pytest.mark.parametrize(("y", "is_violated"), [(-2.0, False), (-2.4, True)])
def test_off_every_lane_it_agrees_with_the_oracle(y: float, is_violated: bool) -> None:
    motion = Motion.steady(0.0, y, steps=STEPS, speed=5.0)
    off = ego(motion=motion, lane=-1, lane_lateral=np.nan, lane_heading=np.nan)
    found = measure(off)["lane_centre"]
    assert (found == 0.0) is is_violated
    verdicts = LaneKeeping().judge(RunView(make_trace([off]), ROAD))
    assert (verdicts[0].outcome is Outcome.VIOLATED) is is_violated


def test_a_lane_of_the_other_direction_violates_lane_keeping() -> None:
    assert measure(ego(lane=WEST, lane_heading=np.pi))["lane_centre"] == 0.0


def test_progress_is_the_time_to_spare() -> None:
    # The limit for 100 m is 85 s.
    arrived = ego(end=TerminalEvent.ARRIVED, route_s=np.linspace(0.0, 100.0, STEPS))
    assert measure(arrived)["progress"] == pytest.approx(1.0 - 9.95 / 85.0)
    halfway = ego(end=TerminalEvent.COLLISION, route_s=np.linspace(0.0, 50.0, STEPS))
    assert measure(halfway)["progress"] == pytest.approx(1.0 - 9.95 / (0.5 * 85.0))


@pytest.mark.parametrize("end", [TerminalEvent.STUCK, TerminalEvent.TIME_LIMIT])
def test_not_to_arrive_is_the_violation_of_progress(end: TerminalEvent) -> None:
    assert measure(ego(end=end))["progress"] == 0.0


def test_an_ego_that_never_moved_on_has_no_time_to_spare() -> None:
    assert measure(ego(end=TerminalEvent.COLLISION, route_s=0.0))["progress"] == 0.0


def approach(
    speeds: np.ndarray, line: float, light: np.ndarray | int, step_length: float = 0.05
) -> SyntheticEgo:
    """Drives at the given speeds towards a stop line that many metres from its front."""
    x = np.concatenate(([0.0], np.cumsum(speeds[:-1]) * step_length))
    distance = line - x
    shown = np.where(distance > -LENGTH, np.broadcast_to(light, x.shape), Light.NONE)
    return ego(
        motion=Motion.along(x, 0.0),
        route_s=x,
        light=shown,
        light_distance=np.where(distance > -LENGTH, distance, np.nan),
    )


def test_without_a_signal_no_red_light_can_be_run() -> None:
    assert measure(ego())["red_light"] is None


def test_a_signal_that_stays_green_is_safe() -> None:
    assert measure(approach(np.full(STEPS, 8.0), 30.0, Light.GREEN))["red_light"] == 1.0


def test_running_a_red_light_is_the_violation() -> None:
    runs = approach(np.full(STEPS, 8.0), 30.0, Light.RED)
    verdicts = RedLight().judge(RunView(make_trace([runs]), ROAD))
    assert [verdict.outcome for verdict in verdicts] == [Outcome.VIOLATED]
    assert measure(runs)["red_light"] == 0.0


def test_braking_later_for_a_red_light_is_nearer_to_running_it() -> None:
    found = []
    for braking in (2.0, 4.0, 8.0):
        duration = 10.0 / braking
        room = 50.0 / braking
        time = np.arange(STEPS) * 0.05
        speeds = np.clip(10.0 - braking * np.maximum(time - (40.0 - room) / 10.0, 0.0), 0.0, None)
        assert time[-1] > duration
        value = measure(approach(speeds, 41.0, Light.RED))["red_light"]
        assert value is not None
        assert 0.0 < value < 1.0
        found.append(value)
    assert found == sorted(found, reverse=True)


def test_standing_at_a_red_light_is_safe_however_near() -> None:
    assert measure(approach(np.zeros(STEPS), 0.5, Light.RED))["red_light"] == 1.0


def test_passing_later_on_yellow_is_nearer_to_running_a_red_light() -> None:
    found = []
    for since in (60, 50, 40):
        # The front is on the line at row 76, the tail over it half a second later.
        light = np.where(np.arange(STEPS) >= since, Light.YELLOW, Light.GREEN)
        value = measure(approach(np.full(STEPS, 8.0), 30.0, light))["red_light"]
        assert value is not None
        assert 0.0 < value < 1.0
        found.append(value)
    assert found == sorted(found, reverse=True)
    assert len(set(found)) == 3


@pytest.mark.parametrize("trace", example_runs())
def test_values_are_shares_or_none_and_zero_on_red_only_by_the_oracle(trace: Trace) -> None:
    run = RunView(trace, ROAD)
    measurement = SamotaFeedback().measure(run)
    assert tuple(measurement.objectives) == SamotaFeedback().objectives
    for value in measurement.objectives.values():
        assert value is None or 0.0 <= value <= 1.0
    json.dumps(dict(measurement.objectives), allow_nan=False)
    ran = any(verdict.outcome is Outcome.VIOLATED for verdict in RedLight().judge(run))
    assert (measurement.objectives["red_light"] == 0.0) is ran


def test_an_ego_that_never_started_is_not_measurable() -> None:
    assert set(measure(ego(start_time=100.0)).values()) == {None}


def test_it_is_in_the_catalogue_and_takes_its_scales() -> None:
    catalogue = FeedbackCatalogue()
    made = catalogue.create(FeedbackChoice(name="samota", parameters={"gap": 5.0}))
    assert made == SamotaFeedback(gap=5.0)
    with pytest.raises(SearchError, match="gap"):
        catalogue.create(FeedbackChoice(name="samota", parameters={"gap": 0.0}))
