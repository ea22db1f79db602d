"""Comparisons of campaigns as commands print them."""

from __future__ import annotations

from dataclasses import asdict
from itertools import groupby
from typing import Any

from drivora_service.cli.output import print_table
from drivora_service.studies.comparing import Comparison
from drivora_service.studies.comparison import Row
from drivora_service.studies.comparison_text import (
    a12,
    how_to_read,
    probability,
    setting,
    value,
)


def comparison_result(comparison: Comparison) -> dict[str, Any]:
    """Gives the printed form of a comparison; the keys are a contract with scripts."""
    return {
        "baseline": comparison.baseline,
        "budgets": comparison.budgets,
        "time_limits_s": comparison.time_limits,
        "notes": list(comparison.notes),
        "rows": [_row_result(row) for row in comparison.rows],
        "campaigns": [{**asdict(f), "own_share": f.own_share} for f in comparison.figures],
    }


def print_comparison(comparison: Comparison) -> None:
    """Prints a table a measure."""
    for line in setting(comparison):
        print(line)
    for remark in comparison.notes:
        print(f"note: {remark}")
    several = len(comparison.budgets) > 1
    columns = ("method", "median", comparison.baseline, "A12 [95 %]", "p", "Holm", "judgement")
    for measure, rows in groupby(comparison.rows, key=lambda row: row.measure):
        print_table(
            f"{measure.title} ({'more' if measure.larger_is_better else 'less'} is better)",
            (*(("scenario",) if several else ()), *columns),
            (((row.scenario,) if several else ()) + _cells(row) for row in rows),
        )
    print(how_to_read(comparison))


def _cells(row: Row) -> tuple[str, ...]:
    return (
        row.group,
        value(row.median),
        value(row.baseline_median),
        a12(row),
        probability(row.effect.p),
        probability(row.p_holm),
        row.judgement,
    )


def _row_result(row: Row) -> dict[str, Any]:
    return {
        "measure": row.measure.name,
        "scenario": row.scenario,
        "group": row.group,
        "repetitions": row.repetitions,
        "baseline_repetitions": row.baseline_repetitions,
        "median": row.median,
        "baseline_median": row.baseline_median,
        **asdict(row.effect),
        "p_holm": row.p_holm,
        "judgement": row.judgement,
    }
