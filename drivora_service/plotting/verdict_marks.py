"""Numbered marks of violations on the map, for the list beside it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdicts.violation_marks import Mark
from drivora_service.plotting import colors
from drivora_service.plotting.picture_view import View

_BADGE_IN = 0.24


def draw_marks(axes: Axes, marks: Sequence[Mark], view: View) -> None:
    """Draws a cross at each violation and its number beside it, the numbers side by side."""
    taken: list[FloatArray] = []
    badge = _BADGE_IN * view.metres_an_inch
    for mark in marks:
        if mark.verdict.location is None:
            continue
        place = np.array(mark.verdict.location)
        axes.plot(
            *place,
            marker="X",
            markersize=9,
            color=colors.VERDICT,
            markeredgecolor="white",
            markeredgewidth=1.0,
            linestyle="none",
            zorder=8.0,
        )
        seat = place + np.array([1.2 * badge, 1.2 * badge])
        while any(np.hypot(*(seat - other)) < badge for other in taken):
            seat = seat + np.array([1.02 * badge, 0.0])
        taken.append(seat)
        axes.plot(*zip(place, seat, strict=True), color=colors.VERDICT, linewidth=0.9, zorder=7.9)
        axes.text(
            float(seat[0]),
            float(seat[1]),
            str(mark.number),
            ha="center",
            va="center",
            fontsize=8.5,
            fontweight="bold",
            color="white",
            zorder=8.2,
            bbox={
                "boxstyle": "circle,pad=0.22",
                "facecolor": colors.VERDICT,
                "edgecolor": "white",
                "linewidth": 0.8,
            },
        )
