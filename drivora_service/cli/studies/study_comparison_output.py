"""Comparisons of studies as commands print them."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.cli.terminal.output import print_prose, print_table, say
from drivora_service.studies.accountable_counts import COLUMNS, accountable_rows
from drivora_service.studies.comparison.study_comparison import By, StudyComparison
from drivora_service.studies.comparison.study_comparison_text import (
    DETAIL_COLUMNS,
    OVERVIEW_COLUMNS,
    baseline_of,
    detail_cells,
    how_to_read_study,
    overview_cells,
    remarks,
)


def print_study_comparison(comparison: StudyComparison) -> None:
    """Prints the overview, then a table a measure."""
    for remark in remarks(comparison):
        say(f"note: {remark}")
    _print_by_first(
        "What the simulations came to",
        COLUMNS,
        accountable_rows(comparison.campaigns, lambda f: f"{f.scenario}, {f.agent}"),
    )
    for by in By:
        rows = [row for row in comparison.overview if row.by is by]
        if rows:
            _print_by_first(
                f"Overview by {by}, against {baseline_of(comparison, by)}",
                OVERVIEW_COLUMNS,
                [overview_cells(row) for row in rows],
            )
    print_prose(how_to_read_study(comparison))
    say()
    for by, differences in ((By.METHOD, comparison.by_method), (By.AGENT, comparison.by_agent)):
        for title in dict.fromkeys(row.title for row in differences):
            _print_by_first(
                f"By {by}: {title}",
                DETAIL_COLUMNS,
                [detail_cells(row) for row in differences if row.title == title],
            )


def _print_by_first(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Prints a table with its first column as headings: places and measures have long names."""
    print_table(title, columns[1:], [row[1:] for row in rows], headings=[row[0] for row in rows])
