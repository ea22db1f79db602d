"""Execution of decisions: IDM along the route or beside it, in every step.

Treiber, Hennecke, Helbing: Congested traffic states in empirical observations and microscopic
simulations (Phys. Rev. E 62, 2000); Coulter: Implementation of the pure pursuit path tracking
algorithm (1992). Plain Python: those of `idm` are compiled, for which this environment has
no compiler.
"""

from __future__ import annotations

import math

from drivora_service.agents.adapters.dilu.road import RouteFrame
from drivora_service.agents.adapters.dilu.surroundings import Surroundings
from drivora_service.agents.interface import AccelerationControl
from drivora_service.agents.remote.views import VehicleView

_ACCELERATION, _BRAKING = 1.5, 2.0
_HEADWAY, _STANDSTILL = 1.2, 2.0
"""Headway to the actor ahead: seconds and metres."""

_LINE_GAP = 1.0
"""Metres before a light's line or a crossed way at standstill."""

_LOOK_AHEAD, _LEAST_LOOK_AHEAD = 0.9, 4.0
"""Seconds and metres."""

_SIDEWAYS = 1.2
"""Lateral speed of a lane change, m/s."""


def idm_acceleration(
    speed: float, wanted: float, *, gap: float = math.inf, lead: float = 0.0, standstill: float
) -> float:
    """Returns the acceleration of the intelligent driver model, m/s².

    Args:
        speed: m/s.
        wanted: m/s.
        gap: Metres to the actor ahead.
        lead: Speed of the actor ahead, m/s.
        standstill: Metres to keep at standstill.
    """
    if wanted <= 0.1:
        free = -_BRAKING
    elif speed > wanted:
        # Above the desired speed, the model's braking grows with the fourth power.
        free = -_BRAKING * min(1.0, speed - wanted)
    else:
        free = _ACCELERATION * (1.0 - (speed / wanted) ** 4)
    if not math.isfinite(gap):
        return free
    dynamic = speed * _HEADWAY + speed * (speed - lead) / (
        2.0 * math.sqrt(_ACCELERATION * _BRAKING)
    )
    desired = standstill + max(0.0, dynamic)
    return min(free, _ACCELERATION - _ACCELERATION * (desired / max(gap, 0.1)) ** 2)


def drive(
    around: Surroundings,
    frame: RouteFrame,
    vehicle: VehicleView,
    *,
    wanted: float,
    offset: float,
    stop: float | None,
) -> AccelerationControl:
    """Returns the control of this step.

    Args:
        around: The vehicle and other actors.
        frame: Frame of the route.
        vehicle: The driven vehicle.
        wanted: Decided speed, m/s; limit and bends always apply.
        offset: d of the decided lane.
        stop: Metres to a light to stop for.
    """
    speed = around.speed
    fastest = min(wanted, frame.allowed_speed(around.s, speed))
    low, high = min(around.d, offset), max(around.d, offset)
    accelerations = [idm_acceleration(speed, fastest, standstill=_STANDSTILL)]
    lead = around.ahead(low, high)
    if lead is not None:
        accelerations.append(
            idm_acceleration(speed, fastest, gap=lead.gap, lead=lead.speed, standstill=_STANDSTILL)
        )
    accelerations += [
        idm_acceleration(speed, fastest, gap=halt, standstill=_LINE_GAP)
        for halt in (stop, around.crossing_distance(low, high))
        if halt is not None
    ]
    return AccelerationControl(
        max(min(accelerations), -vehicle.max_deceleration),
        _steer(around, frame, vehicle, offset),
    )


def _steer(around: Surroundings, frame: RouteFrame, vehicle: VehicleView, offset: float) -> float:
    """Returns the wheel angle of pure pursuit, for the rear axle, radians."""
    ahead = max(_LOOK_AHEAD * around.speed, _LEAST_LOOK_AHEAD)
    sideways = _SIDEWAYS * ahead / max(around.speed, 3.0)
    d = around.d + min(max(offset - around.d, -sideways), sideways)
    x, y = frame.point(around.s, around.d)
    yaw = frame.heading(around.s) + around.turn
    back = 0.5 * vehicle.wheelbase
    x, y = x - back * math.cos(yaw), y - back * math.sin(yaw)
    to_x, to_y = frame.point(around.s + ahead, d)
    bearing = math.atan2(to_y - y, to_x - x) - yaw
    distance = math.hypot(to_x - x, to_y - y)
    angle = math.atan2(2.0 * vehicle.wheelbase * math.sin(bearing), max(distance, 1.0))
    return min(max(angle, -vehicle.max_steer), vehicle.max_steer)
