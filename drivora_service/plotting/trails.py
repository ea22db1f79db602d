"""The trails of actors, and their places at the start and at the end."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.patheffects import Normal, Stroke
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Actor, Col, Role, Trace
from drivora_service.plotting import colors
from drivora_service.plotting.drawn_boxes import draw_box
from drivora_service.plotting.picture_view import View

_TIME_MARKS = 6

_FASTEST = 100.0
"""m/s; an actor that moves faster in a step has re-entered at another place."""

RowArray = NDArray[np.signedinteger]
"""Row numbers of a trace."""


def draw_trails(
    axes: Axes,
    trace: Trace,
    view: View,
    *,
    by_time: bool,
    turns: Mapping[str, int] = MappingProxyType({}),
) -> ScalarMappable | None:
    """Draws trails and boxes of all actors; egos last, on top.

    Args:
        axes: Axes of the view's map.
        trace: The recorded run.
        view: The part of the plane that is shown.
        by_time: Whether the egos' trails are coloured by time rather than by ego.
        turns: Turns of egos among the colours, by their ids; those of others are their rows.

    Returns:
        The colour scale of a picture by time.
    """
    scale = (
        ScalarMappable(Normalize(float(trace.times[0]), float(trace.times[-1])), "viridis")
        if by_time
        else None
    )
    for actor in reversed(trace.actors):
        rows = np.flatnonzero(trace.present[:, actor.row])
        if actor.role is Role.EGO:
            rows = rows[rows <= trace.ego_end_steps[actor.row]]
        if len(rows) == 0:
            continue
        path = trace.states[rows, actor.row][:, [Col.X, Col.Y]]
        if not view.touches(path):
            continue
        if actor.role is Role.EGO:
            color = colors.ego_color(turns.get(actor.id, actor.row))
            _draw_ego(axes, trace, actor, rows, view, scale, color)
        else:
            _draw_other(axes, trace, actor, rows, view)
    return scale


def _draw_ego(
    axes: Axes,
    trace: Trace,
    actor: Actor,
    rows: RowArray,
    view: View,
    scale: ScalarMappable | None,
    color: str,
) -> None:
    path = trace.states[rows, actor.row][:, [Col.X, Col.Y]]
    route = trace.ego_routes[actor.row]
    axes.plot(*route.line.T, color=color, linewidth=1.0, linestyle=(0, (1, 2)), zorder=3.0)
    segments = np.stack((path[:-1], path[1:]), axis=1)
    moved = ~entries(trace, rows, path)[1:]
    segments = segments[moved]
    trail = LineCollection(list(segments), linewidths=2.6, capstyle="round", zorder=5.0)
    if scale is None:
        trail.set_color(color)
    else:
        trail.set_color(list(scale.to_rgba(trace.times[rows[:-1]][moved])))
    axes.add_collection(trail)
    axes.plot(
        *route.goal,
        marker="*",
        markersize=13,
        color=color,
        markeredgecolor="white",
        markeredgewidth=0.8,
        linestyle="none",
        zorder=6.5,
    )
    first, last = int(rows[0]), int(rows[-1])
    draw_box(axes, trace, actor, first, view, face="white", edge=color, z=6.0)
    draw_box(axes, trace, actor, last, view, face=color, edge="white", z=6.2)
    _draw_times(axes, trace, path, rows, color)


def _draw_other(axes: Axes, trace: Trace, actor: Actor, rows: RowArray, view: View) -> None:
    color = colors.ROLES[actor.role]
    path = trace.states[rows, actor.row][:, [Col.X, Col.Y]]
    quiet = actor.role is Role.BACKGROUND
    if actor.role is not Role.NPC_OBSTACLE:
        trail = split_trail(trace, rows, path)
        axes.plot(*trail.T, color=color, linewidth=0.8 if quiet else 1.5, alpha=0.75, zorder=4.0)
        if not quiet:
            draw_box(axes, trace, actor, int(rows[0]), view, face="white", edge=color, z=4.2)
    draw_box(axes, trace, actor, int(rows[-1]), view, face=color, edge="white", z=4.4)


def entries(trace: Trace, rows: RowArray, path: FloatArray) -> NDArray[np.bool_]:
    """Finds the rows in which an actor enters the road, for the first time or again.

    Args:
        trace: The trace with the actor.
        rows: (n,) rows in which it is present, ascending.
        path: (n, 2) its places there.

    Returns:
        (n,) whether it enters in that row: it was absent before, or has jumped.
    """
    jumped = np.hypot(*np.diff(path, axis=0).T) > _FASTEST * trace.step_length
    return np.concatenate(([True], (np.diff(rows) > 1) | jumped))


def split_trail(trace: Trace, rows: RowArray, path: FloatArray) -> FloatArray:
    """Returns a path with a row of NaN, which interrupts a line, before every further entry."""
    breaks = np.flatnonzero(entries(trace, rows, path))[1:]
    return np.insert(path, breaks, np.nan, axis=0)


def _draw_times(axes: Axes, trace: Trace, path: FloatArray, rows: RowArray, color: str) -> None:
    duration = float(trace.times[rows[-1]] - trace.times[rows[0]])
    interval = next((i for i in (1, 2, 5, 10, 20, 30, 60) if duration / i <= _TIME_MARKS), 120)
    times = trace.times[rows]
    first = np.ceil(float(times[0]) / interval) * interval
    for moment in np.arange(first if first > times[0] else first + interval, times[-1], interval):
        x, y = path[int(np.searchsorted(times, moment - 1e-9))]
        axes.plot(
            x, y, marker="o", markersize=3.6, color="white", markeredgecolor=color, zorder=5.5
        )
        axes.annotate(
            f"{moment:.0f} s",
            (x, y),
            xytext=(6, 5),
            textcoords="offset points",
            fontsize=7,
            color=color,
            zorder=7.0,
            annotation_clip=True,
            path_effects=[Stroke(linewidth=2.2, foreground="white"), Normal()],
        )
