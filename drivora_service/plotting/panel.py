"""The column beside the map: run, legend and violations."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from drivora_service.observations.trace import Light, Role, Trace
from drivora_service.oracles.verdicts.accountability import IN_WORDS, accountability
from drivora_service.oracles.verdicts.violation_marks import Mark
from drivora_service.plotting import colors
from drivora_service.plotting.drawn_patches import patch_entry
from drivora_service.plotting.picture_view import View

Handle = Line2D | Patch | tuple[Line2D, ...]

_ROLE_NAMES = {
    Role.NPC_VEHICLE: "NPC vehicle",
    Role.NPC_WALKER: "walker",
    Role.NPC_OBSTACLE: "obstacle",
    Role.BACKGROUND: "background traffic",
}
_MOST_EGOS = 6
_MOST_MARKS = 12
_LINE = 0.2
"""Inches from one line of text to the next."""


def draw_panel(
    figure: Figure,
    axes: Axes,
    trace: Trace,
    marks: Sequence[Mark],
    *,
    height_in: float,
    signals: bool,
) -> None:
    """Fills an empty pair of axes of ``height_in`` inches with legend and list."""
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(-height_in, 0.0)
    axes.text(0.0, -0.05, trace.network, va="top", fontsize=13, fontweight="bold")
    facts = f"{trace.times[-1]:.1f} s, {trace.step_count} steps of {trace.step_length * 1e3:.0f} ms"
    axes.text(0.0, -0.32, facts, va="top", fontsize=8.5, color=colors.FAINT_INK)
    handles, labels = zip(*_entries(trace, signals=signals), strict=True)
    legend = axes.legend(
        handles,
        labels,
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.2)},
        loc="upper left",
        bbox_to_anchor=(0.0, 1.0 - 0.52 / height_in),
        borderaxespad=0.0,
        borderpad=0.0,
        frameon=False,
        fontsize=8.5,
        handlelength=1.9,
        labelspacing=0.45,
    )
    figure.draw_without_rendering()
    bottom = legend.get_window_extent().transformed(axes.transData.inverted()).y0
    _list_marks(axes, marks, float(bottom) - 0.3, -height_in)


def _entries(trace: Trace, *, signals: bool) -> list[tuple[Handle, str]]:
    entries: list[tuple[Handle, str]] = []
    for actor in trace.actors[: trace.ego_count][:_MOST_EGOS]:
        end = trace.ego_ends[actor.row].value.replace("_", " ")
        line = Line2D([], [], color=colors.ego_color(actor.row), lw=2.6)
        entries.append((line, f"{actor.id}: {end}"))
    ink = colors.FAINT_INK
    entries += [
        (Line2D([], [], color=ink, lw=1.0, ls=(0, (1, 2))), "planned route"),
        (Line2D([], [], color=ink, marker="*", ms=10, ls="none"), "destination"),
        (Patch(facecolor="white", edgecolor=ink), "at the start"),
        (Patch(facecolor=ink, edgecolor="white"), "at the end"),
    ]
    present = {actor.role for actor in trace.actors}
    entries += [
        (Patch(facecolor=colors.ROLES[role]), name)
        if role is Role.NPC_OBSTACLE
        else (Line2D([], [], color=colors.ROLES[role], lw=1.6), name)
        for role, name in _ROLE_NAMES.items()
        if role in present
    ]
    if (slippery := patch_entry(trace)) is not None:
        entries.append(slippery)
    if signals:
        lights = (Light.RED, Light.YELLOW, Light.GREEN)
        bars = tuple(Line2D([], [], color=colors.LIGHTS[light], lw=3.2) for light in lights)
        entries.append((bars, "signal as the first ego crossed it"))
    return entries


def _list_marks(axes: Axes, marks: Sequence[Mark], top: float, bottom: float) -> None:
    if not marks:
        axes.text(0.0, top, "No violation", va="top", fontsize=10, fontweight="bold")
        return
    axes.text(0.0, top, "Violations", va="top", fontsize=10, fontweight="bold")
    y = top - 0.27
    for shown, mark in enumerate(marks):
        lines = textwrap.wrap(describe(mark), 41)
        rest = len(marks) - shown
        if shown == _MOST_MARKS or y - _LINE * (len(lines) + 1) < bottom:
            axes.text(0.0, y, f"and {rest} more", va="top", fontsize=8.5)
            return
        axes.text(
            0.0,
            y,
            str(mark.number),
            va="top",
            fontsize=8.5,
            fontweight="bold",
            color=colors.VERDICT,
        )
        axes.text(0.09, y, "\n".join(lines), va="top", fontsize=8.5, linespacing=1.25)
        y -= _LINE * 0.82 * len(lines) + 0.07


def describe(mark: Mark) -> str:
    """Returns a violation in one line: oracle, ego, counterpart, time and fault."""
    verdict = mark.verdict
    parts = [f"{verdict.oracle.replace('_', ' ')}: {verdict.ego}"]
    if verdict.counterpart:
        parts.append(f"with {verdict.counterpart}")
    if verdict.time is not None:
        parts.append(f"at {verdict.time:.1f} s")
    text = " ".join(parts)
    if words := IN_WORDS[accountability(verdict)]:
        text += f", {words}"
    return text


def draw_scale_bar(axes: Axes, view: View) -> None:
    """Draws a bar of a round number of metres in the lower left corner of the map."""
    target = 1.5 * view.metres_an_inch
    length = max((m * 10**e for e in range(5) for m in (1, 2, 5) if m * 10**e <= target), default=1)
    x = view.min_x + 0.2 * view.metres_an_inch
    y = view.min_y + 0.2 * view.metres_an_inch
    tick = 0.05 * view.metres_an_inch
    axes.plot(
        [x, x, x + length, x + length],
        [y + tick, y, y, y + tick],
        color=colors.INK,
        linewidth=1.4,
        zorder=9.0,
    )
    axes.text(
        x + 0.5 * length,
        y + tick,
        f"{length} m",
        ha="center",
        va="bottom",
        fontsize=8,
        color=colors.INK,
        zorder=9.0,
    )
