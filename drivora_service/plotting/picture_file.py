"""Writing of a picture as SVG or PNG; the same content yields the same bytes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from drivora_service.plotting import colors
from drivora_service.plotting.drawn_text import make_texts_plain
from drivora_service.plotting.picture_view import View

_DPI = 150


@contextmanager
def open_picture(target: Path, *, width_in: float, height_in: float) -> Iterator[Figure]:
    """Provides an empty figure and writes it when the block ends without an error.

    Args:
        target: Path of the file; ends in ``.svg`` or ``.png``.
        width_in: Inches.
        height_in: Inches.

    Raises:
        ValueError: The target has another suffix.
    """
    suffix = target.suffix.lower()
    if suffix not in (".svg", ".png"):
        raise ValueError(f"a picture is .svg or .png, not {target.name!r}")
    with mpl.rc_context(
        {"svg.hashsalt": "drivora", "font.family": "DejaVu Sans", "text.color": colors.INK}
    ):
        figure = Figure(figsize=(width_in, height_in), facecolor="white")
        canvas = FigureCanvasSVG(figure) if suffix == ".svg" else FigureCanvasAgg(figure)
        yield figure
        make_texts_plain(figure)
        metadata = {"Date": None, "Creator": None} if suffix == ".svg" else {"Software": None}
        canvas.print_figure(str(target), dpi=_DPI, metadata=metadata)


def add_map(figure: Figure, view: View, *, left_in: float, bottom_in: float) -> Axes:
    """Adds the empty axes of a view's map, with its lower left corner at a place."""
    width, height = figure.get_size_inches()
    axes = figure.add_axes(
        (left_in / width, bottom_in / height, view.width_in / width, view.height_in / height),
        facecolor=colors.GROUND,
    )
    axes.set_xlim(view.min_x, view.max_x)
    axes.set_ylim(view.min_y, view.max_y)
    axes.set_aspect("equal")
    axes.set_autoscale_on(False)
    axes.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    for side in axes.spines.values():
        side.set_color(colors.ROAD_EDGE)
    return axes
