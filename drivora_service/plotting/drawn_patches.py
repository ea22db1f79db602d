"""Slippery patches on the map."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Polygon

from drivora_service.geometry.outlines import box_corners
from drivora_service.observations.recorded_conditions import PATCHES_KEY
from drivora_service.observations.trace import Trace
from drivora_service.plotting import colors

_COLUMNS = ("x", "y", "yaw", "length", "width")


def draw_patches(axes: Axes, trace: Trace) -> None:
    """Draws the outlines of a run's patches, hatched, over the road and under the actors."""
    for patch in trace.meta.get(PATCHES_KEY, ()):
        corners = box_corners(*(np.array([float(patch[name])]) for name in _COLUMNS))[0]
        shape = Polygon(corners, closed=True, zorder=2.4)
        _style(shape)
        axes.add_patch(shape)


def patch_entry(trace: Trace) -> tuple[Patch, str] | None:
    """Returns the patches' entry of the legend; ``None`` without patches."""
    frictions = sorted({float(patch["friction"]) for patch in trace.meta.get(PATCHES_KEY, ())})
    if not frictions:
        return None
    least, most = frictions[0], frictions[-1]
    value = f"{least:.2g}" if least == most else f"{least:.2g} to {most:.2g}"
    sample = Patch()
    _style(sample)
    return sample, f"slippery, friction {value}"


def _style(shape: Patch) -> None:
    shape.set(
        facecolor=colors.PATCH,
        edgecolor=colors.PATCH_EDGE,
        hatch="////",
        linewidth=0.8,
        alpha=0.75,
    )
