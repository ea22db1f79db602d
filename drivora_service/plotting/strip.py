"""A run as a strip of moments side by side, each around the ego."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Col, Role, Trace
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.violation_marks import Mark, marks_of
from drivora_service.plotting import colors
from drivora_service.plotting.drawn_boxes import draw_box
from drivora_service.plotting.drawn_patches import draw_patches
from drivora_service.plotting.drawn_road import draw_road
from drivora_service.plotting.drawn_signals import draw_signals
from drivora_service.plotting.panel import describe
from drivora_service.plotting.picture_file import add_map, open_picture
from drivora_service.plotting.picture_view import View
from drivora_service.plotting.trails import split_trail

MOST_MOMENTS = 12
_ACCOUNTABILITIES = tuple(Accountability)
_APART_S = 1.0
_TRAIL_S = 3.0
_SIDE_M = 50.0
_SIDE_IN = 2.1
_GAP_IN = 0.08
_TITLE_IN = 0.34
_TITLE_PT = (9.0, 8.0, 7.0, 6.0, 5.0)
"""Sizes of the title's font; the first one that fits is used."""
_CHARACTER = 0.62
"""Mean width of a bold character as a share of the font's size."""
_LINE = 1.2
"""Height of a line as a share of the font's size."""
_FOOT_IN = 0.24


@dataclass(frozen=True, slots=True, kw_only=True)
class Moments:
    """The content of a strip.

    Attributes:
        ego: Row of the ego in the middle of each picture.
        steps: Rows of the trace, ascending.
        mark: The violation at its end, if any.
    """

    ego: int
    steps: tuple[int, ...]
    mark: Mark | None


