"""Conversion of an agent's control to a vehicle's command."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.interface import (
    AccelerationControl,
    Control,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.models.actor_models import ActorModel
from drivora_service.simulation.motion.vehicle_dynamics import CommandMode

_DRIVE = int(CommandMode.DRIVE)
_NOWHERE = 1e-6
"""Metres up to which two points of a trajectory are the same."""


def write_command(control: Control, model: ActorModel, dt: float, command: FloatArray) -> int:
    """Writes a control into a row of commands.

    Args:
        control: The agent's answer.
        model: Limits of the vehicle.
        dt: Step length, seconds.
        command: (4,) array that is filled.

    Returns:
        The ``CommandMode`` of the row.

    Raises:
        AgentError: If the answer is not a control, or contains a number that is not finite.
    """
    if isinstance(control, AccelerationControl):
        command[0], command[1] = acceleration, steer = control
        # The usual answer, on the hot path: one check, without enum lookup.
        if math.isfinite(acceleration + steer):
            return _DRIVE
        mode = CommandMode.DRIVE
    elif isinstance(control, PedalControl):
        throttle = min(max(control.throttle, 0.0), 1.0)
        brake = min(max(control.brake, 0.0), 1.0)
        # The result of min and max with NaN depends on the order: check before.
        if not math.isfinite(control.throttle + control.brake):
            raise _invalid(f"the agent answered pedals that are not finite: {control}")
        command[0] = (
            -brake * model.max_deceleration if brake > 0.0 else throttle * model.max_acceleration
        )
        command[1] = control.steer * model.max_steer
        mode = CommandMode.DRIVE
    elif isinstance(control, PoseControl):
        command[0], command[1], command[2] = control.x, control.y, control.yaw
        command[3] = math.nan if control.speed is None else control.speed
        if control.speed is not None and not math.isfinite(control.speed):
            raise _invalid(f"the agent answered a speed that is not finite: {control}")
        mode = CommandMode.POSE
    elif isinstance(control, TrajectoryControl):
        _write_trajectory(control, dt, command)
        return int(CommandMode.POSE)
    else:
        raise _invalid(
            f"the agent answered {type(control).__name__}; allowed: PedalControl, "
            "AccelerationControl, PoseControl, TrajectoryControl"
        )
    used = 2 if mode is CommandMode.DRIVE else 3
    if not math.isfinite(sum(command[:used].tolist())):
        raise _invalid(f"the agent answered a number that is not finite: {control}")
    return int(mode)


def _write_trajectory(control: TrajectoryControl, dt: float, command: FloatArray) -> None:
    points = np.asarray(control.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 4 or len(points) < 2:
        raise _invalid(
            f"the agent answered a trajectory of shape {points.shape}; allowed: (n >= 2, 4) "
            "with columns time, x, y, speed"
        )
    if not bool(np.all(np.isfinite(points))) or bool(np.any(np.diff(points[:, 0]) <= 0.0)):
        raise _invalid("the agent answered a trajectory with times that do not ascend, or NaN")
    here, soon = points[:, 0] - dt, max(dt, 1e-3)
    x, y, speed = (float(np.interp(0.0, here, points[:, k])) for k in (1, 2, 3))
    ahead_x, ahead_y = (float(np.interp(soon, here, points[:, k])) for k in (1, 2))
    dx, dy = ahead_x - x, ahead_y - y
    if math.hypot(dx, dy) < _NOWHERE:
        dx, dy = points[-1, 1] - points[0, 1], points[-1, 2] - points[0, 2]
    # A vehicle that stops keeps its heading.
    yaw = math.atan2(dy, dx) if math.hypot(dx, dy) >= _NOWHERE else math.nan
    command[:] = (x, y, yaw, speed)


def _invalid(message: str) -> AgentError:
    return AgentError(message, cause="agent_invalid_control")
