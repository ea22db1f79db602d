"""A comparison as files: Markdown, CSV, and charts as SVG and PNG."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path

from drivora_service.campaigns.comparing import Comparison
from drivora_service.campaigns.comparison import SIGNIFICANT, Measure, Row
from drivora_service.campaigns.figures import CampaignFigures
from drivora_service.plotting.discoveries import Discoveries, Repetition, draw_first, draw_found
from drivora_service.plotting.effects import EffectRow, Values, draw_effects, draw_values

_ROW_COLUMNS = (
    "measure",
    "scenario",
    "group",
    "baseline",
    "repetitions",
    "baseline_repetitions",
    "median",
    "baseline_median",
    "a12",
    "a12_low",
    "a12_high",
    "p",
    "p_holm",
    "judgement",
)


def write_comparison(comparison: Comparison, folder: Path) -> tuple[Path, ...]:
    """Writes a comparison into a folder, which is made if need be.

    Returns:
        The files: ``comparison.md``, ``comparison.csv``, ``figures.csv`` and charts.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text, table, figures = (
        folder / name for name in ("comparison.md", "comparison.csv", "figures.csv")
    )
    charts = _draw(comparison, folder)
    text.write_text(comparison_markdown(comparison, [p for p in charts if p.suffix == ".svg"]))
    _write_csv(table, _ROW_COLUMNS, (_row_cells(row) for row in comparison.rows))
    columns = (*(field.name for field in fields(CampaignFigures)), "own_share")
    _write_csv(figures, columns, (_figure_cells(one, columns) for one in comparison.figures))
    return (text, table, figures, *charts)


def comparison_markdown(comparison: Comparison, charts: Sequence[Path] = ()) -> str:
    """Writes a comparison as Markdown.

    Args:
        comparison: What to write.
        charts: Pictures to show, which lie beside the text.
    """
    lines = [f"# Comparison with {comparison.baseline}", "", how_to_read(comparison), ""]
    lines += [f"- {line}" for line in setting(comparison)]
    lines += [f"- Note: {note}" for note in comparison.notes]
    for measure in _measures(comparison):
        better = "more" if measure.larger_is_better else "less"
        lines += [
            "",
            f"## {measure.title[0].upper()}{measure.title[1:]}",
            "",
            f"`{measure.name}`; {better} is better.",
            "",
            f"| scenario | method | n | median | {comparison.baseline} | A12 [95 %] | p | p, Holm "
            "| judgement |",
            "|---|---|---|---|---|---|---|---|---|",
        ]
        lines += [
            f"| {row.scenario} | {row.group} | {row.repetitions} | {value(row.median)} "
            f"| {value(row.baseline_median)} | {a12(row)} | {probability(row.effect.p)} "
            f"| {probability(row.p_holm)} | {row.judgement} |"
            for row in comparison.rows
            if row.measure is measure
        ]
    if charts:
        lines += ["", "## Charts", ""]
        lines += [f"![{chart.stem.replace('-', ' ')}]({chart.name})\n" for chart in charts]
    return "\n".join(lines).rstrip("\n") + "\n"


def how_to_read(comparison: Comparison) -> str:
    """Says in two sentences what the columns mean."""
    return (
        f"A12 is the probability that a repetition of the method is better than one of "
        f"{comparison.baseline}: 0.5 is no difference, from 0.71 on (or below 0.29) it is called "
        f"large. It is undecided unless p, corrected by Holm for all rows of a measure, "
        f"is below {SIGNIFICANT:g} (Mann-Whitney U, two-sided)."
    )


def setting(comparison: Comparison) -> tuple[str, ...]:
    """Says what was compared on which scenario."""
    lines = []
    for scenario, budget in comparison.budgets.items():
        here = [f for f in comparison.figures if f.scenario == scenario]
        counts = {group: sum(f.group == group for f in here) for group in _groups(here)}
        told = ", ".join(f"{count} of {group}" for group, count in counts.items())
        limit = comparison.time_limits.get(scenario)
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


def a12(row: Row) -> str:
    """Writes A12 with its interval."""
    return f"{row.effect.a12:.2f} [{row.effect.low:.2f}, {row.effect.high:.2f}]"


def probability(p: float) -> str:
    """Writes a p-value."""
    return "<0.001" if p < 0.001 else f"{p:.3f}"


def _draw(comparison: Comparison, folder: Path) -> list[Path]:
    baseline = comparison.baseline
    discoveries = [
        Discoveries(
            title=scenario,
            groups={
                group: [
                    Repetition(simulations=f.simulations, found=f.found)
                    for f in comparison.figures
                    if (f.scenario, f.group) == (scenario, group)
                ]
                for group in _groups(f for f in comparison.figures if f.scenario == scenario)
            },
        )
        for scenario in comparison.budgets
    ]
    charts = [
        *draw_found(discoveries, baseline, folder / "failures-found"),
        *draw_first(discoveries, baseline, folder / "first-failure"),
    ]
    if comparison.rows:
        charts += draw_effects(_effects(comparison), baseline, folder / "effects")
        charts += draw_values(_values(comparison), baseline, folder / "values")
    return charts


def _effects(comparison: Comparison) -> list[EffectRow]:
    several = len(comparison.budgets) > 1
    return [
        EffectRow(
            section=f"{row.measure.title}, {row.scenario}" if several else row.measure.title,
            group=row.group,
            a12=row.effect.a12,
            low=row.effect.low,
            high=row.effect.high,
            is_significant=row.p_holm < SIGNIFICANT,
        )
        for row in comparison.rows
    ]


def _values(comparison: Comparison) -> list[Values]:
    shown = []
    for measure in _measures(comparison):
        for scenario in comparison.budgets:
            here = [f for f in comparison.figures if f.scenario == scenario]
            known: dict[str, list[float]] = {}
            for figures in here:
                found = measure.value(figures)
                if found is not None:
                    known.setdefault(figures.group, []).append(found)
            if known:
                shown.append(Values(measure=measure.title, scenario=scenario, groups=known))
    return shown


def _measures(comparison: Comparison) -> tuple[Measure, ...]:
    return tuple({row.measure.name: row.measure for row in comparison.rows}.values())


def _groups(figures: Iterable[CampaignFigures]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(f.group for f in figures))


def _row_cells(row: Row) -> tuple[object, ...]:
    return (
        row.measure.name,
        row.scenario,
        row.group,
        row.baseline,
        row.repetitions,
        row.baseline_repetitions,
        row.median,
        row.baseline_median,
        row.effect.a12,
        row.effect.low,
        row.effect.high,
        row.effect.p,
        row.p_holm,
        row.judgement,
    )


def _figure_cells(figures: CampaignFigures, columns: Sequence[str]) -> list[object]:
    cells = [getattr(figures, column) for column in columns]
    return [" ".join(map(str, cell)) if isinstance(cell, tuple) else cell for cell in cells]


def _write_csv(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)
