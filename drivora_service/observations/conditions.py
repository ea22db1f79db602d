"""The road's friction and the range of perception during a run, as its trace records them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.observations.trace import Trace

FRICTION = "friction"
PERCEPTION_RANGE = "perception_range"


def friction_of(trace: Trace, row: int) -> float | None:
    """Returns the friction coefficient of the road at a row of a trace; ``None``: not recorded."""
    return _value(trace, FRICTION, row)


def perception_range_of(trace: Trace, row: int) -> float:
    """Returns the range of perception at a row of a trace, metres; infinite if not recorded."""
    found = _value(trace, PERCEPTION_RANGE, row)
    return math.inf if found is None else found


def frictions(trace: Trace, first: int, count: int) -> FloatArray:
    """Returns the (count,) friction coefficients from a row on; NaN where not recorded."""
    start = friction_of(trace, -1)
    values: FloatArray = np.full(count, np.nan if start is None else start)
    for change in _changes(trace):
        values[max(change["step"] - first, 0) :] = change[FRICTION]
    return values


def _value(trace: Trace, name: str, row: int) -> float | None:
    value = trace.meta.get(name)
    for change in _changes(trace):
        if change["step"] <= row:
            value = change[name]
    return None if value is None else float(value)


def _changes(trace: Trace) -> tuple[Mapping[str, Any], ...]:
    """Returns the changes of the weather, in the order of their steps."""
    return tuple(trace.meta.get("weather_changes", ()))
