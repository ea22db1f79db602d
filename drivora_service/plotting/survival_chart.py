"""Chart of survival curves: the share of repetitions that have not found something yet."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, PercentFormatter

from drivora_service.plotting import colors
from drivora_service.plotting.charts import LETTER, Look, chart_style, looks_of, panels, write_chart

MOST_LINES = 9
"""Greatest number of lines in a panel, the baseline included."""

_TITLE_CHARACTERS = 44
_LABEL_CHARACTERS = 32
"""Greatest length of a line of a label, characters."""
_LABEL_LINE = 0.155
"""Height of a line of a label, inches."""
_PLOT_WIDTH, _PLOT_HEIGHT = 3.2, 2.5
"""Size of the area with the curves, inches; higher where the labels need it."""
_MARKS = 4
"""Number of markers on a curve that does not end before the others."""
_KEY = (1.07, 1.17)
"""Ends of the piece of line before a label, as shares of the width of the area."""
_AROUND = 0.9
"""Room for titles and the names of the axes, inches."""
_LOW, _HIGH = -0.03, 1.04


@dataclass(frozen=True, slots=True, kw_only=True)
class SurvivalLine:
    """The curve of a method.

    Attributes:
        at: Numbers of simulations, ascending, from 0 to the last observed one.
        share: Share of the repetitions that have not found it after so many.
        median: Simulations after which half of them had; ``None`` if fewer than half had.
    """

    at: Sequence[int]
    share: Sequence[float]
    median: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SurvivalPanel:
    """The curves on one scenario, by method."""

    title: str
    methods: Mapping[str, SurvivalLine]


def draw_survival(
    shown: Sequence[SurvivalPanel], baseline: str, stem: Path, *, of: str, columns: int = 3
) -> tuple[Path, Path]:
    """Draws survival curves, each with the name of its method and its median at its end.

    Methods that are too many for one panel are drawn in several, with the baseline in each.

    Args:
        shown: A panel for each scenario; at least one.
        baseline: Name of the method that is drawn in grey.
        stem: Path of the files without suffix.
        of: What is found, in the singular.
        columns: Number of panels beside one another.

    Returns:
        The files, SVG and PNG.
    """
    looks = looks_of([method for one in shown for method in one.methods], baseline)
    groups = method_groups(list(looks), baseline)
    labels = {
        method: textwrap.wrap(method, _LABEL_CHARACTERS, break_on_hyphens=False) for method in looks
    }
    lines = max(sum(len(labels[method]) for method in group) for group in groups)
    letters = max(len(line) for label in labels.values() for line in label)
    drawn = [
        (one, here)
        for start in range(0, len(shown), columns)
        for group in groups
        for one in shown[start : start + columns]
        if (here := [method for method in group if method in one.methods])
    ]
    height = max(_PLOT_HEIGHT, _LABEL_LINE * (lines + 1))
    with chart_style():
        figure, axes = panels(
            len(drawn),
            width=_PLOT_WIDTH * _KEY[1] + 0.87 * LETTER * (letters + 5) + _AROUND,
            height=height + _AROUND,
            columns=min(columns, len(shown)),
        )
        line_height = _LABEL_LINE * (_HIGH - _LOW) / height
        for (one, here), panel in zip(drawn, axes, strict=True):
            _draw_panel(panel, one, {method: looks[method] for method in here}, labels, line_height)
        told = (
            f"Repetitions that have not yet found {of}. "
            "After the name: simulations until half of them had"
        )
        width = int(figure.get_figwidth() / LETTER)
        figure.suptitle(textwrap.fill(told, width), fontsize=9, x=0.01, ha="left")
        return write_chart(figure, stem)


def method_groups(methods: Sequence[str], baseline: str) -> list[list[str]]:
    """Divides methods into groups of even size for a panel each, the baseline in every one."""
    first = [baseline] if baseline in methods else []
    others = [method for method in methods if method != baseline]
    count = max(1, -(-len(others) // (MOST_LINES - len(first))))
    size = -(-len(others) // count)
    return [first + others[start : start + size] for start in range(0, len(others), size or 1)] or [
        first
    ]


def spread(wanted: Sequence[float], heights: Sequence[float], high: float) -> list[float]:
    """Moves centres of labels apart so that none touches another.

    Args:
        wanted: Where each should be, ascending.
        heights: The height of each.
        high: Upper end of the last label at most; the lower end of the first may be anywhere.

    Returns:
        The centres, in the same order.
    """
    centres: list[float] = []
    end = float("-inf")
    for centre, height in zip(wanted, heights, strict=True):
        centres.append(max(centre, end + height / 2))
        end = centres[-1] + height / 2
    end = high
    for index in reversed(range(len(centres))):
        centres[index] = min(centres[index], end - heights[index] / 2)
        end = centres[index] - heights[index] / 2
    return centres


def _draw_panel(
    axes: Axes,
    one: SurvivalPanel,
    looks: Mapping[str, Look],
    labels: Mapping[str, Sequence[str]],
    line_height: float,
) -> None:
    last = max(1, *(one.methods[method].at[-1] for method in looks))
    axes.axhline(0.5, color=colors.ROAD_EDGE, lw=0.8, zorder=1.0)
    for place, (method, look) in enumerate(looks.items()):
        line = one.methods[method]
        axes.step(line.at, line.share, where="post", color=look.color, ls=look.line, lw=1.6)
        if line.at[-1] < last:
            ends = (line.share[-1], line.share[-1])
            axes.plot((line.at[-1], last), ends, color=colors.ROAD_EDGE, ls=":", lw=0.8)
        # At other places than those of the other lines, so that they do not hide one another.
        marked = (np.arange(_MARKS) + (place + 0.5) / len(looks)) * last / _MARKS
        marked = marked[marked <= line.at[-1]]
        steps = np.searchsorted(line.at, marked, side="right") - 1
        axes.plot(marked, np.array(line.share)[steps], ls="none", **_marker(look))
    axes.set_xlim(0.0, last)
    axes.set_ylim(_LOW, _HIGH)
    axes.set_title(textwrap.fill(one.title, _TITLE_CHARACTERS))
    axes.set_xlabel("simulations")
    axes.set_ylabel("repetitions without it")
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.grid(visible=True)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))
    _draw_labels(axes, one, looks, labels, line_height)


def _draw_labels(
    axes: Axes,
    one: SurvivalPanel,
    looks: Mapping[str, Look],
    labels: Mapping[str, Sequence[str]],
    line_height: float,
) -> None:
    """Writes each method beside the end of its curve, with a piece of its line."""
    order = sorted(looks, key=lambda method: _end(one.methods[method]))
    centres = spread(
        [one.methods[method].share[-1] for method in order],
        [line_height * len(labels[method]) for method in order],
        _HIGH,
    )
    beside = axes.get_yaxis_transform()
    for method, centre in zip(order, centres, strict=True):
        line, look = one.methods[method], looks[method]
        end = line.share[-1]
        axes.plot(
            (1.005, _KEY[0] - 0.01),
            (end, centre),
            transform=beside,
            color=colors.ROAD_EDGE,
            lw=0.7,
            clip_on=False,
        )
        key: dict[str, Any] = {"transform": beside, "clip_on": False}
        axes.plot(_KEY, (centre, centre), color=look.color, ls=look.line, lw=1.6, **key)
        axes.plot(np.mean(_KEY), centre, **_marker(look), **key)
        median = f">{line.at[-1]}" if line.median is None else str(line.median)
        axes.text(
            _KEY[1] + 0.02,
            centre,
            "\n".join(labels[method]) + f"  {median}",
            transform=beside,
            va="center",
            fontsize=8,
            parse_math=False,
        )


def _marker(look: Look) -> dict[str, Any]:
    return {"marker": look.marker, "color": look.color, "ms": 4.0, "mew": 1.2}


def _end(line: SurvivalLine) -> tuple[float, float]:
    """Returns where a curve ends; of several that end alike the one that fell first is lower."""
    return line.share[-1], sum(
        share * (after - at)
        for share, at, after in zip(line.share, line.at, line.at[1:], strict=False)
    )
