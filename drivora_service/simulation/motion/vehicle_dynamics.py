"""Dynamics of vehicles that agents control: friction-limited kinematic and dynamic bicycle models.

The kinematic model (Rajamani, *Vehicle Dynamics and Control*, 2012, section 2.2) moves the box
centre at the speed ``V`` along ``yaw + slip`` and turns by ``2 V sin(slip) / wheelbase``; the wheel
angle requests ``tan(slip) = tan(steer) / 2``. The tyres limit it: the changes of speed and of the
direction of travel stay together within the friction circle, so that a bend taken too fast is left
on a wider arc. The dynamic model adds lateral velocity and yaw inertia with a saturating tyre at
each axle (Pacejka's formula with B = 10, C = 1.9, D = mu, the usual figures for a dry road), so
that a vehicle can skid; below 4 m/s, where slip angles are not defined, it falls back to the
kinematic model.

The push of the wind is a force on the body. In the dynamic model the tyres take it up as far as
they can; in the kinematic one they do so at the slip angle that the same tyres would need, so that
the vehicle drifts.

Each axle has the friction of the place under it, which slippery patches lower. The kinematic model
has the mean of both.

A step is integrated in substeps of the same length for all step lengths, so that a manoeuvre does
not depend on the agent's interval.

Rows of ``bodies`` are egos; all arrays are changed in place. SI units, radians.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.ground import axle_frictions

GRAVITY = 9.81
STEER_RATE = 0.7
"""Front-wheel angle a second that the steering reaches, rad/s: a steering wheel at 600 degrees a
second through a ratio of 15."""
SLIDE_SLOPE = 0.7
"""A pose is reached sideways by at most this many metres a metre driven (35 degrees of wheel)."""
SUBSTEP = 0.01
"""Seconds of integration at most."""
_DYNAMIC_FROM_SPEED = 4.0
_TYRE_B = 10.0
_TYRE_C = 1.9
_SIDE_RESERVE = 0.2
"""Share of the grip that is reserved for steering from braking and driving."""
_CROSSWISE = 0.25
"""Share of its speed along its heading below which a vehicle slides crosswise: 75 degrees."""
_STILL = 1e-6
"""m/s below which a vehicle has no direction of travel."""


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
    DRIFT = 9
    """Slip angle by the wind, as far as ``SPEED`` and ``SIDE_SPEED`` contain it."""


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
    """The meaning of a row of ``commands``."""

    HOLD = 0
    """Stand still."""
    DRIVE = 1
    """Accelerate and steer; columns ``DriveCommand``."""
    POSE = 2
    """Move to a pose; columns ``PoseCommand``."""
    EXTERNAL = 3
    """The row is moved by SUMO."""


class DriveCommand(IntEnum):
    """Columns of ``commands`` in rows of ``CommandMode.DRIVE``."""

    ACCELERATION = 0
    """m/s²."""
    STEER = 1
    """Front-wheel angle."""


class PoseCommand(IntEnum):
    """Columns of ``commands`` in rows of ``CommandMode.POSE``."""

    X = 0
    Y = 1
    YAW = 2
    """NaN keeps the heading."""
    SPEED = 3
    """Speed at the pose; NaN: that of the displacement."""


class EgoBodies(NamedTuple):
    """The bodies of all egos and what moves them.

    Attributes:
        bodies: (M, 10), columns ``Body``.
        limits: (M, 8), columns ``Limit``.
        modes: (M,) ``CommandMode``.
        commands: (M, 4), columns ``DriveCommand`` or ``PoseCommand``, by mode.
        in_world: (M,) egos that are on the road.
        values: (capacity, M, 8) of the frames, columns ``EgoCol``.
    """

    bodies: FloatArray
    limits: FloatArray
    modes: IntArray
    commands: FloatArray
    in_world: BoolArray
    values: FloatArray


@compiled
def _clip(value: float, low: float, high: float) -> float:
    return float(min(max(value, low), high))


@compiled
def _drive_kinematic(
    body: FloatArray, limits: FloatArray, asked: float, grip: float, wind: FloatArray, dt: float
) -> None:
    drift = _drift(body, grip, wind)
    v = math.hypot(body[Body.SPEED], body[Body.SIDE_SPEED])
    wanted_slip = math.atan(0.5 * math.tan(body[Body.STEER]))
    slip = (
        math.atan2(body[Body.SIDE_SPEED], body[Body.SPEED]) - body[Body.DRIFT]
        if v > _STILL
        else wanted_slip
    )
    turn = 2.0 * math.sin(slip) / limits[Limit.WHEELBASE]
    # Lateral demand of the steering on the tyres; the wheels are turned, the body follows.
    wanted = abs(v * (v * turn + (wanted_slip - slip) / dt))
    reserve = min(wanted, _SIDE_RESERVE * grip)
    most = math.sqrt(grip * grip - reserve * reserve)
    acceleration = _clip(asked, -most, most)
    side_grip = math.sqrt(max(grip * grip - acceleration * acceleration, 0.0))
    v_next = min(max(v + acceleration * dt, 0.0), limits[Limit.MAX_SPEED])
    way = 0.5 * (v + v_next) * dt
    if v_next == 0.0:
        # It stands before the substep ends.
        way = 0.5 * v * v / -acceleration if acceleration < 0.0 else 0.0
    mean = way / dt
    yaw_rate = mean * turn
    slip_rate = (wanted_slip - slip) / dt
    if mean > _STILL:
        most_turn = side_grip / max(v, v_next)
        slip_rate = _clip(slip_rate, -most_turn - yaw_rate, most_turn - yaw_rate)
    course = body[Body.YAW] + slip + drift + 0.5 * (yaw_rate + slip_rate) * dt
    body[Body.X] += way * math.cos(course)
    body[Body.Y] += way * math.sin(course)
    body[Body.YAW] = wrap_to_pi(body[Body.YAW] + yaw_rate * dt)
    body[Body.DRIFT] = _drift(body, grip, wind)
    slip += slip_rate * dt + body[Body.DRIFT]
    body[Body.SPEED] = v_next * math.cos(slip)
    body[Body.SIDE_SPEED] = v_next * math.sin(slip)
    body[Body.YAW_RATE] = yaw_rate


@compiled
def _drift(body: FloatArray, grip: float, wind: FloatArray) -> float:
    """Returns the slip angle at which the tyres balance the wind; their curve is linear here."""
    across = wind[1] * math.cos(body[Body.YAW]) - wind[0] * math.sin(body[Body.YAW])
    return float(across / (_TYRE_B * _TYRE_C * grip))


@compiled
def _drive_dynamic(
    body: FloatArray,
    limits: FloatArray,
    asked: float,
    front_mu: float,
    rear_mu: float,
    wind: FloatArray,
    dt: float,
) -> None:
    half = 0.5 * limits[Limit.WHEELBASE]
    vx, vy, r, steer = (
        body[Body.SPEED],
        body[Body.SIDE_SPEED],
        body[Body.YAW_RATE],
        body[Body.STEER],
    )
    ahead_cos, ahead_sin = math.cos(steer), math.sin(steer)
    # Forces in units of the maximum force of the axle's tyres, half the weight times its mu.
    front = math.sin(_TYRE_C * math.atan(_TYRE_B * (steer - math.atan2(vy + half * r, vx))))
    rear = math.sin(_TYRE_C * math.atan(-_TYRE_B * math.atan2(vy - half * r, vx)))
    front_push = _along_tyre(asked / (front_mu * GRAVITY), front)
    rear_push = _along_tyre(asked / (rear_mu * GRAVITY), rear)
    front *= math.sqrt(1.0 - front_push * front_push)
    rear *= math.sqrt(1.0 - rear_push * rear_push)
    front_scale, rear_scale = 0.5 * front_mu * GRAVITY, 0.5 * rear_mu * GRAVITY
    front_ahead = front_scale * (front_push * ahead_cos - front * ahead_sin)
    front_side = front_scale * (front_push * ahead_sin + front * ahead_cos)
    across = wind[1] * math.cos(body[Body.YAW]) - wind[0] * math.sin(body[Body.YAW])
    vx_rate = front_ahead + rear_scale * rear_push + vy * r
    vy_rate = front_side + rear_scale * rear + across - vx * r
    r_rate = (
        half * limits[Limit.MASS] * (front_side - rear_scale * rear) / limits[Limit.YAW_INERTIA]
    )
    body[Body.SPEED] = min(vx + vx_rate * dt, limits[Limit.MAX_SPEED])
    body[Body.SIDE_SPEED] = vy + vy_rate * dt
    body[Body.YAW_RATE] = r + r_rate * dt
    body[Body.YAW] = wrap_to_pi(body[Body.YAW] + body[Body.YAW_RATE] * dt)
    cos, sin = math.cos(body[Body.YAW]), math.sin(body[Body.YAW])
    body[Body.X] += (body[Body.SPEED] * cos - body[Body.SIDE_SPEED] * sin) * dt
    body[Body.Y] += (body[Body.SPEED] * sin + body[Body.SIDE_SPEED] * cos) * dt
    body[Body.DRIFT] = across / (_TYRE_B * _TYRE_C * (0.5 * (front_mu + rear_mu)) * GRAVITY)


@compiled
def _slide(body: FloatArray, grip: float, dt: float) -> None:
    """Moves a vehicle that slides crosswise: straight on, slowed by its tyres, not turning."""
    v = math.hypot(body[Body.SPEED], body[Body.SIDE_SPEED])
    v_next = max(v - grip * dt, 0.0)
    course = body[Body.YAW] + math.atan2(body[Body.SIDE_SPEED], body[Body.SPEED])
    way = 0.5 * (v + v_next) * dt
    body[Body.X] += way * math.cos(course)
    body[Body.Y] += way * math.sin(course)
    body[Body.SPEED] *= v_next / v
    body[Body.SIDE_SPEED] *= v_next / v
    body[Body.YAW_RATE] = 0.0


@compiled
def _along_tyre(push: float, side: float) -> float:
    """Returns the force along a tyre within its circle, less the reserve for the steering."""
    reserve = min(abs(side), _SIDE_RESERVE)
    most = math.sqrt(1.0 - reserve * reserve)
    return float(min(max(push, -most), most))


@compiled
def _drive_to_pose(
    body: FloatArray, limits: FloatArray, command: FloatArray, grip: float, dt: float
) -> None:
    dx, dy = command[PoseCommand.X] - body[Body.X], command[PoseCommand.Y] - body[Body.Y]
    along = dx * math.cos(body[Body.YAW]) + dy * math.sin(body[Body.YAW])
    side = -dx * math.sin(body[Body.YAW]) + dy * math.cos(body[Body.YAW])
    low = body[Body.SPEED] - min(limits[Limit.MAX_DECELERATION], grip) * dt
    high = min(
        body[Body.SPEED] + min(limits[Limit.MAX_ACCELERATION], grip) * dt, limits[Limit.MAX_SPEED]
    )
    wanted = max(along / dt, 0.0)
    speed = min(max(wanted, low, 0.0), max(high, 0.0))
    scale = speed / wanted if wanted > speed else 1.0
    room = SLIDE_SLOPE * speed * dt
    side = min(max(side * scale, -room), room)
    yaw, speed_there = command[PoseCommand.YAW], command[PoseCommand.SPEED]
    turn = 0.0 if math.isnan(yaw) else wrap_to_pi(yaw - body[Body.YAW])
    # Grip used for braking and driving is not available for turning.
    taken = min(abs(speed - body[Body.SPEED]) / dt, grip)
    side_grip = max(math.sqrt(grip * grip - taken * taken), _SIDE_RESERVE * grip)
    most = (side_grip / speed if speed > 1.0 else side_grip) * dt
    turn = min(max(turn, -most), most)
    if speed < 0.05:
        turn = 0.0
    cos, sin = math.cos(body[Body.YAW]), math.sin(body[Body.YAW])
    body[Body.X] += speed * dt * cos - side * sin
    body[Body.Y] += speed * dt * sin + side * cos
    body[Body.YAW] = wrap_to_pi(body[Body.YAW] + turn)
    if not math.isnan(speed_there):
        # The planner's own speed at the pose, within what this step could reach.
        speed = min(max(speed_there, low, 0.0), max(high, 0.0))
    body[Body.SPEED] = speed
    body[Body.SIDE_SPEED] = 0.0
    body[Body.DRIFT] = 0.0
    body[Body.YAW_RATE] = turn / dt
    body[Body.STEER] = (
        math.atan(body[Body.YAW_RATE] * limits[Limit.WHEELBASE] / speed) if speed > 0.5 else 0.0
    )


@compiled
def drive_vehicles(
    bodies: FloatArray,
    limits: FloatArray,
    modes: IntArray,
    commands: FloatArray,
    friction: float,
    patches: FloatArray,
    wind: FloatArray,
    dt: float,
) -> None:
    """Moves every ego by one step.

    Args:
        bodies: (M, 10), columns ``Body``; changed in place.
        limits: (M, 8), columns ``Limit``.
        modes: (M,) ``CommandMode``.
        commands: (M, 4), columns ``DriveCommand`` or ``PoseCommand``, by mode.
        friction: Tyre-road friction coefficient.
        patches: (P, 8) places with less, columns ``ground.PatchCol``.
        wind: (2,) force of the wind by mass in m/s², x and y; its component across a vehicle acts.
        dt: Seconds.
    """
    for m in range(bodies.shape[0]):
        body, limit = bodies[m], limits[m]
        before = body[Body.SPEED]
        if modes[m] == CommandMode.EXTERNAL:
            continue
        if modes[m] == CommandMode.HOLD:
            body[Body.SPEED] = 0.0
            body[Body.SIDE_SPEED] = 0.0
            body[Body.YAW_RATE] = 0.0
            body[Body.ACCELERATION] = 0.0
            body[Body.DRIFT] = 0.0
            continue
        if modes[m] == CommandMode.POSE:
            front, rear = _under_axles(body, limit, friction, patches)
            grip = 0.5 * (front + rear) * GRAVITY
            drift = body[Body.SPEED] * _drift(body, grip, wind) * dt
            body[Body.X] -= drift * math.sin(body[Body.YAW])
            body[Body.Y] += drift * math.cos(body[Body.YAW])
            _drive_to_pose(body, limit, commands[m], grip, dt)
        else:
            _drive(body, limit, commands[m], friction, patches, wind, dt)
        body[Body.ACCELERATION] = (body[Body.SPEED] - before) / dt


@compiled
def _under_axles(
    body: FloatArray, limit: FloatArray, friction: float, patches: FloatArray
) -> tuple[float, float]:
    """Returns the friction coefficients under a body's front and rear axle."""
    if patches.shape[0] == 0:
        return friction, friction
    return axle_frictions(
        body[Body.X],
        body[Body.Y],
        body[Body.HEIGHT],
        math.cos(body[Body.YAW]),
        math.sin(body[Body.YAW]),
        limit[Limit.WHEELBASE],
        friction,
        patches,
    )


