"""Signals of an ego's own motion, and of the signal ahead of it."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.recorded_signals import off_route
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, EgoCol, Light


def acceleration(ego: EgoView) -> FloatArray:
    """Returns the (n,) acceleration along the heading, m/s²."""
    yaw = ego.states[:, Col.YAW]
    cos, sin = elementary.cos(yaw), elementary.sin(yaw)
    along: FloatArray = ego.states[:, Col.AX] * cos + ego.states[:, Col.AY] * sin
    return along


def speed_limit(ego: EgoView) -> FloatArray:
    """Returns the (n,) speed limit of its lane, m/s; NaN off all lanes."""
    return ego.value(EgoCol.SPEED_LIMIT)


def light_distance(ego: EgoView) -> FloatArray:
    """Returns the (n,) metres to the stop line of the next signal; NaN without one."""
    return np.where(off_route(ego), np.nan, ego.value(EgoCol.LIGHT_DISTANCE))


def shows_light(ego: EgoView, state: Light) -> FloatArray:
    """Returns the (n,) rows in which the next signal of the route shows a state."""
    shown: FloatArray = ((ego.lights == state) & ~off_route(ego)).astype(np.float64)
    return shown
