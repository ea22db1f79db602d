"""Paired differences of metrics, scenario by scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drivora_service.errors import UnknownName
from drivora_service.metrics.catalogue import MetricCatalogue
from drivora_service.oracles.oracle_descriptions import Better, MeasureDescription
from drivora_service.studies.comparison.sample_statistics import holm
from drivora_service.suites.paired.batch_comparison import (
    SIGNIFICANT,
    MetricComparison,
    PairedJudgement,
)
from drivora_service.suites.paired.bootstrap import mean_intervals
from drivora_service.suites.paired.paired_runs import PairedRun
from drivora_service.suites.paired.pairing import Pair

_EGO = "["
"""In the name of a metric, begins the id of an ego."""

Values = NDArray[np.float64]


FLIPS = 5_000
SEED = 2
"""The same data gives the same p-values."""
_VALUES_AT_ONCE = 4_000_000
"""Signs in memory at once."""
_ROUNDING = 1e-9


@lru_cache(maxsize=1)
def _described() -> Mapping[str, MeasureDescription]:
    """Returns what each metric says about itself, those of installed packages among them."""
    return {metric.name: metric for metric in MetricCatalogue().descriptions()}


def flip_p_values(
    differences: NDArray[np.float64], *, flips: int = FLIPS, seed: int = SEED
) -> tuple[float, ...]:
    """Returns the two-sided p of each column; 1 where all differences are zero or missing.

    Args:
        differences: A row for each scenario, a column for each metric; NaN: not measurable.
        flips: Number of random flips, which all columns share.
        seed: Seeds the flips.
    """
    known = np.nan_to_num(differences, nan=0.0, posinf=0.0, neginf=0.0)
    n = len(known)
    # The flip without any change counts as well: p is never 0.
    reached = np.ones(known.shape[1])
    least = np.abs(known.sum(axis=0)) - _ROUNDING * np.abs(known).sum(axis=0)
    rng = np.random.default_rng(seed)
    at_once = max(1, _VALUES_AT_ONCE // max(n, 1))
    for start in range(0, flips, at_once):
        samples = min(at_once, flips - start)
        signs = rng.integers(0, 2, size=(samples, n), dtype=np.int8) * 2.0 - 1.0
        reached += (np.abs(signs @ known) >= least).sum(axis=0)
    return tuple(float(p) for p in reached / (flips + 1))


def metric_names(runs: Sequence[PairedRun]) -> tuple[str, ...]:
    """Returns the metrics of runs, without those of single egos, in the order of the catalogue."""
    found = dict.fromkeys(name for run in runs for name in run.metrics if _EGO not in name)
    known = [name for name in _described() if name in found]
    return (*known, *(name for name in found if name not in _described()))


def check_metrics(wanted: Sequence[str], known: Sequence[str]) -> None:
    """Checks that metrics exist, in the catalogue or in runs.

    Raises:
        UnknownName: There is no metric of that name.
    """
    names = tuple(dict.fromkeys((*_described(), *known)))
    for name in wanted:
        if name not in names:
            raise UnknownName("metric", name, names)


def compare_metrics(
    scenarios: Mapping[str, Sequence[Pair]], metrics: Sequence[str]
) -> tuple[MetricComparison, ...]:
    """Compares metrics over scenarios; each scenario has the same weight, whatever its pairs.

    Args:
        scenarios: Pairs by the content of their scenario.
        metrics: Names of the metrics.
    """
    if not metrics:
        return ()
    every = [pair for pairs in scenarios.values() for pair in pairs]
    group = {pair.a.id: row for row, pairs in enumerate(scenarios.values()) for pair in pairs}
    rows = np.array([group[pair.a.id] for pair in every], dtype=np.int64)
    a = _values([pair.a for pair in every], metrics)
    b = _values([pair.b for pair in every], metrics)
    known = np.isfinite(a) & np.isfinite(b)
    mean_a, mean_b = (_by_scenario(values, known, rows, len(scenarios)) for values in (a, b))
    differences = mean_b - mean_a
    intervals = mean_intervals(differences)
    p_values = flip_p_values(differences)
    compared = [
        _compare_metric(name, known[:, column], mean_a[:, column], mean_b[:, column], interval, p)
        for column, (name, interval, p) in enumerate(zip(metrics, intervals, p_values, strict=True))
    ]
    # A metric without any difference cannot be significant: it needs no correction.
    differing = [row for row in compared if row.p < 1.0]
    corrected = dict(
        zip((row.metric for row in differing), holm([row.p for row in differing]), strict=True)
    )
    return tuple(_add_judgement(row, corrected.get(row.metric, 1.0)) for row in compared)


def _values(runs: Sequence[PairedRun], metrics: Sequence[str]) -> Values:
    values = np.full((len(runs), len(metrics)), np.nan)
    for row, run in enumerate(runs):
        for column, name in enumerate(metrics):
            value = run.metrics.get(name)
            if value is not None and math.isfinite(value):
                values[row, column] = value
    return values


def _by_scenario(
    values: Values, known: NDArray[np.bool_], rows: NDArray[np.int64], scenarios: int
) -> Values:
    """Returns the means of the known values of each scenario; NaN where it has none."""
    sums = np.zeros((scenarios, values.shape[1]))
    counts = np.zeros_like(sums)
    np.add.at(sums, rows, np.where(known, values, 0.0))
    np.add.at(counts, rows, known)
    return np.where(counts > 0.0, sums / np.maximum(counts, 1.0), np.nan)


def _compare_metric(
    name: str,
    known: NDArray[np.bool_],
    mean_a: Values,
    mean_b: Values,
    interval: tuple[float, float] | None,
    p: float,
) -> MetricComparison:
    described = _described().get(name)
    measured = np.isfinite(mean_a)
    count = int(measured.sum())
    a = float(mean_a[measured].mean()) if count else None
    b = float(mean_b[measured].mean()) if count else None
    return MetricComparison(
        metric=name,
        unit="" if described is None else described.unit,
        better=Better.NEITHER if described is None else described.better,
        scenarios=count,
        pairs=int(known.sum()),
        not_measurable=int((~known).sum()),
        mean_a=a,
        mean_b=b,
        difference=None if a is None or b is None else b - a,
        low=None if interval is None else interval[0],
        high=None if interval is None else interval[1],
        p=p,
        p_holm=p,
        judgement=PairedJudgement.UNDECIDED,
    )


def _add_judgement(row: MetricComparison, p_holm: float) -> MetricComparison:
    judgement = PairedJudgement.UNDECIDED
    if p_holm < SIGNIFICANT and row.difference:
        rises = row.difference > 0.0
        if row.better is Better.NEITHER:
            judgement = PairedJudgement.HIGHER if rises else PairedJudgement.LOWER
        else:
            improves = rises is (row.better is Better.HIGHER)
            judgement = PairedJudgement.BETTER if improves else PairedJudgement.WORSE
    return replace(row, p_holm=p_holm, judgement=judgement)
