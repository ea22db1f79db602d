"""A comparison as files: Markdown, CSV, and charts as SVG and PNG."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path

from drivora_service.plotting.discovery_chart import Discoveries, Repetition, draw_first, draw_found
from drivora_service.plotting.effect_chart import EffectRow, Values, draw_effects, draw_values
from drivora_service.studies.campaign_figures import CampaignFigures
from drivora_service.studies.comparison.campaign_comparison import Comparison
from drivora_service.studies.comparison.campaign_comparison_text import (
    comparison_markdown,
    measures_of,
    methods_of,
)
from drivora_service.studies.comparison.campaign_measures import SIGNIFICANT, Difference
from drivora_service.studies.comparison.survival_curves import survival_curves
from drivora_service.studies.comparison.survival_files import survival_markdown, write_survival
from drivora_service.studies.tables.csv_text import write_csv

_ROW_COLUMNS = (
    "measure",
    "scenario",
    "method",
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
    """Writes a comparison into a folder, which is made if it does not exist.

    Returns:
        The files: ``comparison.md``, ``comparison.csv``, ``figures.csv``, ``survival.csv`` and
        charts.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text, table, figures = (
        folder / name for name in ("comparison.md", "comparison.csv", "figures.csv")
    )
    charts = _draw(comparison, folder)
    curves = survival_curves(comparison.campaigns)
    survival = write_survival(curves, comparison.baseline, folder)
    shown = [path.name for path in survival if path.suffix == ".svg"]
    text.write_text(
        comparison_markdown(comparison, [p for p in charts if p.suffix == ".svg"])
        + "\n".join(("", *survival_markdown(curves, shown), ""))
    )
    write_csv(table, _ROW_COLUMNS, (_row_cells(row) for row in comparison.differences))
    columns = (*(field.name for field in fields(CampaignFigures)), "own_share")
    write_csv(figures, columns, (_figure_cells(one, columns) for one in comparison.campaigns))
    return (text, table, figures, *survival, *charts)


def _draw(comparison: Comparison, folder: Path) -> list[Path]:
    baseline = comparison.baseline
    targets = _discoveries(comparison, lambda f: f.found_avoidable)
    failures = _discoveries(comparison, lambda f: f.found)
    charts = [
        *draw_found(targets, baseline, folder / "avoidable-found", of="avoidable failures"),
        *draw_first(targets, baseline, folder / "first-avoidable", of="an avoidable failure"),
        *draw_found(failures, baseline, folder / "failures-found"),
        *draw_first(failures, baseline, folder / "first-failure"),
    ]
    if comparison.differences:
        charts += draw_effects(_effects(comparison), baseline, folder / "effects")
        charts += draw_values(_values(comparison), baseline, folder / "values")
    return charts


def _discoveries(
    comparison: Comparison, found: Callable[[CampaignFigures], tuple[int, ...]]
) -> list[Discoveries]:
    return [
        Discoveries(
            title=scenario,
            methods={
                method: [
                    Repetition(simulations=f.simulations, found=found(f))
                    for f in comparison.campaigns
                    if (f.scenario, f.method) == (scenario, method)
                ]
                for method in methods_of(f for f in comparison.campaigns if f.scenario == scenario)
            },
        )
        for scenario in comparison.budgets
    ]


def _effects(comparison: Comparison) -> list[EffectRow]:
    several = len(comparison.budgets) > 1
    return [
        EffectRow(
            section=f"{row.title}, {row.scenario}" if several else row.title,
            method=row.method,
            a12=row.a12,
            low=row.low,
            high=row.high,
            is_significant=row.p_holm < SIGNIFICANT,
        )
        for row in comparison.differences
    ]


def _values(comparison: Comparison) -> list[Values]:
    shown = []
    for measure in measures_of(comparison):
        for scenario in comparison.budgets:
            here = [f for f in comparison.campaigns if f.scenario == scenario]
            known: dict[str, list[float]] = {}
            for figures in here:
                found = measure.value(figures)
                if found is not None:
                    known.setdefault(figures.method, []).append(found)
            if known:
                shown.append(Values(measure=measure.title, scenario=scenario, methods=known))
    return shown


def _row_cells(row: Difference) -> tuple[object, ...]:
    return (
        row.measure,
        row.scenario,
        row.method,
        row.baseline,
        row.repetitions,
        row.baseline_repetitions,
        row.median,
        row.baseline_median,
        row.a12,
        row.low,
        row.high,
        row.p,
        row.p_holm,
        row.judgement,
    )


def _figure_cells(figures: CampaignFigures, columns: Sequence[str]) -> list[object]:
    cells = [getattr(figures, column) for column in columns]
    return [" ".join(map(str, cell)) if isinstance(cell, tuple) else cell for cell in cells]
