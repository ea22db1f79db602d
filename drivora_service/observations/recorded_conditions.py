"""The grip of the road and the range of perception during a run, as its trace records them.

Both follow the weather, which may change during a run; patches are slippery from its beginning to
its end. The lower coefficient counts: that of the place, or that of the weather at the time.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.ground import frictions_along, patch_array, wheelbase_of
from drivora_service.observations.trace import Actor, Col, Trace

FRICTION = "friction"
"""Entries of ``Trace.meta``: at the beginning of the run; and of each change."""
PERCEPTION_RANGE = "perception_range"
CHANGES_KEY = "weather_changes"
"""Entry of ``Trace.meta``, with the step of each change; missing where there are none."""
PATCHES_KEY = "friction_patches"
"""Entry of ``Trace.meta``; missing where there are none."""


def road_frictions(trace: Trace, first: int, count: int) -> FloatArray:
    """Returns the (count,) friction coefficients of the road beside patches, from a row on.

    NaN if they are not recorded. Rows after the last one are as that.
    """
    return _values(trace, FRICTION, first, count, unknown=math.nan)


def perception_ranges(trace: Trace, first: int, count: int) -> FloatArray:
    """Returns the (count,) ranges of perception from a row on, metres; infinite if not recorded."""
    return _values(trace, PERCEPTION_RANGE, first, count, unknown=math.inf)


def trace_patches(trace: Trace) -> FloatArray:
    """Returns the (P, 8) patches of a run, columns ``ground.PatchCol``."""
    return patch_array(trace.meta.get(PATCHES_KEY, ()))


def frictions_under(trace: Trace, actor: Actor, first: int, states: FloatArray) -> FloatArray:
    """Returns the (n,) friction coefficients that a vehicle had; NaN if they are not recorded.

    Args:
        trace: The run.
        actor: The vehicle.
        first: Row of the trace with the first of the states.
        states: (n, 9) of it in consecutive rows, columns ``Col``.
    """
    road = road_frictions(trace, first, len(states))
    if trace.meta.get(FRICTION) is None:
        return road
    poses = states[:, [Col.X, Col.Y, Col.YAW]]
    return frictions_along(poses, states[:, Col.Z], wheelbase_of(actor), road, trace_patches(trace))


def _values(trace: Trace, name: str, first: int, count: int, *, unknown: float) -> FloatArray:
    start = trace.meta.get(name)
    values: FloatArray = np.full(count, unknown if start is None else float(start))
    for change in trace.meta.get(CHANGES_KEY, ()):
        values[max(change["step"] - first, 0) :] = change[name]
    return values
