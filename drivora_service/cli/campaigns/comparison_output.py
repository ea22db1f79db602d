"""Comparisons of campaigns as commands print them."""

from __future__ import annotations

from itertools import groupby

from drivora_service.cli.terminal.output import print_table, say
from drivora_service.studies.accountable_counts import COLUMNS, accountable_rows
from drivora_service.studies.comparison.campaign_comparison import Comparison
from drivora_service.studies.comparison.campaign_comparison_text import (
    a12,
    describe_setting,
    how_to_read,
    probability,
    value,
)
from drivora_service.studies.comparison.campaign_measures import Difference


def print_comparison(comparison: Comparison) -> None:
    """Prints a table a measure."""
    for line in describe_setting(comparison):
        say(line)
    for remark in comparison.notes:
        say(f"note: {remark}")
    counts = accountable_rows(comparison.campaigns)
    print_table(
        "What the simulations came to",
        COLUMNS[1:],
        [row[1:] for row in counts],
        headings=[row[0] for row in counts],
    )
    several = len(comparison.budgets) > 1
    columns = ("method", "median", comparison.baseline, "A12 [95 %]", "p", "Holm", "judgement")
    for _, same in groupby(comparison.differences, key=lambda row: row.measure):
        rows = tuple(same)
        better = "more" if rows[0].larger_is_better else "less"
        print_table(
            f"{rows[0].title} ({better} is better)",
            (*(("scenario",) if several else ()), *columns),
            (((row.scenario,) if several else ()) + _cells(row) for row in rows),
        )
    say(how_to_read(comparison))


def _cells(row: Difference) -> tuple[str, ...]:
    return (
        row.method,
        value(row.median),
        value(row.baseline_median),
        a12(row),
        probability(row.p),
        probability(row.p_holm),
        row.judgement,
    )
