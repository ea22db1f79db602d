"""Filtered motion of a vehicle in its own frame, for bounds of comfort.

Savitzky-Golay filters of order 2 as in nuPlan's and Bench2Drive's comfort metrics: about 8 samples
for accelerations and 15 for derivatives at 20 Hz, kept as durations for other step lengths. Unlike
in Bench2Drive's public code, yaw acceleration is the derivative of the yaw rate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.local_polynomials import slopes, smooth
from drivora_service.observations.own_frame import own_acceleration
from drivora_service.observations.trace import Col

SMOOTHING_TIME = 0.4
"""Duration of the filter for accelerations and rates, seconds."""

DERIVATIVE_TIME = 0.75
"""Duration of the filter for their derivatives, seconds."""

_ORDER = 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FilteredMotion:
    """Signals (n,) of a vehicle, in its own frame.

    Attributes:
        longitudinal_acceleration: m/s², positive forwards.
        lateral_acceleration: m/s², positive to the left.
        yaw_rate: rad/s.
        yaw_acceleration: rad/s².
        longitudinal_jerk: m/s³.
        jerk: Rate of change of the magnitude of the acceleration, m/s³.
    """

    longitudinal_acceleration: FloatArray
    lateral_acceleration: FloatArray
    yaw_rate: FloatArray
    yaw_acceleration: FloatArray
    longitudinal_jerk: FloatArray
    jerk: FloatArray


def filter_motion(states: FloatArray, step_length: float) -> FilteredMotion | None:
    """Filters the motion of a vehicle.

    Args:
        states: (n, 9) columns ``Col``, without gaps.
        step_length: Seconds between the rows.

    Returns:
        None if there are fewer rows than the longest filter needs.
    """
    smoothing = max(round(SMOOTHING_TIME / step_length), _ORDER + 1)
    derivative = max(round(DERIVATIVE_TIME / step_length), _ORDER + 1)
    if len(states) < max(smoothing, derivative):
        return None
    along, across = own_acceleration(states)
    ax, ay = states[:, Col.AX], states[:, Col.AY]
    own = np.stack((along, across, states[:, Col.YAW_RATE]))
    longitudinal, lateral, yaw_rate = smooth(own, smoothing)
    rising = np.stack((along, np.hypot(ax, ay), states[:, Col.YAW_RATE]))
    longitudinal_jerk, jerk, yaw_acceleration = slopes(rising, derivative, step_length)
    return FilteredMotion(
        longitudinal_acceleration=longitudinal,
        lateral_acceleration=lateral,
        yaw_rate=yaw_rate,
        longitudinal_jerk=longitudinal_jerk,
        jerk=jerk,
        yaw_acceleration=yaw_acceleration,
    )
