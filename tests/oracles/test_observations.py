"""Near miss, tailgating, minimum speed: what is observed, and fails only where it is named."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.trace import Contact, Light
from drivora_service.oracles.discomfort import Discomfort
from drivora_service.oracles.minimum_speed import MinimumSpeed
from drivora_service.oracles.near_miss import NearMiss
from drivora_service.oracles.tailgating import Tailgating
from drivora_service.oracles.verdict import Outcome, Severity
from drivora_service.testing.traces import Motion, SyntheticActor
from tests.oracles.judging import judge, on_lane, outcomes

STEPS = 400
T = 0.05 * np.arange(STEPS)


def ahead(room: float, speed: float) -> SyntheticActor:
    """A vehicle in front, ``room`` metres from bumper to bumper."""
    return SyntheticActor(motion=Motion.steady(room + 4.5, 0.0, steps=STEPS, speed=speed))


def stopping(least: float) -> np.ndarray:
    """Metres: comes on at 10 m/s and brakes at 8 m/s² to stand after some way."""
    brakes = least - 100.0 / 16.0
    begin = brakes / 10.0
    t = np.clip(T - begin, 0.0, 10.0 / 8.0)
    return np.where(begin > T, 10.0 * T, brakes + 10.0 * t - 4.0 * t**2)


@pytest.mark.parametrize(("room", "outcome"), [(0.3, Outcome.VIOLATED), (6.0, Outcome.PASSED)])
def test_a_late_stop_behind_another_is_a_near_miss(room: float, outcome: Outcome) -> None:
    ego = on_lane(motion=Motion.along(stopping(60.0 - room), 0.0))
    standing = SyntheticActor(motion=Motion.steady(64.5, 0.0, steps=STEPS), id="standing")
    verdicts = judge(NearMiss(), ego, others=[standing])
    assert outcomes(verdicts) == [outcome]
    if outcome is Outcome.VIOLATED:
        (verdict,) = verdicts
        assert verdict.severity is Severity.OBSERVATION
        assert verdict.counterpart == "standing"
        assert verdict.evidence["measure"] == "time_to_collision"
        assert verdict.evidence["seconds"] < 0.95


@pytest.mark.parametrize(("lag", "outcome"), [(0.6, Outcome.VIOLATED), (1.6, Outcome.PASSED)])
def test_crossing_close_behind_another_is_a_near_miss(lag: float, outcome: Outcome) -> None:
    # Both are 4.5 m by 1.8 m and meet at x = 100 m: 3.15 m of way each until the place is clear.
    apart = lag * 10.0 + 6.3
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0))
    crossing = Motion.steady(100.0, -100.0 + apart, steps=STEPS, speed=10.0, yaw=0.5 * np.pi)
    verdicts = judge(NearMiss(), ego, others=[SyntheticActor(motion=crossing, id="crosses")])
    assert outcomes(verdicts) == [outcome]
    if outcome is Outcome.VIOLATED:
        assert verdicts[0].evidence["measure"] == "post_encroachment_time"
        assert verdicts[0].evidence["seconds"] == pytest.approx(lag, abs=0.15)
        assert verdicts[0].counterpart == "crosses"


@pytest.mark.parametrize(("apart", "outcome"), [(2.3, Outcome.VIOLATED), (3.3, Outcome.PASSED)])
def test_who_comes_round_a_bend_counts_if_it_came_near(apart: float, outcome: Outcome) -> None:
    # Around (0, 0), the ego at a radius of 12 m, the other outside of it and the other way round.
    turn = 8.0 / 12.0 * T[:70] - 1.0
    away = 12.0 + apart
    ego = on_lane(motion=Motion.along(12.0 * np.cos(turn), 12.0 * np.sin(turn)))
    other = Motion.along(away * np.cos(turn), -away * np.sin(turn))
    verdicts = judge(NearMiss(), ego, others=[SyntheticActor(motion=other, id="oncoming")])
    assert outcomes(verdicts)[:1] == [outcome]
    if outcome is Outcome.PASSED:
        assert verdicts[0].evidence["time_to_collision"] < 0.95


def test_a_contact_is_a_collision_and_no_near_miss() -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0), end_step=111)
    standing = SyntheticActor(motion=Motion.steady(60.0, 0.0, steps=STEPS), id="standing")
    contact = Contact(step=111, ego=0, other=1)
    (verdict,) = judge(NearMiss(), ego, others=[standing], contacts=[contact])
    assert verdict.outcome is Outcome.NOT_APPLICABLE
    assert verdict.message == "Touched standing: see collision; no other actor was there."
    beside = SyntheticActor(motion=Motion.steady(0.0, 7.0, steps=STEPS, speed=10.0))
    (verdict,) = judge(NearMiss(), ego, others=[standing, beside], contacts=[contact])
    assert verdict.outcome is Outcome.PASSED
    assert verdict.message == "Touched standing: see collision; no near miss with another actor."
    crossing = Motion.steady(30.0, -26.0, steps=STEPS, speed=10.0, yaw=0.5 * np.pi)
    others = [standing, SyntheticActor(motion=crossing, id="crosses")]
    (verdict,) = judge(NearMiss(), ego, others=others, contacts=[contact])
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.counterpart == "crosses"


def test_both_egos_of_a_collision_are_said_to_have_touched() -> None:
    egos = [
        on_lane(id="behind", motion=Motion.steady(0.0, 0.0, steps=112, speed=10.0)),
        on_lane(id="ahead", motion=Motion.steady(60.0, 0.0, steps=112)),
    ]
    contact = Contact(step=111, ego=0, other=1)
    verdicts = judge(NearMiss(), *egos, contacts=[contact])
    assert outcomes(verdicts) == [Outcome.NOT_APPLICABLE] * 2
    assert [verdict.message.partition(":")[0] for verdict in verdicts] == [
        "Touched ahead",
        "Touched behind",
    ]


def test_a_touch_after_the_end_of_the_part_excuses_no_near_miss() -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0), end_step=110)
    standing = SyntheticActor(motion=Motion.steady(60.0, 0.0, steps=STEPS))
    contact = Contact(step=111, ego=0, other=1)
    (verdict,) = judge(NearMiss(), ego, others=[standing], contacts=[contact])
    assert verdict.outcome is Outcome.VIOLATED


def test_without_an_actor_on_its_way_there_is_no_near_miss_to_judge() -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0))
    (verdict,) = judge(NearMiss(), ego)
    assert (verdict.outcome, verdict.message) == (
        Outcome.NOT_APPLICABLE,
        "No other actor in the run.",
    )
    (verdict,) = judge(NearMiss(), ego, others=[ahead(20.0, 10.0)])
    assert (verdict.outcome, verdict.message) == (
        Outcome.NOT_APPLICABLE,
        "Never on the way to meet another actor.",
    )


@pytest.mark.parametrize(
    ("room", "outcome"),
    # 10 * 0.75 + 100 / (2 * 6.43) - 100 / (2 * 7.59) = 8.69 m are safe at 10 m/s.
    [(8.6, Outcome.VIOLATED), (8.8, Outcome.PASSED)],
)
def test_the_safe_distance_of_rss_behind_another(room: float, outcome: Outcome) -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0))
    verdicts = judge(Tailgating(), ego, others=[ahead(room, 10.0)])
    assert outcomes(verdicts) == [outcome]
    if outcome is Outcome.VIOLATED:
        (verdict,) = verdicts
        assert verdict.severity is Severity.OBSERVATION
        assert verdict.evidence["safe_distance"] == pytest.approx(8.69, abs=0.01)
        assert verdict.evidence["distance"] == pytest.approx(room)
        assert verdict.counterpart == "npc"


@pytest.mark.parametrize(("rows", "outcome"), [(41, Outcome.VIOLATED), (38, Outcome.PASSED)])
def test_being_too_near_for_a_moment_is_excused(rows: int, outcome: Outcome) -> None:
    near = (np.arange(STEPS) >= 100) & (np.arange(STEPS) < 100 + rows)
    x = 10.0 * T + np.where(near, 10.0, 20.0)
    motion = Motion.along(x, 0.0)
    motion.states[:, 3] = 10.0
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0))
    (verdict,) = judge(Tailgating(), ego, others=[SyntheticActor(motion=motion)])
    assert verdict.outcome is outcome
    if outcome is Outcome.PASSED:
        assert verdict.message == "Too close for 1.9 s at most; 2 s count."


@pytest.mark.parametrize(
    ("room", "outcome"), [(99.0, Outcome.PASSED), (101.0, Outcome.NOT_APPLICABLE)]
)
def test_without_a_vehicle_ahead_there_is_no_distance_to_keep(
    room: float, outcome: Outcome
) -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=10.0))
    assert outcomes(judge(Tailgating(), ego, others=[ahead(room, 10.0)])) == [outcome]
    assert outcomes(judge(Tailgating(), ego)) == [Outcome.NOT_APPLICABLE]


@pytest.mark.parametrize("kind", ["oncoming", "beside"])
def test_only_who_is_followed_counts(kind: str) -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=60, speed=10.0))
    motion = (
        Motion.steady(8.0, 3.5, steps=60, speed=10.0)
        if kind == "beside"
        else Motion.steady(67.0, 0.0, steps=60, speed=-10.0, yaw=0.0)
    )
    if kind == "oncoming":
        motion.states[:, 2] = np.pi
    others = [SyntheticActor(motion=motion)]
    assert outcomes(judge(Tailgating(), ego, others=others)) == [Outcome.NOT_APPLICABLE]


def slow(**fields: object) -> list[Outcome]:
    """Drives at 3 m/s of 10 for 20 s."""
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=3.0), **fields)
    return outcomes(judge(MinimumSpeed(), ego))


def test_crawling_on_a_free_road_is_slow_without_a_reason() -> None:
    (verdict,) = judge(
        MinimumSpeed(), on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=3.0))
    )
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.severity is Severity.OBSERVATION
    assert verdict.evidence["speed"] == pytest.approx(3.0)
    assert verdict.evidence["duration"] == pytest.approx(15.0, abs=0.1)


@pytest.mark.parametrize(("speed", "outcome"), [(4.9, Outcome.VIOLATED), (5.1, Outcome.PASSED)])
def test_half_the_limit_is_fast_enough(speed: float, outcome: Outcome) -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=speed))
    assert outcomes(judge(MinimumSpeed(), ego)) == [outcome]


def test_a_signal_ahead_is_a_reason() -> None:
    assert slow(light=Light.RED, light_distance=50.0) == [Outcome.NOT_APPLICABLE]
    assert slow(light=Light.GREEN, light_distance=50.0) == [Outcome.VIOLATED]


@pytest.mark.parametrize(
    ("room", "outcome"), [(30.0, Outcome.NOT_APPLICABLE), (90.0, Outcome.VIOLATED)]
)
def test_an_actor_ahead_is_a_reason(room: float, outcome: Outcome) -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=3.0))
    assert outcomes(judge(MinimumSpeed(), ego, others=[ahead(room, 3.0)])) == [outcome]


def test_a_junction_ahead_is_a_reason() -> None:
    route = np.array([(0.0, 0.0), (900.0, 0.0)])
    near = on_lane(motion=Motion.steady(465.0, 0.0, steps=220, speed=3.0), route=route)
    far = on_lane(motion=Motion.steady(365.0, 0.0, steps=220, speed=3.0), route=route)
    assert outcomes(judge(MinimumSpeed(), near)) == [Outcome.NOT_APPLICABLE]
    assert outcomes(judge(MinimumSpeed(), far)) == [Outcome.VIOLATED]


def test_discomfort_is_an_observation() -> None:
    x = np.where(T < 5.0, 10.0 * T, 50.0)
    (verdict,) = judge(Discomfort(), on_lane(motion=Motion.along(x, 0.0)))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.severity is Severity.OBSERVATION