@compiled
def _drive(
    body: FloatArray,
    limit: FloatArray,
    command: FloatArray,
    friction: float,
    patches: FloatArray,
    wind: FloatArray,
    dt: float,
) -> None:
    """Moves an ego by acceleration and wheel angle."""
    steer = _clip(command[DriveCommand.STEER], -limit[Limit.MAX_STEER], limit[Limit.MAX_STEER])
    count = max(math.ceil(dt / SUBSTEP - 1e-9), 1)
    step = dt / count
    turned = STEER_RATE * step
    for _ in range(count):
        # Patches are met within a step.
        front, rear = _under_axles(body, limit, friction, patches)
        grip = 0.5 * (front + rear) * GRAVITY
        is_dynamic = (
            limit[Limit.DYNAMIC] > 0.5
            and math.hypot(body[Body.SPEED], body[Body.SIDE_SPEED]) > _DYNAMIC_FROM_SPEED
        )
        # In the dynamic model each axle transmits what it can of the brakes' and the motor's force.
        reachable = max(front, rear) * GRAVITY if is_dynamic else grip
        braking, pull = (
            min(limit[Limit.MAX_DECELERATION], reachable),
            min(limit[Limit.MAX_ACCELERATION], reachable),
        )
        # The traction decreases with the speed and is 0 at the top speed.
        most = min(
            pull,
            limit[Limit.MAX_ACCELERATION]
            * max(0.0, 1.0 - body[Body.SPEED] / limit[Limit.MAX_SPEED]),
        )
        asked = _clip(command[DriveCommand.ACCELERATION], -braking, most)
        body[Body.STEER] += _clip(steer - body[Body.STEER], -turned, turned)
        if not is_dynamic:
            _drive_kinematic(body, limit, asked, grip, wind, step)
        elif body[Body.SPEED] > _CROSSWISE * math.hypot(body[Body.SPEED], body[Body.SIDE_SPEED]):
            _drive_dynamic(body, limit, asked, front, rear, wind, step)
        else:
            _slide(body, grip, step)
