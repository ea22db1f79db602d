"""Bench2Drive's success and comfort, with values computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.metrics.comfort import comfort
from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.success import success
from drivora_service.observations.trace import Col
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.testing.traces import Motion
from tests.metrics.streets import ego_on_road, straight, view_of

INFRACTIONS = ("collision", "red_light", "stop_sign", "lane_keeping", "route_deviation", "blocked")


def judged(outcomes: dict[str, Outcome] | None = None, *, arrived: bool = True) -> Judgement:
    told = dict.fromkeys(INFRACTIONS, Outcome.PASSED)
    told["destination"] = Outcome.PASSED if arrived else Outcome.VIOLATED
    told.update(outcomes or {})
    evidence = {"ego_speed": 3.0}
    return Judgement(
        verdicts=tuple(
            Verdict(oracle=oracle, ego="ego", outcome=outcome, message="", evidence=evidence)
            for oracle, outcome in told.items()
        )
    )


def test_success_is_arrival_without_infraction() -> None:
    assert success(judged()) == 1.0
    assert success(judged(arrived=False)) == 0.0
    for oracle in INFRACTIONS:
        assert success(judged({oracle: Outcome.VIOLATED})) == 0.0
        assert success(judged({oracle: Outcome.NOT_MEASURABLE})) is None
        assert success(judged({oracle: Outcome.NOT_MEASURABLE}, arrived=False)) == 0.0
    assert success(judged({"destination": Outcome.NOT_MEASURABLE})) is None


@pytest.mark.parametrize(
    "oracle", ["off_road", "wrong_way", "speeding", "near_miss", "minimum_speed", "discomfort"]
)
def test_what_the_benchmark_does_not_count_is_no_infraction(oracle: str) -> None:
    assert success(judged({oracle: Outcome.VIOLATED})) == 1.0


def with_signals(steps: int, **columns: float | FloatArray) -> Motion:
    """An eastward motion with these values in columns of its states."""
    motion = straight(8.0, steps)
    for name, values in columns.items():
        motion.states[:, Col[name.upper()]] = values
    return motion


def comfort_of(motion: Motion) -> float | None:
    return comfort(view_of(ego_on_road(motion, 500.0)))


@pytest.mark.parametrize(
    ("column", "within", "beyond"),
    [
        ("ax", 2.39, 2.41),
        ("ax", -4.04, -4.06),
        ("ay", 4.88, 4.90),
        ("ay", -4.88, -4.90),
        ("yaw_rate", 0.94, 0.96),
        ("yaw_rate", -0.94, -0.96),
    ],
)
def test_bounds_of_constant_signals(column: str, within: float, beyond: float) -> None:
    assert comfort_of(with_signals(100, **{column: within})) == 1.0
    assert comfort_of(with_signals(100, **{column: beyond})) == 0.0


@pytest.mark.parametrize(
    ("column", "middle", "bound"),
    [
        ("ax", -0.1, 4.13),  # longitudinal jerk
        ("ay", 2.3, 8.37),  # jerk: of the magnitude of the acceleration
        ("yaw_rate", 0.0, 1.93),  # yaw acceleration, which the public code does not derive
    ],
)
def test_bounds_of_changes(column: str, middle: float, bound: float) -> None:
    """A step by A in the middle of the 15 rows of the filter.

    The least-squares parabola through it is a line, by symmetry, with the slope
    2 (1 + … + 7) A/2 / (2 (1² + … + 7²) 0.05 s) = 2 A / s, in every row.
    """
    for share, value in ((0.999, 1.0), (1.001, 0.0)):
        step = share * bound / 2.0
        signal = middle + 0.5 * step * np.sign(np.arange(15) - 7)
        assert comfort_of(with_signals(15, **{column: signal})) == value


def test_segments_of_twenty_rows_are_judged_one_by_one() -> None:
    # Rough in row 30 alone and around it: the second of five segments, and no other.
    rough = np.zeros(110)
    rough[30] = 60.0
    assert comfort_of(with_signals(110, ay=rough)) == pytest.approx(4.0 / 5.0)
    # The last ten rows are no whole segment.
    rough = np.zeros(110)
    rough[109] = 60.0
    assert comfort_of(with_signals(110, ay=rough)) == 1.0


def test_a_short_drive_is_one_segment_and_a_shorter_one_is_not_measurable() -> None:
    assert comfort_of(straight(8.0, 15)) == 1.0
    assert comfort_of(with_signals(19, ax=3.0)) == 0.0
    assert comfort_of(straight(8.0, 14)) is None
