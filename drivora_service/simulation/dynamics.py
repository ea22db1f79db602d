"""How a vehicle under an agent's control moves: kinematic and dynamic bicycle, friction-limited.

The kinematic model (Rajamani, *Vehicle Dynamics and Control*, 2012, section 2.2) turns about the
box centre; the tyres limit it: braking and driving to the friction circle, the yaw rate to what
lateral grip is left, so that a bend taken too fast is left on a wider arc. The dynamic model adds
lateral velocity and yaw inertia with a saturating tyre (Pacejka's formula with B = 10, C = 1.9,
D = mu, the usual figures for a dry road), so that a vehicle can skid; below 4 m/s, where slip
angles are not defined, it falls back to the kinematic model.

Rows of ``bodies`` are egos; all arrays are changed in place. SI units, radians.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from drivora_service.compilation import compiled

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

GRAVITY = 9.81
STEER_RATE = 0.7
"""Front-wheel angle a second that the steering reaches, rad/s: a steering wheel at 600 degrees a
second through a ratio of 15."""
SLIDE_SLOPE = 0.7
"""A pose is reached sideways by at most this many metres a metre driven (35 degrees of wheel)."""
_SUBSTEPS = 5
_DYNAMIC_FROM_SPEED = 4.0
_TYRE_B = 10.0
_TYRE_C = 1.9


class Body(IntEnum):
    """Columns of ``bodies``."""

    X = 0
    Y = 1
    YAW = 2
    SPEED = 3
    SIDE_SPEED = 4
    YAW_RATE = 5
    STEER = 6
    ACCELERATION = 7
    HEIGHT = 8


class Limit(IntEnum):
    """Columns of ``limits``."""

    WHEELBASE = 0
    MAX_ACCELERATION = 1
    MAX_DECELERATION = 2
    MAX_STEER = 3
    MAX_SPEED = 4
    MASS = 5
    YAW_INERTIA = 6
    DYNAMIC = 7


class CommandMode(IntEnum):
    """What a row of ``commands`` asks for."""

    HOLD = 0
    """Stand still."""
    DRIVE = 1
    """(acceleration m/s², front-wheel angle)."""
    POSE = 2
    """(x, y, yaw or NaN, speed or NaN); NaN keeps the heading, or goes with the way."""
    EXTERNAL = 3
    """The row is moved by someone else."""


@compiled
def _wrap(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@compiled
def _drive_kinematic(
    body: FloatArray, wheelbase: float, steer: float, grip: float, speed: float, dt: float
) -> None:
    slip = math.atan(0.5 * math.tan(steer))
    mean_speed = 0.5 * (body[3] + speed)
    yaw_rate = mean_speed * math.cos(slip) * math.tan(steer) / wheelbase
    side_grip = math.sqrt(max(grip * grip - ((speed - body[3]) / dt) ** 2, (0.2 * grip) ** 2))
    if abs(mean_speed * yaw_rate) > side_grip:
        yaw_rate = math.copysign(side_grip / abs(mean_speed), yaw_rate)
        slip = math.copysign(min(abs(slip), abs(0.5 * wheelbase * yaw_rate / mean_speed)), slip)
    heading = body[2] + slip + 0.5 * yaw_rate * dt
    body[0] += mean_speed * math.cos(heading) * dt
    body[1] += mean_speed * math.sin(heading) * dt
    body[2] = _wrap(body[2] + yaw_rate * dt)
    body[3] = speed
    body[4] = speed * math.sin(slip)
    body[5] = yaw_rate


@compiled
def _drive_dynamic(
    body: FloatArray, limits: FloatArray, steer: float, mu: float, acceleration: float, dt: float
) -> None:
    half = 0.5 * limits[0]
    mass, inertia = limits[5], limits[6]
    step = dt / _SUBSTEPS
    load = 0.5 * mass * GRAVITY
    for _ in range(_SUBSTEPS):
        vx, vy, r = body[3], body[4], body[5]
        front = steer - math.atan2(vy + half * r, vx)
        rear = -math.atan2(vy - half * r, vx)
        # What the tyres spend lengthwise is not left for sideways: the friction circle.
        share = min(abs(acceleration) / (mu * GRAVITY), 0.98)
        peak = mu * load * math.sqrt(1.0 - share * share)
        force_front = peak * math.sin(_TYRE_C * math.atan(_TYRE_B * front))
        force_rear = peak * math.sin(_TYRE_C * math.atan(_TYRE_B * rear))
        vx_rate = acceleration - force_front * math.sin(steer) / mass + vy * r
        vy_rate = (force_front * math.cos(steer) + force_rear) / mass - vx * r
        r_rate = half * (force_front * math.cos(steer) - force_rear) / inertia
        body[3] = min(max(vx + vx_rate * step, 0.0), limits[4])
        body[4] = vy + vy_rate * step
        body[5] = r + r_rate * step
        body[2] = _wrap(body[2] + body[5] * step)
        cos, sin = math.cos(body[2]), math.sin(body[2])
        body[0] += (body[3] * cos - body[4] * sin) * step
        body[1] += (body[3] * sin + body[4] * cos) * step


@compiled
def _drive_to_pose(
    body: FloatArray, limits: FloatArray, command: FloatArray, grip: float, dt: float
) -> None:
    dx, dy = command[0] - body[0], command[1] - body[1]
    along = dx * math.cos(body[2]) + dy * math.sin(body[2])
    side = -dx * math.sin(body[2]) + dy * math.cos(body[2])
    low = body[3] - min(limits[2], grip) * dt
    high = min(body[3] + min(limits[1], grip) * dt, limits[4])
    wanted = max(along / dt, 0.0)
    speed = min(max(wanted, low, 0.0), max(high, 0.0))
    scale = speed / wanted if wanted > speed else 1.0
    room = SLIDE_SLOPE * speed * dt
    side = min(max(side * scale, -room), room)
    turn = 0.0 if math.isnan(command[2]) else _wrap(command[2] - body[2])
    most = (grip / speed if speed > 1.0 else grip) * dt
    turn = min(max(turn, -most), most)
    if speed < 0.05:
        turn = 0.0
    cos, sin = math.cos(body[2]), math.sin(body[2])
    body[0] += speed * dt * cos - side * sin
    body[1] += speed * dt * sin + side * cos
    body[2] = _wrap(body[2] + turn)
    if not math.isnan(command[3]):
        # The planner's own speed at the pose, within what this step could reach.
        speed = min(max(command[3], low, 0.0), max(high, 0.0))
    body[3] = speed
    body[4] = 0.0
    body[5] = turn / dt
    body[6] = math.atan(body[5] * limits[0] / speed) if speed > 0.5 else 0.0


@compiled
def drive_vehicles(
    bodies: FloatArray,
    limits: FloatArray,
    modes: IntArray,
    commands: FloatArray,
    friction: float,
    wind_side: FloatArray,
    dt: float,
) -> None:
    """Moves every ego by one step.

    Args:
        bodies: (M, 9), columns ``Body``; changed in place.
        limits: (M, 8), columns ``Limit``.
        modes: (M,) ``CommandMode``.
        commands: (M, 4), meaning by mode.
        friction: Tyre-road friction coefficient.
        wind_side: (2,) acceleration by the wind in m/s², x and y.
        dt: Seconds.
    """
    grip = friction * GRAVITY
    for m in range(bodies.shape[0]):
        body, limit = bodies[m], limits[m]
        before = body[3]
        if modes[m] == 3:
            continue
        if modes[m] == 0:
            body[3] = 0.0
            body[4] = 0.0
            body[5] = 0.0
            body[7] = 0.0
            continue
        if modes[m] == 2:
            _drive_to_pose(body, limit, commands[m], grip, dt)
        else:
            asked = min(max(commands[m, 0], -min(limit[2], grip)), min(limit[1], grip))
            # A motor of constant power: less pull at speed; none beyond the top speed.
            if asked > 0.0:
                asked *= max(0.0, 1.0 - before / limit[4])
            steer = min(max(commands[m, 1], -limit[3]), limit[3])
            most = STEER_RATE * dt
            body[6] += min(max(steer - body[6], -most), most)
            if limit[7] > 0.5 and before > _DYNAMIC_FROM_SPEED:
                _drive_dynamic(body, limit, body[6], friction, asked, dt)
            else:
                speed = min(max(before + asked * dt, 0.0), limit[4])
                _drive_kinematic(body, limit[0], body[6], grip, speed, dt)
        if body[3] > 1.0:
            # Wind pushes the body off its line; tyres and driver take the rest of it up.
            body[0] += 0.5 * wind_side[0] * dt * dt
            body[1] += 0.5 * wind_side[1] * dt * dt
        body[7] = (body[3] - before) / dt
