"""The comparison of a study as rows of text: an overview, then every place."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.markdown_text import escape_markdown, escape_prose, table
from drivora_service.studies.accountable_counts import COLUMNS, WORDS, accountable_rows
from drivora_service.studies.comparison.campaign_comparison_text import a12, probability, value
from drivora_service.studies.comparison.campaign_measures import SIGNIFICANT, Difference
from drivora_service.studies.comparison.study_comparison import By, OverviewRow, StudyComparison

OVERVIEW_COLUMNS = ("measure", "compared", "median", "baseline", "A12", "better", "worse", "open")
DETAIL_COLUMNS = ("place", "compared", "n", "median", "baseline", "A12 [95 %]", "p", "p, Holm")


def baseline_of(comparison: StudyComparison, by: By) -> str:
    """Returns the baseline of a comparison by method or by agent."""
    return comparison.baseline_method if by is By.METHOD else comparison.baseline_agent


def overview_cells(row: OverviewRow) -> tuple[str, ...]:
    """Returns the cells of a row of an overview."""
    return (
        f"{row.title} ({'more' if row.larger_is_better else 'less'} is better)",
        row.name,
        value(row.median),
        value(row.baseline_median),
        f"{row.a12:.2f}",
        f"{row.better}/{row.places}",
        f"{row.worse}/{row.places}",
        f"{row.undecided}/{row.places}",
    )


def detail_cells(row: Difference) -> tuple[str, ...]:
    """Returns the cells of one place."""
    return (
        row.scenario,
        row.method,
        f"{row.repetitions}/{row.baseline_repetitions}",
        value(row.median),
        value(row.baseline_median),
        a12(row),
        probability(row.p),
        probability(row.p_holm),
    )


def how_to_read_study(comparison: StudyComparison) -> str:
    """Explains the columns."""
    agents = (
        f", agents with {comparison.baseline_agent!r} on each scenario with each method"
        if comparison.by_agent
        else ""
    )
    return (
        f"Methods are compared with {comparison.baseline_method!r} on each scenario with each "
        f"agent{agents}. A12 "
        "is the probability that a repetition is better than one of the baseline, in the overview "
        "its mean over these places: 0.5 is no difference, from 0.71 on (or below 0.29) it is "
        "called large. Better and worse count the places with p (Mann-Whitney U, corrected by Holm "
        f"for all rows of a measure) below {SIGNIFICANT:g}; the others are open."
    )


def remarks(comparison: StudyComparison) -> tuple[str, ...]:
    """Returns what is to be known of the comparison: its notes, and its limits of time."""
    limits = (
        f"{place}: what each had done after {limit:.1f} s of one worker, its own time included"
        for place, limit in comparison.time_limits_s.items()
    )
    return (*comparison.notes, *limits)


def study_markdown(comparison: StudyComparison, charts: Sequence[str] = ()) -> str:
    """Writes the comparison as Markdown.

    Args:
        comparison: The comparison.
        charts: Names of pictures in the folder of the text.
    """
    lines = [f"# {escape_markdown(comparison.name)}", ""]
    lines += [escape_markdown(how_to_read_study(comparison)), ""]
    lines += [f"- {escape_prose(remark)}" for remark in remarks(comparison)]
    for by in By:
        rows = [row for row in comparison.overview if row.by is by]
        if rows:
            lines += ["", f"## By {by}, against {escape_markdown(baseline_of(comparison, by))}", ""]
            lines += table(OVERVIEW_COLUMNS, [overview_cells(row) for row in rows])
    lines += ["", "## What the simulations came to", "", WORDS, ""]
    lines += table(
        COLUMNS, accountable_rows(comparison.campaigns, lambda f: f"{f.scenario}, {f.agent}")
    )
    lines += [f"\n![{name}]({name})" for name in charts]
    for by, differences in ((By.METHOD, comparison.by_method), (By.AGENT, comparison.by_agent)):
        for title in dict.fromkeys(row.title for row in differences):
            lines += ["", f"## By {by}: {escape_markdown(title)}", ""]
            own = [detail_cells(row) for row in differences if row.title == title]
            lines += table(DETAIL_COLUMNS, own)
    return "\n".join(lines) + "\n"
