"""Tables of the methods of one or several studies, each by its own target.

    drivora study compare ID --out FOLDER
    python -m benchmarks.method_tables FOLDER/figures.csv…
    python -m benchmarks.method_tables FOLDER/figures.csv… --measure avoidable
    python -m benchmarks.method_tables FOLDER/figures.csv… --twins
    python -m benchmarks.method_tables FOLDER/figures.csv… --measure avoidable --baseline drivefuzz
    python -m benchmarks.method_tables FOLDER/figures.csv… --brief
    python -m benchmarks.method_tables FOLDER/figures.csv… --survival PICTURES

The first table compares every method with random search by what its authors want of it, the second
by a measure that is the same for all, the third each method with its twin without feedback, by its
own target again. p is corrected by Holm: against random over all rows of the same measure, and
against the twins over the places of a method. Campaigns of a study at equal time
(`study compare --equal-time`) are read in the same way. With ``--brief`` a method is one row of any
of these, and a place one column. The pictures are the survival curves of all methods but the twins.

A study may have been run in parts, each with other repetitions (`seed` and `repetitions` in its
file), or each on a machine of its own: the tables are those of all files together.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path

from pydantic import TypeAdapter

from drivora_service.markdown_text import table
from drivora_service.studies.comparison.campaign_comparison_text import a12, value
from drivora_service.studies.comparison.campaign_measures import (
    SIGNIFICANT,
    Difference,
    compare_campaigns,
    measure,
)
from drivora_service.studies.comparison.study_comparison import StudyFigures
from drivora_service.studies.comparison.survival_curves import survival_curves
from drivora_service.studies.comparison.survival_files import write_survival

OWN_TARGETS: Mapping[str, str] = {
    "avfuzzer": "avoidable",
    "behavexplor": "avoidable_situations",
    # Objectives covered are not in what a run of other methods measures.
    "samota": "oracles",
    "doppeltest": "kinds",
    "lawbreaker": "law_coverage",
    "drivefuzz": "avoidable",
    # Of the study of needless detours, where they are the only failures.
    "decictor": "avoidable",
    # Its reward is nearness to a collision, whosever fault.
    "deepcollision": "failing",
}
"""The measure of what the authors of each method want of it."""

COLUMNS = (
    "method",
    "by",
    "place",
    "n",
    "median",
    "baseline",
    "A12 [95 %]",
    "p",
    "p, Holm",
)
_BASELINE = "random"
_TWIN = " without feedback"


def read(path: Path) -> Iterator[StudyFigures]:
    """Reads the figures of the campaigns of a study, as its comparison wrote them."""
    adapter = TypeAdapter(StudyFigures)
    names = {field.name for field in fields(StudyFigures)}
    lists = {"found", "found_avoidable"}
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            cells = {
                name: cell.split() if name in lists else cell or None
                for name, cell in row.items()
                if name in names
            }
            yield adapter.validate_python(cells)


def against_one(
    figures: Sequence[StudyFigures], by: str = "", baseline: str = _BASELINE
) -> list[Difference]:
    """Compares methods with one of them.

    Args:
        figures: Figures of campaigns.
        by: A measure for all methods; "": each by its own target.
        baseline: Name of the one.
    """
    wanted: dict[str, list[str]] = {}
    for method in dict.fromkeys(one.method for one in figures):
        target = by or OWN_TARGETS.get(method, "")
        if target and method != baseline:
            wanted.setdefault(target, []).append(method)
    rows: list[Difference] = []
    for target, methods in wanted.items():
        compared = _with_baseline(figures, methods, baseline)
        if compared:
            rows += compare_campaigns(compared, baseline, [measure(target)])
    return rows


def against_twins(figures: Sequence[StudyFigures], by: str = "") -> list[Difference]:
    """Compares each method with itself without feedback.

    Args:
        figures: Figures of campaigns.
        by: A measure for all methods; "": each by its own target.
    """
    rows: list[Difference] = []
    for method, target in OWN_TARGETS.items():
        compared = _with_baseline(figures, [method], method + _TWIN)
        if compared:
            rows += compare_campaigns(compared, method + _TWIN, [measure(by or target)])
    return rows


def _with_baseline(
    figures: Sequence[StudyFigures], methods: Sequence[str], baseline: str
) -> list[StudyFigures]:
    """Returns the campaigns of methods and baseline where there are both, with place and ADS."""
    placed = [replace(one, scenario=f"{one.scenario}, {one.agent}") for one in figures]
    there = {name: {one.scenario for one in placed if one.method == name} for name in methods}
    bases = {one.scenario for one in placed if one.method == baseline}
    both = {place for places in there.values() for place in places & bases}
    return [one for one in placed if one.scenario in both and (one.method in {*methods, baseline})]


def cells(row: Difference) -> tuple[str, ...]:
    """Returns the cells of a row; a star marks a large effect that is significant."""
    mark = " *" if row.is_better else ""
    return (
        row.method,
        row.title,
        row.scenario,
        f"{row.repetitions}/{row.baseline_repetitions}",
        value(row.median),
        value(row.baseline_median),
        a12(row),
        f"{row.p:.2g}",
        f"{row.p_holm:.2g}{mark}",
    )


def brief(rows: Sequence[Difference]) -> list[tuple[str, ...]]:
    """Returns the head and the rows of a table with a row a method and a column a place.

    A cell has the median, that of the baseline, and A12. After the correction, a star marks a large
    effect, a plus sign a smaller one, and a minus sign that the method is worse.
    """
    places = tuple(dict.fromkeys(row.scenario for row in rows))
    found = {(row.method, row.title, row.scenario): _brief_cell(row) for row in rows}
    methods = dict.fromkeys((row.method, row.title) for row in rows)
    return [
        ("method", "by", *places),
        *(
            (method, title, *(found.get((method, title, place), "") for place in places))
            for method, title in methods
        ),
    ]


def _brief_cell(row: Difference) -> str:
    mark = ""
    if row.p_holm < SIGNIFICANT:
        mark = " -" if row.a12 < 0.5 else " *" if row.is_better else " +"
    return f"{value(row.median)} : {value(row.baseline_median)}, {row.a12:.2f}{mark}"


def draw_curves(figures: Sequence[StudyFigures], folder: Path) -> tuple[Path, ...]:
    """Draws the survival curves of all methods but the twins, into a folder that may be new."""
    shown = [one for one in figures if not one.method.endswith(_TWIN)]
    folder.mkdir(parents=True, exist_ok=True)
    return write_survival(survival_curves(shown, agent_of=lambda one: one.agent), _BASELINE, folder)


def main(arguments: Sequence[str]) -> None:
    """Prints a table, or draws curves."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("figures", nargs="+", type=Path, help="figures.csv of studies")
    parser.add_argument("--measure", default="", help="the same for all, not each one's target")
    parser.add_argument("--baseline", default=_BASELINE, help="method to compare the others with")
    parser.add_argument("--twins", action="store_true", help="against methods without feedback")
    parser.add_argument("--brief", action="store_true", help="a row a method, a column a place")
    parser.add_argument("--survival", type=Path, help="folder for curves, in place of a table")
    options = parser.parse_args(arguments)
    figures = [one for path in options.figures for one in read(path)]
    if options.survival:
        print("\n".join(map(str, draw_curves(figures, options.survival))))
        return
    if options.twins:
        rows = against_twins(figures, options.measure)
    else:
        rows = against_one(figures, options.measure, options.baseline)
    head, *body = brief(rows) if options.brief else (COLUMNS, *map(cells, rows))
    print("\n".join(table(head, body)))


if __name__ == "__main__":
    main(sys.argv[1:])
