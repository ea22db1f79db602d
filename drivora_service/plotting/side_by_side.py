"""Two runs side by side in one picture, on the same part of the road network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Trace
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.violation_marks import marks_of
from drivora_service.plotting import colors
from drivora_service.plotting.drawn_road import draw_road
from drivora_service.plotting.drawn_signals import draw_signals
from drivora_service.plotting.panel import draw_scale_bar
from drivora_service.plotting.picture_file import add_map, open_picture
from drivora_service.plotting.picture_view import view_of_run
from drivora_service.plotting.strip import fit_title
from drivora_service.plotting.trails import draw_trails
from drivora_service.plotting.verdict_marks import draw_marks

_MAP_WIDTH_IN = 6.2
_EDGE_IN = 0.15
_TITLE_IN = 0.42


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """One of the two runs.

    Attributes:
        title: Text above it.
        trace: The recorded run.
        verdicts: Its verdicts, of which violations are drawn.
    """

    title: str
    trace: Trace
    verdicts: Sequence[Verdict]


def draw_side_by_side(left: Side, right: Side, network: RoadNetwork, target: Path) -> None:
    """Draws two runs on the part of the network that the left one takes place on.

    An ego of both has the same colour in both. The same runs yield the same bytes.

    Args:
        left: The run that determines what is shown.
        right: The other one.
        network: The network of both.
        target: Path of the file; ends in ``.svg`` or ``.png``.

    Raises:
        ValueError: The target has another suffix.
    """
    view = view_of_run(left.trace, left.verdicts)
    scale = _MAP_WIDTH_IN / view.width_in
    view = replace(view, width_in=_MAP_WIDTH_IN, height_in=scale * view.height_in)
    width = 2.0 * view.width_in + 3.0 * _EDGE_IN
    height = view.height_in + 2.0 * _EDGE_IN + _TITLE_IN
    with open_picture(target, width_in=width, height_in=height) as figure:
        turns = {actor.id: actor.row for actor in left.trace.actors}
        for place, side in enumerate((left, right)):
            at = _EDGE_IN + place * (view.width_in + _EDGE_IN)
            axes = add_map(figure, view, left_in=at, bottom_in=_EDGE_IN)
            draw_road(axes, network, view)
            draw_signals(axes, side.trace, network, view)
            draw_trails(axes, side.trace, view, by_time=False, turns=turns)
            draw_marks(axes, marks_of(side.verdicts), view)
            draw_scale_bar(axes, view)
            title, size = fit_title(side.title, view.width_in)
            figure.text(
                at / width,
                1.0 - (0.5 * _TITLE_IN + 0.5 * _EDGE_IN) / height,
                title,
                va="center",
                fontsize=size,
                fontweight="bold",
                color=colors.INK,
            )
