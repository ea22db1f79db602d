"""Charts of differences between methods: effects with intervals, and all single values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from drivora_service.plotting import colors
from drivora_service.plotting.charts import LETTER, Look, chart_style, looks_of, write_chart

_ROW = 0.24
"""Distance of rows in the forest plot, inches."""
_STRIP = 0.27
"""Width of a method in a panel of values, inches."""
_CHANCE = 0.5
_LARGE = (0.29, 0.71)
_JITTER = 0.22


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectRow:
    """The effect of a method against the baseline by one measure.

    Attributes:
        section: Heading of the row.
        a12: Probability that the method is better, with the ends of its interval.
        is_significant: Whether the difference is significant.
    """

    section: str
    method: str
    a12: float
    low: float
    high: float
    is_significant: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Values:
    """The values of one measure on one scenario.

    Attributes:
        measure: Name of the row of panels.
        scenario: Name of the column of panels.
        methods: Values of the repetitions, by method.
    """

    measure: str
    scenario: str
    methods: Mapping[str, Sequence[float]]


def draw_effects(rows: Sequence[EffectRow], baseline: str, stem: Path) -> tuple[Path, Path]:
    """Draws A12 of every row with its interval, section by section.

    Filled marks are significant, hollow ones are not.

    Args:
        rows: At least one; those of a section follow one another.
        baseline: Baseline method.
        stem: Path of the files without suffix.

    Returns:
        The files, SVG and PNG.
    """
    looks = looks_of([row.method for row in rows], baseline)
    sections = [(name, list(found)) for name, found in groupby(rows, key=lambda row: row.section)]
    lines = len(rows) + len(sections)
    left = LETTER * max(len(row.method) for row in rows) + 0.35
    width, height = left + 5.2, _ROW * (lines + 1) + 0.75
    with chart_style():
        figure = Figure(figsize=(width, height), facecolor="white")
        axes = figure.add_axes(
            (left / width, 0.6 / height, 4.95 / width, _ROW * (lines + 1) / height)
        )
        ticks: list[tuple[float, str]] = []
        y = 0.0
        for name, found in sections:
            axes.text(0.0, y, name, va="center", fontsize=8.5, fontweight="bold")
            y += 1.0
            rows_of_section = (y - 0.5, y + len(found) - 0.5)
            axes.fill_betweenx(rows_of_section, *_LARGE, color="#edeff1", lw=0.0)
            axes.plot((_CHANCE, _CHANCE), rows_of_section, color=colors.FAINT_INK, lw=1.0)
            for row in found:
                _draw_effect(axes, row, y, looks[row.method])
                ticks.append((y, row.method))
                y += 1.0
        axes.set_yticks([at for at, _ in ticks], [label for _, label in ticks])
        axes.tick_params(axis="y", length=0, labelcolor=colors.INK)
        axes.set_ylim(y, -1.0)
        axes.set_xlim(-0.01, 1.01)
        axes.set_xticks([0.0, 0.29, 0.5, 0.71, 1.0])
        axes.spines["left"].set_visible(False)
        axes.set_xlabel(
            f"← {baseline} is better      A12 with its 95 % interval      the method is better →\n"
            "filled: p < 0.05 after Holm; outside the grey area the effect is large",
            fontsize=8.5,
        )
        return write_chart(figure, stem)


def draw_values(shown: Sequence[Values], baseline: str, stem: Path) -> tuple[Path, Path]:
    """Draws every value as a point over a box of quartiles; measures down, scenarios across.

    Args:
        shown: At least one.
        baseline: Name of the method that is drawn in grey.
        stem: Path of the files without suffix.

    Returns:
        The files, SVG and PNG.
    """
    looks = looks_of([method for one in shown for method in one.methods], baseline)
    measures = list(dict.fromkeys(one.measure for one in shown))
    scenarios = list(dict.fromkeys(one.scenario for one in shown))
    names = [method for method in looks if any(method in one.methods for one in shown)]
    left = LETTER * max(len(name) for name in names)
    panel_height = _STRIP * len(names) + 0.75 + 0.15 * (len(scenarios) > 1)
    with chart_style():
        figure = Figure(
            figsize=(left + 4.0 * len(scenarios), panel_height * len(measures)),
            facecolor="white",
            layout="constrained",
        )
        grid = figure.subplots(len(measures), len(scenarios), squeeze=False, sharey=True)
        for axes in grid.ravel():
            axes.set_axis_off()
        for one in shown:
            axes = grid[measures.index(one.measure), scenarios.index(one.scenario)]
            axes.set_axis_on()
            title = one.measure if len(scenarios) == 1 else f"{one.measure}\n{one.scenario}"
            axes.set_title(title, fontsize=9)
            for place, name in enumerate(names):
                if name in one.methods:
                    _draw_strip(axes, np.array(one.methods[name]), float(place), looks[name])
            _set_range(axes, [number for method in one.methods.values() for number in method])
            axes.set_yticks(range(len(names)), names)
            axes.set_ylim(len(names) - 0.4, -0.6)
            axes.tick_params(axis="y", length=0, labelcolor=colors.INK)
            axes.xaxis.set_major_locator(MaxNLocator(nbins=5))
            axes.grid(visible=True, axis="x")
            axes.spines["left"].set_visible(False)
        return write_chart(figure, stem)


def _draw_effect(axes: Axes, row: EffectRow, y: float, look: Look) -> None:
    axes.plot([row.low, row.high], [y, y], color=look.color, lw=1.8, solid_capstyle="butt")
    axes.plot(
        [row.a12],
        [y],
        marker=look.marker if look.marker != "x" else "o",
        ms=6.5,
        mfc=look.color if row.is_significant else "white",
        mec=look.color,
        mew=1.4,
        clip_on=False,
        zorder=3.0,
    )


def _set_range(axes: Axes, values: Sequence[float]) -> None:
    """Sets a range with a margin around all values; equal ones at the left of a range of 1."""
    low, high = min(values), max(values)
    room = 0.05 * (high - low or 1.0)
    axes.set_xlim(low - room, (high if high > low else low + 1.0) + room)


def _draw_strip(axes: Axes, values: np.ndarray, y: float, look: Look) -> None:
    low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
    axes.barh(y, high - low, left=low, height=0.62, color=look.color, alpha=0.18, lw=0.0)
    axes.plot([middle, middle], [y - 0.31, y + 0.31], color=look.color, lw=2.2)
    # Spread by rank, not randomly, so that the same values yield the same picture.
    order = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    offsets = _JITTER * (2.0 * ((order * 0.618034) % 1.0) - 1.0)
    axes.plot(
        values, y + offsets, ls="none", marker=look.marker, ms=3.6, color=look.color, alpha=0.75
    )
