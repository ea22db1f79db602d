from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.observations.proximity import gaps_between, look_around
from drivora_service.observations.trace import Col, Trace
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

STEPS = 200


def run(ego: Motion, *others: Motion) -> Trace:
    return make_trace(
        [SyntheticEgo(motion=ego)],
        [SyntheticActor(id=f"npc{i}", motion=motion) for i, motion in enumerate(others)],
    )


def test_the_least_gap_names_when_and_who() -> None:
    trace = run(
        Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0),
        Motion.steady(500.0, 0.0, steps=STEPS),
        Motion.steady(50.0, 4.0, steps=STEPS),
    )
    near = look_around(trace, 0, 0, STEPS)
    assert near.min_gap == pytest.approx(4.0 - 1.8)
    assert near.min_gap_actor == 2
    assert abs(trace.states[near.min_gap_row, 0, 0] - 50.0) <= 4.5 + 1e-9


def test_an_ego_alone_has_no_gap() -> None:
    near = look_around(run(Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0)), 0, 0, STEPS)
    assert near.min_gap is None
    assert near.post_encroachment_time is None
    assert np.isinf(near.time_to_collision).all()


@settings(max_examples=25, deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(-40, 40), st.floats(-40, 40), st.floats(0, 15), st.floats(-3.1, 3.1)),
        min_size=1,
        max_size=4,
    )
)
def test_the_least_gap_is_that_of_all_pairs_and_rows(
    others: list[tuple[float, float, float, float]],
) -> None:
    trace = run(
        Motion.steady(0.0, 0.0, steps=60, speed=8.0, yaw=0.3),
        *(Motion.steady(x, y, steps=60, speed=v, yaw=yaw) for x, y, v, yaw in others),
    )
    every = np.stack([gaps_between(trace, 0, row) for row in range(1, len(others) + 1)])
    near = look_around(trace, 0, 0, 60)
    assert near.min_gap == pytest.approx(every.min())


def test_only_the_given_rows_count() -> None:
    trace = run(
        Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0), Motion.steady(60.0, 0.0, steps=STEPS)
    )
    near = look_around(trace, 0, 0, 41)
    assert near.min_gap == pytest.approx(60.0 - 20.0 - 4.5)
    assert len(near.time_to_collision) == 41


def test_absent_actors_are_left_out() -> None:
    ego = SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=STEPS))
    present = np.arange(STEPS) >= 100
    ghost = SyntheticActor(motion=Motion.steady(10.0, 0.0, steps=STEPS, speed=1.0), present=present)
    trace = make_trace([ego], [ghost])
    assert look_around(trace, 0, 0, 100).min_gap is None
    assert look_around(trace, 0, 0, STEPS).min_gap == pytest.approx(15.0 - 4.5)
    assert np.isnan(gaps_between(trace, 0, 1)[:100]).all()


def test_time_to_collision_from_behind_is_not_forward() -> None:
    trace = run(
        Motion.steady(0.0, 0.0, steps=STEPS),
        Motion.steady(-80.0, 0.0, steps=STEPS, speed=10.0),
    )
    near = look_around(trace, 0, 0, 100)
    assert near.time_to_collision[0] == pytest.approx((80.0 - 4.5) / 10.0)
    assert np.isinf(near.forward_time_to_collision).all()


def test_drac_is_squared_closing_speed_over_twice_the_gap() -> None:
    trace = run(
        Motion.steady(0.0, 0.0, steps=2, speed=10.0),
        Motion.steady(24.5, 0.0, steps=2, speed=4.0),
    )
    near = look_around(trace, 0, 0, 1)
    assert near.drac[0] == pytest.approx(36.0 / 40.0)
    assert near.required_deceleration[0] == pytest.approx(36.0 / 40.0)


@pytest.mark.parametrize(
    ("gap", "braking", "expected"),
    [
        # Long before the other stands the speeds are equal: its braking, and the closing speed.
        (10.0, 2.0, 2.0 + 36.0 / 20.0),
        # The other stands after 4² / (2 · 8) = 1 m: stop behind it.
        (20.0, 8.0, 100.0 / (2.0 * 21.0)),
    ],
)
def test_required_deceleration_follows_the_braking_of_the_one_in_front(
    gap: float, braking: float, expected: float
) -> None:
    lead = Motion.steady(gap + 4.5, 0.0, steps=2, speed=4.0 if braking > 2.0 else 8.0)
    ego_speed = 10.0 if braking > 2.0 else 14.0
    lead.states[:, 5] = -braking
    near = look_around(run(Motion.steady(0.0, 0.0, steps=2, speed=ego_speed), lead), 0, 0, 1)
    assert near.required_deceleration[0] == pytest.approx(expected)


def test_an_actor_beside_the_ego_needs_no_braking() -> None:
    trace = run(Motion.steady(0.0, 0.0, steps=2, speed=10.0), Motion.steady(10.0, 3.0, steps=2))
    near = look_around(trace, 0, 0, 2)
    assert not near.drac.any()
    assert not near.rss_violated.any()


@pytest.mark.parametrize(("spare", "violated"), [(-0.01, True), (0.01, False)])
def test_the_safe_distance_is_that_of_rss(spare: float, violated: bool) -> None:
    # v ρ + a ρ² / 2 + (v + ρ a)² / (2 b_own) - v_lead² / (2 b_other), v = 10 m/s, v_lead = 4 m/s
    needed = 10.0 + 1.75 + 13.5**2 / 8.0 - 4.0**2 / 16.0
    trace = run(
        Motion.steady(0.0, 0.0, steps=2, speed=10.0),
        Motion.steady(needed + spare + 4.5, 0.0, steps=2, speed=4.0),
    )
    assert look_around(trace, 0, 0, 1).rss_violated[0] == violated


def test_post_encroachment_time_of_crossing_paths() -> None:
    # The ego's tail leaves the crossing's conflict area; the other's front enters it later.
    speed, delay = 10.0, 3.0
    ego = Motion.steady(-20.0, 0.0, steps=STEPS, speed=speed)
    other = Motion.steady(0.0, -20.0 - speed * delay, steps=STEPS, speed=speed, yaw=math.pi / 2)
    near = look_around(run(ego, other), 0, 0, STEPS)
    # Between the same relative places: the delay less the way of both through the other's width.
    clear = (4.5 + 1.8) / speed
    assert near.post_encroachment_time == pytest.approx(delay - clear, abs=0.11)


def test_an_actor_on_another_level_is_not_there() -> None:
    above = Motion.steady(20.0, 0.0, steps=STEPS)
    above.states[:, Col.Z] = 5.0
    near = look_around(run(Motion.steady(0.0, 0.0, steps=STEPS, speed=5.0), above), 0, 0, STEPS)
    assert near.min_gap is None
    assert not near.rss_violated.any()


def test_following_is_no_encroachment() -> None:
    trace = run(
        Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0),
        Motion.steady(15.0, 0.0, steps=STEPS, speed=10.0),
    )
    assert look_around(trace, 0, 0, STEPS).post_encroachment_time is None


def test_post_encroachment_time_is_the_same_for_both() -> None:
    ego = Motion.steady(-20.0, 0.0, steps=STEPS, speed=10.0)
    other = Motion.steady(0.0, -32.0, steps=STEPS, speed=8.0, yaw=math.pi / 2)
    trace = make_trace([SyntheticEgo(motion=ego), SyntheticEgo(id="two", motion=other)])
    first = look_around(trace, 0, 0, STEPS).post_encroachment_time
    second = look_around(trace, 1, 0, STEPS).post_encroachment_time
    assert first == pytest.approx(second, abs=0.11)
