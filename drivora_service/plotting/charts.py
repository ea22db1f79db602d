"""Common parts of charts: styles of methods, panels side by side, and writing as SVG and PNG."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from drivora_service.plotting import colors
from drivora_service.plotting.drawn_text import make_texts_plain

LETTER = 0.075
"""Approximate width of a letter, inches."""
_DPI = 150
_STYLE = {
    "svg.hashsalt": "drivora",
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "text.color": colors.INK,
    "axes.labelcolor": colors.INK,
    "axes.edgecolor": colors.ROAD_EDGE,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.color": colors.FAINT_INK,
    "ytick.color": colors.FAINT_INK,
    "grid.color": "#e3e6e9",
    "grid.linewidth": 0.8,
}
_LINES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))
_MARKERS = ("o", "s", "^", "D", "v", "P")

LineStyle = str | tuple[float, tuple[float, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """The style of a method: colour, line and marker, each distinctive where possible."""

    color: str
    line: LineStyle
    marker: str


def looks_of(methods: Sequence[str], baseline: str) -> dict[str, Look]:
    """Returns the style of each method: the baseline, first, is grey, the others have colours."""
    looks: dict[str, Look] = {}
    if baseline in methods:
        looks[baseline] = Look(color=colors.FAINT_INK, line=(0, (2.5, 1.2)), marker="x")
    others = [method for method in dict.fromkeys(methods) if method != baseline]
    for index, method in enumerate(others):
        looks[method] = Look(
            color=colors.METHODS[index % len(colors.METHODS)],
            # Other lines for the methods for which there are no more colours.
            line=_LINES[(index + index // len(colors.METHODS)) % len(_LINES)],
            marker=_MARKERS[index % len(_MARKERS)],
        )
    return looks


@contextmanager
def chart_style() -> Iterator[None]:
    """Draws charts in the style of the pictures."""
    with mpl.rc_context(_STYLE):  # type: ignore[arg-type] # keys are those of rcParams
        yield


def panels(
    count: int, *, width: float = 4.6, height: float = 3.3, columns: int = 3
) -> tuple[Figure, list[Axes]]:
    """Returns a figure with ``count`` panels.

    Args:
        count: At least 1.
        width: Inches of one panel.
        height: Inches of one panel.
        columns: Greatest number of panels beside one another.
    """
    columns = min(count, columns)
    rows = -(-count // columns)
    figure = Figure(
        figsize=(columns * width, rows * height), facecolor="white", layout="constrained"
    )
    axes = figure.subplots(rows, columns, squeeze=False).ravel().tolist()
    for unused in axes[count:]:
        unused.set_axis_off()
    return figure, axes[:count]


def legend_below(figure: Figure, looks: dict[str, Look]) -> None:
    """Adds a legend below all panels, and enlarges the figure for it."""
    handles = [
        Line2D([], [], color=look.color, ls=look.line, lw=2.0, label=method)
        for method, look in looks.items()
    ]
    entry = LETTER * max(map(len, looks)) + 0.75
    columns = min(len(handles), max(1, int(figure.get_figwidth() // entry)))
    figure.set_figheight(figure.get_figheight() + 0.2 * -(-len(handles) // columns))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns,
        frameon=False,
        handlelength=2.6,
    )


def write_chart(figure: Figure, stem: Path) -> tuple[Path, Path]:
    """Writes a figure as ``STEM.svg`` and ``STEM.png``; the same figure yields the same bytes."""
    make_texts_plain(figure)
    svg, png = stem.with_name(f"{stem.name}.svg"), stem.with_name(f"{stem.name}.png")
    FigureCanvasSVG(figure).print_figure(str(svg), metadata={"Date": None, "Creator": None})
    FigureCanvasAgg(figure).print_figure(str(png), dpi=_DPI, metadata={"Software": None})
    return svg, png
