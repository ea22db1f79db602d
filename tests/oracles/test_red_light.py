from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.trace import Light
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.testing.traces import Motion
from tests.oracles.judging import judge, on_lane

STEPS, SPEED, LENGTH = 200, 10.0, 4.5
FRONT = SPEED * 0.05 * np.arange(STEPS) + 0.5 * LENGTH
"""Metres that the front bumper has come."""


def drive(
    signals: list[tuple[float, np.ndarray]], front: np.ndarray = FRONT
) -> tuple[Verdict, ...]:
    """Drives past stop lines at the given places, with the signals' states by step."""
    distance = np.full(STEPS, np.nan)
    light = np.zeros(STEPS, dtype=np.uint8)
    for k in range(STEPS):
        ahead = [(s, states) for s, states in signals if front[k] - LENGTH <= s]
        if ahead:
            distance[k] = ahead[0][0] - front[k]
            light[k] = ahead[0][1][k]
    motion = Motion.along(front - 0.5 * LENGTH, 0.0)
    ego = on_lane(motion=motion, light=light, light_distance=distance, route_s=front - 0.5 * LENGTH)
    return judge(RedLight(), ego)


def always(light: Light) -> np.ndarray:
    return np.full(STEPS, light, dtype=np.uint8)


def test_driving_over_the_line_on_red() -> None:
    (verdict,) = drive([(40.0, always(Light.RED))])
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.at_fault
    assert verdict.step is not None
    tail = FRONT[verdict.step] - LENGTH
    assert 40.0 <= tail <= 40.0 + SPEED * 0.05
    assert verdict.evidence["speed"] == pytest.approx(SPEED)
    assert verdict.evidence["front_crossed_on"] == "red"


@pytest.mark.parametrize("light", [Light.GREEN, Light.YELLOW])
def test_driving_over_the_line_on_another_light(light: Light) -> None:
    (verdict,) = drive([(40.0, always(light))])
    assert verdict.outcome is Outcome.PASSED
    assert verdict.evidence["lines"] == 1


def test_stopping_before_the_line() -> None:
    front = np.minimum(FRONT, 39.0)
    (verdict,) = drive([(40.0, always(Light.RED))], front)
    assert verdict.outcome is Outcome.PASSED


def test_stopping_with_the_front_over_the_line() -> None:
    front = np.minimum(FRONT, 43.0)
    (verdict,) = drive([(40.0, always(Light.RED))], front)
    assert verdict.outcome is Outcome.PASSED


@pytest.mark.parametrize(("front_past", "violated"), [(4.0, True), (5.0, False)])
def test_the_tail_decides_when_the_light_changes_under_the_ego(
    front_past: float, violated: bool
) -> None:
    states = always(Light.YELLOW)
    states[40.0 + front_past < FRONT] = Light.RED
    (verdict,) = drive([(40.0, states)])
    assert (verdict.outcome is Outcome.VIOLATED) == violated
    if violated:
        assert verdict.evidence["front_crossed_on"] == "yellow"


def test_each_signal_that_was_run_is_a_violation() -> None:
    signals = [(40.0, always(Light.RED)), (60.0, always(Light.GREEN)), (80.0, always(Light.RED))]
    verdicts = drive(signals)
    assert [verdict.outcome for verdict in verdicts] == [Outcome.VIOLATED] * 2


def test_signals_so_near_that_both_are_under_the_ego() -> None:
    verdicts = drive([(40.0, always(Light.RED)), (42.0, always(Light.RED))])
    assert [verdict.outcome for verdict in verdicts] == [Outcome.VIOLATED] * 2


def test_a_signal_that_the_ego_started_beyond_is_not_its_signal() -> None:
    (verdict,) = drive([(1.0, always(Light.RED))])
    assert verdict.outcome is Outcome.NOT_APPLICABLE
    assert verdict.evidence["lines"] == 0


def test_backing_off_the_line_is_no_crossing() -> None:
    forwards = 38.0 + 4.0 * np.sin(np.linspace(0.0, np.pi, STEPS))
    (verdict,) = drive([(40.0, always(Light.RED))], forwards)
    assert verdict.outcome is Outcome.PASSED


def test_a_route_without_signals() -> None:
    (verdict,) = drive([])
    assert verdict.outcome is Outcome.NOT_APPLICABLE
    assert verdict.message == "No stop line with a signal on the way."


@pytest.mark.parametrize(
    ("end", "outcome"),
    [(20.0, Outcome.NOT_APPLICABLE), (39.0, Outcome.PASSED), (43.0, Outcome.PASSED)],
    ids=["far from the line", "at the line", "on the line"],
)
def test_waiting_at_a_signal_is_something_to_judge(end: float, outcome: Outcome) -> None:
    (verdict,) = drive([(40.0, always(Light.RED))], np.minimum(FRONT, end))
    assert verdict.outcome is outcome
    assert verdict.evidence["lines"] == 0


def test_a_signal_that_is_lost_before_the_tail_has_passed_is_no_crossing() -> None:
    distance = np.where(FRONT < 42.0, 40.0 - FRONT, np.nan)
    ego = on_lane(
        motion=Motion.along(FRONT - 0.5 * LENGTH, 0.0),
        light=Light.RED,
        light_distance=distance,
        route_s=FRONT - 0.5 * LENGTH,
    )
    (verdict,) = judge(RedLight(), ego)
    assert verdict.outcome is Outcome.NOT_APPLICABLE
