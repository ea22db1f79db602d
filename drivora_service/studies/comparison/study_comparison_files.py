"""The comparison of a study as files: Markdown, CSV, and charts as SVG and PNG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from drivora_service.plotting.effect_chart import Values, draw_values
from drivora_service.shapes import field_names
from drivora_service.studies.comparison.campaign_measures import Difference, Measure, measure
from drivora_service.studies.comparison.study_comparison import StudyComparison, StudyFigures
from drivora_service.studies.comparison.study_comparison_text import study_markdown
from drivora_service.studies.comparison.survival_curves import survival_curves
from drivora_service.studies.comparison.survival_files import survival_markdown, write_survival
from drivora_service.studies.tables.csv_text import write_csv


def write_study_comparison(comparison: StudyComparison, folder: Path) -> tuple[Path, ...]:
    """Writes the comparison of a study into a folder, which is made if it does not exist.

    Returns:
        The files: ``study.md``, ``by-method.csv``, ``by-agent.csv``, ``figures.csv``,
        ``survival.csv``, and the charts ``values`` and ``survival-K`` as SVG and PNG.
    """
    folder.mkdir(parents=True, exist_ok=True)
    charts = draw_study(comparison, folder / "values")
    text, figures = folder / "study.md", folder / "figures.csv"
    curves = survival_curves(comparison.campaigns, agent_of=lambda f: f.agent)
    survival = write_survival(curves, comparison.baseline_method, folder)
    shown = [path.name for path in survival if path.suffix == ".svg"]
    text.write_text(
        study_markdown(comparison, [charts[0].name])
        + "\n".join(("", *survival_markdown(curves, shown), ""))
    )
    tables = []
    for name, rows in (("by-method", comparison.by_method), ("by-agent", comparison.by_agent)):
        columns = (*field_names(Difference), "judgement")
        tables.append(folder / f"{name}.csv")
        write_csv(tables[-1], columns, ([getattr(row, c) for c in columns] for row in rows))
    columns = tuple(field.name for field in fields(StudyFigures))
    write_csv(figures, columns, (_cells(one, columns) for one in comparison.campaigns))
    return (text, *tables, figures, *survival, *charts)


def draw_study(comparison: StudyComparison, stem: Path) -> tuple[Path, Path]:
    """Draws the first measure: scenarios across, agents down, a row a method, a point a campaign.

    Args:
        comparison: The comparison.
        stem: Path of the files without suffix.

    Returns:
        The files, SVG and PNG.
    """
    chosen = _first_measure(comparison)
    places: dict[tuple[str, str], dict[str, list[float]]] = {}
    for one in comparison.campaigns:
        found = chosen.value(one)
        if found is not None:
            methods = places.setdefault((one.agent, one.scenario), {})
            methods.setdefault(one.method, []).append(found)
    shown = [
        Values(measure=f"{chosen.title}, {agent}", scenario=scenario, methods=methods)
        for (agent, scenario), methods in places.items()
    ]
    return draw_values(shown, comparison.baseline_method, stem)


def _first_measure(comparison: StudyComparison) -> Measure:
    return measure(comparison.overview[0].measure)


def _cells(figures: StudyFigures, columns: Sequence[str]) -> list[object]:
    cells = [getattr(figures, column) for column in columns]
    return [" ".join(map(str, cell)) if isinstance(cell, tuple) else cell for cell in cells]
