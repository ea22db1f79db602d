"""Actors as boxes on the map."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from drivora_service.geometry.outlines import box_corners
from drivora_service.observations.trace import Actor, Col, Trace
from drivora_service.plotting.picture_view import View

_SMALLEST_BOX_IN = 0.075


def draw_box(
    axes: Axes,
    trace: Trace,
    actor: Actor,
    step: int,
    view: View,
    *,
    face: str,
    edge: str,
    z: float,
) -> None:
    """Draws an actor at a step; one too small to be visible is drawn larger."""
    state = trace.states[step, actor.row]
    grow = max(1.0, _SMALLEST_BOX_IN * view.metres_an_inch / actor.width)
    corners = box_corners(
        state[None, Col.X],
        state[None, Col.Y],
        state[None, Col.YAW],
        grow * actor.length,
        grow * actor.width,
    )[0]
    axes.add_patch(
        Polygon(corners, closed=True, facecolor=face, edgecolor=edge, linewidth=1.1, zorder=z)
    )
