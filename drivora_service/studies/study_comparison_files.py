"""The comparison of a study as files: Markdown, CSV, and a chart as SVG and PNG."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path

from drivora_service.plotting.effects import Values, draw_values
from drivora_service.shapes import field_names
from drivora_service.studies.comparison import Difference, Measure, measure
from drivora_service.studies.csv_text import safe_cells
from drivora_service.studies.study_comparison import StudyComparison, StudyFigures
from drivora_service.studies.study_comparison_text import study_markdown


def write_study_comparison(comparison: StudyComparison, folder: Path) -> tuple[Path, ...]:
    """Writes the comparison of a study into a folder, which is made if it does not exist.

    Returns:
        The files: ``study.md``, ``by-method.csv``, ``by-agent.csv``, ``figures.csv``, and the chart
        ``values`` as SVG and PNG.
    """
    folder.mkdir(parents=True, exist_ok=True)
    charts = draw_study(comparison, folder / "values")
    text, figures = folder / "study.md", folder / "figures.csv"
    text.write_text(study_markdown(comparison, [charts[0].name]))
    tables = []
    for name, rows in (("by-method", comparison.by_method), ("by-agent", comparison.by_agent)):
        columns = (*field_names(Difference), "judgement")
        tables.append(folder / f"{name}.csv")
        _write(tables[-1], columns, ([getattr(row, c) for c in columns] for row in rows))
    columns = tuple(field.name for field in fields(StudyFigures))
    _write(figures, columns, (_cells(one, columns) for one in comparison.campaigns))
    return (text, *tables, figures, *charts)


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


def _write(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(map(safe_cells, rows))
