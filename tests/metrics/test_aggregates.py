"""Scores over several runs, with values computed by hand."""

from __future__ import annotations

import math

import pytest

from drivora_service.metrics.aggregates import Metrics, aggregate_metric, benchmark_scores

RUNS: tuple[Metrics, ...] = (
    {
        "driving_score": 100.0,
        "driving_score_1_0": 100.0,
        "driving_score_2_0": 90.0,
        "route_completion": 100.0,
        "infraction_penalty": 1.0,
        "success": 1.0,
        "efficiency": 80.0,
        "comfort": 1.0,
        "nuplan_closed_loop": 0.9,
    },
    {
        "driving_score": 40.0,
        "driving_score_1_0": 60.0,
        "driving_score_2_0": 30.0,
        "route_completion": 80.0,
        "infraction_penalty": 0.5,
        "success": 0.0,
        "efficiency": None,
        "comfort": 0.5,
        "nuplan_closed_loop": 0.0,
    },
)


def test_planned_runs_without_a_result_count_as_zero() -> None:
    scores = benchmark_scores(RUNS, missing=1)
    assert scores.planned == 3
    # 100, 40 and 0: mean 46.67; squares of the deviations 2844.4, 44.4 and 2177.8, over 2.
    assert scores.driving_score.mean == pytest.approx(140.0 / 3.0)
    assert scores.driving_score.deviation == pytest.approx(math.sqrt(15200.0 / 3.0 / 2.0))
    assert scores.driving_score.runs == 3
    assert scores.driving_score_1_0.mean == pytest.approx(160.0 / 3.0)
    assert scores.driving_score_2_0.mean == pytest.approx(40.0)
    assert scores.route_completion.mean == pytest.approx(60.0)
    assert scores.infraction_penalty.mean == pytest.approx(0.5)
    assert scores.success_rate.mean == pytest.approx(1.0 / 3.0)
    assert scores.nuplan_closed_loop.mean == pytest.approx(0.3)


def test_efficiency_and_comfort_are_those_of_runs_that_have_them() -> None:
    scores = benchmark_scores(RUNS, missing=1)
    assert (scores.efficiency.mean, scores.efficiency.runs) == (80.0, 1)
    assert scores.efficiency.deviation is None
    assert (scores.comfort.mean, scores.comfort.runs) == (0.75, 2)
    assert scores.comfort.deviation == pytest.approx(math.sqrt(0.125))


def test_without_runs_there_is_no_score_and_with_missing_ones_there_is_zero() -> None:
    nothing = benchmark_scores(())
    assert (nothing.planned, nothing.driving_score.mean) == (0, None)
    failed = benchmark_scores((), missing=2)
    assert (failed.driving_score.mean, failed.driving_score.deviation) == (0.0, 0.0)
    assert failed.comfort.mean is None


def test_values_that_were_not_measurable_are_left_out() -> None:
    runs: list[Metrics] = [{"a": 1.0}, {"a": None}, {}, {"a": float("nan")}, {"a": 3.0}]
    found = aggregate_metric(runs, "a")
    assert (found.mean, found.runs) == (2.0, 2)
