"""Scores of benchmarks over several runs, as the benchmarks aggregate them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev

Metrics = Mapping[str, float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Aggregate:
    """A metric over several runs.

    Attributes:
        mean: ``None`` without a value.
        deviation: Sample standard deviation; ``None`` for fewer than two values.
        runs: Number of values.
    """

    mean: float | None
    deviation: float | None
    runs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchmarkScores:
    """The scores of an agent over planned runs.

    In those of CARLA Leaderboard, in the success rate and in nuPlan's score a planned run without a
    result counts 0. In Bench2Drive's efficiency and comfort it does not count. A run with a result
    in which a metric was not measurable counts in none of them.

    Attributes:
        planned: Number of planned runs.
        driving_score: Leaderboard 2.1, per cent.
        driving_score_1_0: Leaderboard 1.0, per cent.
        driving_score_2_0: Leaderboard 2.0, per cent.
        route_completion: Leaderboard, per cent.
        infraction_penalty: Leaderboard 2.1, 0..1.
        success_rate: Bench2Drive, 0..1.
        efficiency: Bench2Drive, per cent.
        comfort: Bench2Drive, 0..1.
        nuplan_closed_loop: nuPlan, 0..1.
    """

    planned: int
    driving_score: Aggregate
    driving_score_1_0: Aggregate
    driving_score_2_0: Aggregate
    route_completion: Aggregate
    infraction_penalty: Aggregate
    success_rate: Aggregate
    efficiency: Aggregate
    comfort: Aggregate
    nuplan_closed_loop: Aggregate


def benchmark_scores(runs: Sequence[Metrics], *, missing: int = 0) -> BenchmarkScores:
    """Aggregates runs.

    Args:
        runs: The metrics of each judged run.
        missing: Number of planned runs without a result by the agent's fault. Runs that failed
            because of the machine are not planned runs of the agent: leave them out.
    """
    return BenchmarkScores(
        planned=len(runs) + missing,
        driving_score=aggregate_metric(runs, "driving_score", missing=missing),
        driving_score_1_0=aggregate_metric(runs, "driving_score_1_0", missing=missing),
        driving_score_2_0=aggregate_metric(runs, "driving_score_2_0", missing=missing),
        route_completion=aggregate_metric(runs, "route_completion", missing=missing),
        infraction_penalty=aggregate_metric(runs, "infraction_penalty", missing=missing),
        success_rate=aggregate_metric(runs, "success", missing=missing),
        efficiency=aggregate_metric(runs, "efficiency"),
        comfort=aggregate_metric(runs, "comfort"),
        nuplan_closed_loop=aggregate_metric(runs, "nuplan_closed_loop", missing=missing),
    )


def aggregate_metric(runs: Sequence[Metrics], metric: str, *, missing: int = 0) -> Aggregate:
    """Aggregates one metric over the runs in which it was measurable, and ``missing`` zeros."""
    values = [value for run in runs if (value := run.get(metric)) is not None]
    values = [*filter(math.isfinite, values), *[0.0] * missing]
    return Aggregate(
        mean=fmean(values) if values else None,
        deviation=stdev(values) if len(values) > 1 else None,
        runs=len(values),
    )
