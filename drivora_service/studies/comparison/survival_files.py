"""Survival curves as files: numbers as CSV, a chart a number of kinds, and Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from drivora_service.markdown_text import table
from drivora_service.plotting.survival_chart import SurvivalLine, SurvivalPanel, draw_survival
from drivora_service.studies.comparison.survival_curves import Survival
from drivora_service.studies.tables.csv_text import write_csv

_COLUMNS = ("scenario", "agent", "method", "k", "repetitions", "events", "median")
_ORDINALS = {1: "first", 2: "second", 3: "third", 5: "fifth"}
_HOW_TO_READ = (
    "The number of simulations after which half of the repetitions had found so many kinds of "
    "avoidable at-fault failures, by the estimate of Kaplan and Meier (> and the last number if "
    "fewer than half had), and in brackets how many had."
)


def write_survival(curves: Sequence[Survival], baseline: str, folder: Path) -> tuple[Path, ...]:
    """Writes survival curves into an existing folder.

    Args:
        curves: The curves, at least one.
        baseline: Name of the method that is drawn in grey.
        folder: The folder.

    Returns:
        The files: ``survival.csv``, and for each number of kinds the chart ``survival-K``, SVG and
        PNG.
    """
    table = folder / "survival.csv"
    agents = dict.fromkeys(curve.agent for curve in curves)
    # Where agents are not told apart there is no column of them.
    left_out = () if any(agents) else ("agent",)
    write_csv(
        table,
        [column for column in _COLUMNS if column not in left_out],
        (
            [
                cell
                for column, cell in zip(_COLUMNS, _cells(curve), strict=True)
                if column not in left_out
            ]
            for curve in curves
        ),
    )
    charts: list[Path] = []
    for kinds in dict.fromkeys(curve.kinds for curve in curves):
        own = [curve for curve in curves if curve.kinds == kinds]
        charts += draw_survival(
            _panels(own, with_agent=len(agents) > 1),
            baseline,
            folder / f"survival-{kinds}",
            of=(
                "an avoidable at-fault failure"
                if kinds == 1
                else f"a {_ORDINALS[kinds]} kind of avoidable at-fault failure"
            ),
            columns=min(3, len({curve.scenario for curve in own})),
        )
    return (table, *charts)


def survival_markdown(curves: Sequence[Survival], charts: Sequence[str] = ()) -> list[str]:
    """Writes the medians as lines of Markdown.

    Args:
        curves: The curves.
        charts: Names of pictures to show, in the folder of the text.
    """
    columns = tuple(dict.fromkeys(curve.kinds for curve in curves))
    head = ("scenario", "method", "n", *(f"{_ORDINALS[kinds]} kind" for kinds in columns))
    rows: dict[tuple[str, str, str], list[str]] = {}
    for curve in curves:
        place = f"{curve.scenario}, {curve.agent}" if curve.agent else curve.scenario
        cells = rows.setdefault((place, curve.method, str(curve.repetitions)), [])
        median = f">{curve.at[-1]}" if curve.median is None else str(curve.median)
        cells.append(f"{median} ({curve.events})")
    lines = ["## Simulations to the first kinds", "", _HOW_TO_READ, ""]
    lines += table(head, [(*place, *cells) for place, cells in rows.items()])
    return lines + [f"\n![{name}]({name})" for name in charts]


def _cells(curve: Survival) -> tuple[object, ...]:
    return (
        curve.scenario,
        curve.agent,
        curve.method,
        curve.kinds,
        curve.repetitions,
        curve.events,
        curve.median,
    )


def _panels(curves: Sequence[Survival], *, with_agent: bool) -> list[SurvivalPanel]:
    places: dict[tuple[str, str], dict[str, SurvivalLine]] = {}
    for curve in curves:
        methods = places.setdefault((curve.agent, curve.scenario), {})
        methods[curve.method] = SurvivalLine(at=curve.at, share=curve.share, median=curve.median)
    # Agents below one another.
    agents = list(dict.fromkeys(agent for agent, _ in places))
    return [
        SurvivalPanel(title=f"{scenario}, {agent}" if with_agent else scenario, methods=methods)
        for (agent, scenario), methods in sorted(
            places.items(), key=lambda item: agents.index(item[0][0])
        )
    ]
