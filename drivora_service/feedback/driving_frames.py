"""How an ego drove, in frames of equal length: hard manoeuvres, over- and understeer.

A frame is a twentieth of a second (the rate of DriveFuzz's recordings), whatever the step length of
the run is. Each frame is judged by the change over the 0.2 s before it, the longest step of a
document, so that recordings with short and with long steps are smoothed alike.

The yaw rate of neutral steering is that of a bicycle whose tyres do not slip (Rajamani, *Vehicle
Dynamics and Control*, 2012, section 2.2), as in ``simulation.motion.vehicle_dynamics``: at the
speed ``v`` of the middle between the axles and the wheel angle ``d``,
``2 v sin(atan(tan(d) / 2)) / wheelbase``.
A vehicle that turns less than its wheels say understeers, one that turns more, or against them,
oversteers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drivora_service.errors import UnknownName
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.ground import wheelbase_of
from drivora_service.observations.trace import Col, EgoCol
from drivora_service.oracles.avoidability.evasion import STEER_RATE
from drivora_service.scenario.models.actor_models import ActorKind, actor_model

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView

FRAME = 0.05
"""Seconds of a frame."""
WINDOW_FRAMES = 4
"""Frames over which a change is measured."""
_MAX_STEER = 0.6
"""Wheel angle of vehicles of unknown model, radians."""
_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrivingFrames:
    """Signals of an ego by frame, (n,) each; n is 0 for a drive shorter than a window.

    Attributes:
        acceleration: Change of the speed over ground, m/s².
        side: Acceleration across the heading, m/s², positive to the left.
        speed: m/s over ground.
        yaw_rate: rad/s.
        neutral: Yaw rate of neutral steering, rad/s.
    """

    acceleration: FloatArray
    side: FloatArray
    speed: FloatArray
    yaw_rate: FloatArray
    neutral: FloatArray


def driving_frames(ego: EgoView) -> DrivingFrames:
    """Returns the signals of an ego's part."""
    window = WINDOW_FRAMES * FRAME
    count = int(ego.duration / FRAME + _ROUNDING) + 1 if ego.count > 1 else 0
    if count <= WINDOW_FRAMES:
        none = np.zeros(0)
        return DrivingFrames(acceleration=none, side=none, speed=none, yaw_rate=none, neutral=none)
    times = ego.times[0] + FRAME * np.arange(count)

    def change(signal: FloatArray) -> FloatArray:
        """Changes per second over the window before each frame."""
        at = np.interp(times, ego.times, signal)
        rate: FloatArray = (at[WINDOW_FRAMES:] - at[:-WINDOW_FRAMES]) / window
        return rate

    east, north = change(ego.states[:, Col.VX]), change(ego.states[:, Col.VY])
    heading = np.unwrap(ego.states[:, Col.YAW])
    middle = np.interp(times[WINDOW_FRAMES:] - 0.5 * window, ego.times, heading)
    return DrivingFrames(
        acceleration=change(ego.speed),
        side=north * elementary.cos(middle) - east * elementary.sin(middle),
        speed=change(np.concatenate(([0.0], np.cumsum(ego.moved[1:])))),
        yaw_rate=change(heading),
        neutral=change(_neutral_heading(ego, heading)),
    )


def _neutral_heading(ego: EgoView, heading: FloatArray) -> FloatArray:
    """Returns the (n,) heading if the ego had turned as its wheels say, from 0 on.

    Where no wheel angle is recorded (poses, SUMO's drivers), it is that of the ego.
    """
    wheels = wheel_angles(ego)
    dt = ego.step_length
    mean = 0.5 * (wheels[1:] + wheels[:-1])
    speed = 0.5 * (ego.forward_speed[1:] + ego.forward_speed[:-1])
    slip = elementary.arctan(0.5 * elementary.tan(mean))
    rate = 2.0 * speed * elementary.sin(slip) / wheelbase_of(ego.actor)
    turned = np.where(np.isnan(rate), np.diff(heading), rate * dt)
    return np.concatenate(([0.0], np.cumsum(turned)))


def wheel_angles(ego: EgoView) -> FloatArray:
    """Returns the (n,) angle of an ego's front wheels, radians; NaN where it is not known.

    Recorded is the angle that the agent asked for; the wheels follow it at a limited rate.
    """
    asked = ego.value(EgoCol.STEER)
    most = STEER_RATE * ego.step_length
    lock = _lock_of(ego.actor.model)
    angles = np.full(ego.count, math.nan)
    angle = 0.0
    for k, wanted in enumerate(asked.tolist()):
        angles[k] = angle
        if not math.isnan(wanted):
            angle += min(max(min(max(wanted, -lock), lock) - angle, -most), most)
        elif k + 1 < ego.count:
            # Only in the last row there is no command any more.
            angles[k], angle = math.nan, 0.0
    return angles


def _lock_of(model: str) -> float:
    try:
        return actor_model(ActorKind.VEHICLE, model).max_steer
    except UnknownName:
        return _MAX_STEER
