"""Comparisons of two batches as commands print them."""

from __future__ import annotations

from drivora_service.cli.terminal.output import print_prose, print_table, say
from drivora_service.suites.paired.batch_comparison import BatchComparison
from drivora_service.suites.paired.batch_comparison_text import (
    FAILURE_COLUMNS,
    FAILURES_OF_PAIR,
    METRIC_COLUMNS,
    describe_differences,
    discordant_pairs,
    failure_cells,
    failure_rows,
    how_to_read_failures,
    how_to_read_metrics,
    metric_cells,
    pair_cells,
    pair_columns,
    sides,
)


def print_batch_comparison(comparison: BatchComparison) -> None:
    """Prints how things stand, then the tables."""
    for name, line in sides(comparison):
        say(f"{name}: {line}")
    for line in describe_differences(comparison):
        say(line)
    say()
    print_prose(comparison.sentence)
    say()
    for remark in comparison.notes:
        say(f"note: {remark}")
    for left in comparison.left_out:
        say(f"left out: {left.scenario}, seed {left.seed}: {left.message}")
    if not comparison.pairs:
        return
    print_table("Failures", FAILURE_COLUMNS, map(failure_cells, failure_rows(comparison)))
    print_prose(how_to_read_failures(comparison))
    measured = [row for row in comparison.metrics if row.difference]
    equal = len(comparison.metrics) - len(measured)
    say()
    if measured:
        print_table("Metrics", METRIC_COLUMNS, map(metric_cells, measured))
        print_prose(how_to_read_metrics())
    if equal:
        say(f"Metrics that are equal in the mean, or not measurable: {equal}")
    telling = discordant_pairs(comparison)
    if telling:
        say()
        print_table(
            "Pairs that tell A from B",
            pair_columns(comparison),
            (pair_cells(comparison, pair) for pair in telling),
            wrap=(FAILURES_OF_PAIR,),
        )