def choose_moments(
    trace: Trace, verdicts: Sequence[Verdict], count: int, *, shown: Verdict | None = None
) -> Moments:
    """Chooses the most informative moments of a run.

    These are the seconds before its gravest violation, one moment each, the last of them the
    violation itself: one at fault before others, a collision before others, one that was avoidable
    before others, the earliest. If it comes too early for that, the seconds after it follow.
    Without a violation of an oracle that attributes fault: moments at equal distances from the
    first ego's start to its end.

    Args:
        trace: The run.
        verdicts: Verdicts of the oracles.
        count: Number of moments.
        shown: The violation that the moments lead to, one of the verdicts; ``None``: the gravest.

    Raises:
        ValueError: ``count`` is not 2 to 12.
    """
    if not 2 <= count <= MOST_MOMENTS:
        raise ValueError(f"a strip has 2 to {MOST_MOMENTS} moments, not {count}")
    marks = marks_of(verdicts)
    mark = _gravest(marks)
    if shown is not None:
        mark = next(one for one in marks if one.verdict == shown)
    if mark is None or mark.verdict.step is None:
        first, last = _presence(trace, 0)
        steps = np.linspace(first, last, count).round().astype(int)
        return Moments(ego=0, steps=tuple(dict.fromkeys(steps.tolist())), mark=None)
    ego = next(actor.row for actor in trace.actors if actor.id == mark.verdict.ego)
    first, last = _presence(trace, ego)
    violation = min(max(mark.verdict.step, first), last)
    apart = max(round(_APART_S / trace.step_length), 1)
    begin = violation - apart * min(count - 1, (violation - first) // apart)
    wanted = range(begin, begin + apart * count, apart)
    return Moments(ego=ego, steps=tuple(step for step in wanted if step <= last), mark=mark)


def _gravest(marks: Sequence[Mark]) -> Mark | None:
    found = [
        mark
        for mark in marks
        if mark.verdict.step is not None and mark.verdict.at_fault is not None
    ]
    return min(
        found,
        key=lambda mark: (
            not mark.verdict.at_fault,
            mark.verdict.oracle != "collision",
            _ACCOUNTABILITIES.index(accountability(mark.verdict)),
        ),
        default=None,
    )


def draw_strip(
    trace: Trace,
    network: RoadNetwork,
    verdicts: Sequence[Verdict],
    target: Path,
    *,
    count: int = 5,
    shown: Verdict | None = None,
) -> None:
    """Draws a run as moments side by side; the same run yields the same bytes.

    Args:
        trace: The recorded run.
        network: The network of the run.
        verdicts: Verdicts of the oracles.
        target: Path of the file; ends in ``.svg`` or ``.png``.
        count: Number of moments; fewer if the run is too short.
        shown: The violation that determines the moments, one of the verdicts; ``None``: the
            gravest.

    Raises:
        ValueError: The target has another suffix, or ``count`` is not 2 to 12.
    """
    moments = choose_moments(trace, verdicts, count, shown=shown)
    width = len(moments.steps) * (_SIDE_IN + _GAP_IN) + _GAP_IN
    height = _SIDE_IN + _TITLE_IN + _FOOT_IN + _GAP_IN
    with open_picture(target, width_in=width, height_in=height) as figure:
        title, size = fit_title(_title(trace, moments), width - 2.0 * _GAP_IN)
        figure.text(
            _GAP_IN / width,
            1.0 - 0.5 * _TITLE_IN / height,
            title,
            va="center",
            fontsize=size,
            fontweight="bold",
            color=colors.INK if moments.mark is None else colors.VERDICT,
        )
        for place, step in enumerate(moments.steps):
            left = _GAP_IN + place * (_SIDE_IN + _GAP_IN)
            view = _view_around(trace, moments.ego, step)
            axes = add_map(figure, view, left_in=left, bottom_in=_FOOT_IN + _GAP_IN)
            draw_road(axes, network, view)
            draw_patches(axes, trace)
            draw_signals(axes, trace, network, view, step=step)
            _draw_actors(axes, trace, view, step)
            figure.text(left / width, _FOOT_IN / height, _caption(trace, moments.ego, step),
                        va="top", fontsize=8, color=colors.FAINT_INK)  # fmt: skip


def _presence(trace: Trace, ego: int) -> tuple[int, int]:
    """Returns the first and the last row of an ego's part."""
    rows = np.flatnonzero(trace.present[:, ego])
    return int(rows[0]), int(min(rows[-1], trace.ego_end_steps[ego]))


def _view_around(trace: Trace, ego: int, step: int) -> View:
    x, y = trace.states[step, ego, [Col.X, Col.Y]].tolist()
    half = 0.5 * _SIDE_M
    return View(
        min_x=x - half,
        min_y=y - half,
        max_x=x + half,
        max_y=y + half,
        width_in=_SIDE_IN,
        height_in=_SIDE_IN,
    )


def _draw_actors(axes: Axes, trace: Trace, view: View, step: int) -> None:
    """Draws the present actors at a step, and their ways of the last seconds."""
    back = max(step - round(_TRAIL_S / trace.step_length), 0)
    for actor in reversed(trace.actors):
        rows = np.arange(back, step + 1)
        rows = rows[trace.present[back : step + 1, actor.row]]
        if not trace.present[step, actor.row]:
            continue
        path = trace.states[rows, actor.row][:, [Col.X, Col.Y]]
        if not view.touches(path):
            continue
        is_ego = actor.role is Role.EGO
        color = colors.ego_color(actor.row) if is_ego else colors.ROLES[actor.role]
        z = 6.0 if is_ego else 4.4
        if actor.role is not Role.NPC_OBSTACLE:
            trail = split_trail(trace, rows, path)
            axes.plot(*trail.T, color=color, linewidth=1.4, alpha=0.6, zorder=z - 0.5)
        draw_box(axes, trace, actor, step, view, face=color, edge="white", z=z)


def fit_title(text: str, width_in: float) -> tuple[str, float]:
    """Breaks a title into lines of its width, and reduces the font if it is still too high.

    Args:
        text: The title.
        width_in: Maximum width of a line, inches.

    Returns:
        Its lines, and the size of the font in points.
    """
    lines, size = [text], _TITLE_PT[0]
    for size in _TITLE_PT:
        characters = max(int(width_in * 72.0 / (_CHARACTER * size)), 1)
        lines = textwrap.wrap(text, characters) or [""]
        if len(lines) * _LINE * size <= _TITLE_IN * 72.0:
            break
    return "\n".join(lines), size


def _title(trace: Trace, moments: Moments) -> str:
    if moments.mark is not None:
        return describe(moments.mark)
    actor = trace.actors[moments.ego]
    end = trace.ego_ends[actor.row].value.replace("_", " ")
    return f"{actor.id} on {trace.network}: {end}"


def _caption(trace: Trace, ego: int, step: int) -> str:
    vx, vy = trace.states[step, ego, [Col.VX, Col.VY]].tolist()
    return f"{trace.times[step]:.1f} s    {np.hypot(vx, vy):.1f} m/s"
