"""A run seen from above, as SVG or PNG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Trace
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.violation_marks import marks_of
from drivora_service.plotting.drawn_patches import draw_patches
from drivora_service.plotting.drawn_road import draw_road
from drivora_service.plotting.drawn_signals import draw_signals
from drivora_service.plotting.panel import draw_panel, draw_scale_bar
from drivora_service.plotting.picture_file import add_map, open_picture
from drivora_service.plotting.picture_view import view_of_run
from drivora_service.plotting.trails import draw_trails
from drivora_service.plotting.verdict_marks import draw_marks

_PANEL_IN = 2.9
_EDGE_IN = 0.15


def draw_run(
    trace: Trace,
    network: RoadNetwork,
    verdicts: Sequence[Verdict],
    target: Path,
    *,
    color_by: Literal["actor", "time"] = "actor",
) -> None:
    """Draws a run: road, trails, boxes at start and end, signals, violations, legend.

    The same run yields the same bytes.

    Args:
        trace: The recorded run.
        network: The network of the run.
        verdicts: Verdicts of the oracles, of which violations are drawn.
        target: Path of the file; ends in ``.svg`` or ``.png``.
        color_by: Meaning of the colour of the egos' trails.

    Raises:
        ValueError: The target has another suffix.
    """
    view = view_of_run(trace, verdicts)
    marks = marks_of(verdicts)
    width = view.width_in + _PANEL_IN + 3 * _EDGE_IN
    height = view.height_in + 2 * _EDGE_IN
    with open_picture(target, width_in=width, height_in=height) as figure:
        axes = add_map(figure, view, left_in=_EDGE_IN, bottom_in=_EDGE_IN)
        draw_road(axes, network, view)
        draw_patches(axes, trace)
        signals = draw_signals(axes, trace, network, view)
        scale = draw_trails(axes, trace, view, by_time=color_by == "time")
        draw_marks(axes, marks, view)
        draw_scale_bar(axes, view)
        if scale is not None:
            inset = axes.inset_axes((0.7, 0.045, 0.27, 0.022))
            bar = figure.colorbar(scale, cax=inset, orientation="horizontal")
            bar.set_label("time (s)", fontsize=8, labelpad=4)
            bar.ax.xaxis.set_label_position("top")
            bar.ax.tick_params(labelsize=7, length=2)
        panel = figure.add_axes(
            (
                (view.width_in + 2 * _EDGE_IN) / width,
                _EDGE_IN / height,
                _PANEL_IN / width,
                view.height_in / height,
            )
        )
        draw_panel(figure, panel, trace, marks, height_in=view.height_in, signals=signals)
