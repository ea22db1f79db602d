"""Polylines with points that are close enough to tell headings and bends."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths

SPACING = 1.0
"""Metres between two points of a sampled line, at most."""

_SAME = 1e-6
"""Metres up to which two points are one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledLine:
    """A polyline with its headings and bends.

    Attributes:
        line: (n, 2) metres.
        arc: (n,) arc length, metres.
        yaw: (n,) unwrapped heading, radians.
        bend: (n,) curvature, 1/m, not negative.
    """

    line: FloatArray
    arc: FloatArray
    yaw: FloatArray
    bend: FloatArray


def distinct_points(line: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Returns a polyline (n, 2) without points that repeat the one before, and its arc lengths."""
    arc = arc_lengths(line)
    keep = np.concatenate(([True], np.diff(arc) > _SAME))
    return line[keep], arc[keep]


def sample_line(line: FloatArray, arc: FloatArray) -> SampledLine:
    """Returns a polyline with further points, at most ``SPACING`` apart.

    Args:
        line: (n, 2) distinct points, n >= 2, metres.
        arc: (n,) their arc lengths, metres.
    """
    fine = np.union1d(arc, np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / SPACING) + 1)))
    fine = fine[np.concatenate(([True], np.diff(fine) > _SAME))]
    x, y = np.interp(fine, arc, line[:, 0]), np.interp(fine, arc, line[:, 1])
    yaw = np.unwrap(elementary.arctan2(np.gradient(y, fine), np.gradient(x, fine)))
    bend = np.abs(np.gradient(yaw, fine))
    return SampledLine(line=np.column_stack((x, y)), arc=fine, yaw=yaw, bend=bend)
