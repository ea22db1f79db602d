"""A comparison as text: its setting, how to read it, and the whole as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from drivora_service.markdown_text import code_span, escape_markdown, escape_prose, table
from drivora_service.studies.accountable_counts import COLUMNS, WORDS, accountable_rows
from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.comparison.campaign_comparison import Comparison
from drivora_service.studies.comparison.campaign_measures import (
    SIGNIFICANT,
    Difference,
    Measure,
    measure,
)


def comparison_markdown(comparison: Comparison, charts: Sequence[Path] = ()) -> str:
    """Writes a comparison as Markdown.

    Args:
        comparison: The comparison.
        charts: Pictures to show, in the folder of the text.
    """
    lines = [f"# Comparison with {escape_markdown(comparison.baseline)}", ""]
    lines += [escape_markdown(how_to_read(comparison)), ""]
    lines += [f"- {escape_markdown(line)}" for line in describe_setting(comparison)]
    lines += [f"- Note: {escape_prose(note)}" for note in comparison.notes]
    lines += ["", "## What the simulations came to", "", WORDS, ""]
    lines += table(COLUMNS, accountable_rows(comparison.campaigns))
    for by in measures_of(comparison):
        better = "more" if by.larger_is_better else "less"
        lines += [
            "",
            f"## {escape_markdown(by.title[0].upper() + by.title[1:])}",
            "",
            f"{code_span(by.name)}; {better} is better.",
            "",
        ]
        titles = ("scenario", "method", "n", "median", comparison.baseline)
        lines += table(
            (*titles, "A12 [95 %]", "p", "p, Holm", "judgement"),
            [
                (
                    row.scenario,
                    row.method,
                    str(row.repetitions),
                    value(row.median),
                    value(row.baseline_median),
                    a12(row),
                    probability(row.p),
                    probability(row.p_holm),
                    str(row.judgement),
                )
                for row in comparison.differences
                if row.measure == by.name
            ],
        )
    if charts:
        lines += ["", "## Charts", ""]
        lines += [f"![{chart.stem.replace('-', ' ')}]({chart.name})\n" for chart in charts]
    return "\n".join(lines).rstrip("\n") + "\n"


def how_to_read(comparison: Comparison) -> str:
    """Explains the columns in three sentences."""
    return (
        f"A12 is the probability that a repetition of the method is better than one of "
        f"{comparison.baseline}: 0.5 is no difference, from 0.71 on (or below 0.29) it is called "
        f"large. A row is undecided unless p, corrected by Holm for all rows of a measure, is "
        f"below {SIGNIFICANT:g} (Mann-Whitney U, two-sided)."
    )


def describe_setting(comparison: Comparison) -> tuple[str, ...]:
    """Describes the compared campaigns, by scenario."""
    lines = []
    for scenario, budget in comparison.budgets.items():
        here = [f for f in comparison.campaigns if f.scenario == scenario]
        counts = {method: sum(f.method == method for f in here) for method in methods_of(here)}
        told = ", ".join(f"{count} of {method}" for method, count in counts.items())
        limit = comparison.time_limits_s.get(scenario)
        until = (
            f"{budget} simulations each"
            if limit is None
            else f"what each had done after {limit:.1f} s of one worker, its own time included"
        )
        lines.append(f"{scenario}: {told}; {until}")
    return tuple(lines)


def value(number: float) -> str:
    """Writes the value of a measure."""
    return f"{number:.4g}"


def a12(row: Difference) -> str:
    """Writes A12 with its interval."""
    return f"{row.a12:.2f} [{row.low:.2f}, {row.high:.2f}]"


def probability(p: float) -> str:
    """Writes a p-value."""
    return "<0.001" if p < 0.001 else f"{p:.3f}"


def measures_of(comparison: Comparison) -> tuple[Measure, ...]:
    """Returns the measures that have rows, in their order."""
    return tuple(
        measure(name) for name in dict.fromkeys(row.measure for row in comparison.differences)
    )


def methods_of(figures: Iterable[CampaignFigures]) -> tuple[str, ...]:
    """Returns the names of the methods, in their order."""
    return tuple(dict.fromkeys(f.method for f in figures))
