"""Conversion of an agent's control to a vehicle's command."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.interface import (
    AccelerationControl,
    Control,
    PedalControl,
    PoseControl,
    TrajectoryCol,
    TrajectoryControl,
)
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.models.actor_models import ActorModel
from drivora_service.simulation.motion.vehicle_dynamics import (
    CommandMode,
    DriveCommand,
    PoseCommand,
)

_DRIVE = int(CommandMode.DRIVE)
_ACCELERATION, _STEER = int(DriveCommand.ACCELERATION), int(DriveCommand.STEER)
_NOWHERE = 1e-6
"""Metres up to which two points of a trajectory are the same."""


def write_command(control: Control, model: ActorModel, dt: float, command: FloatArray) -> int:
    """Writes a control into a row of commands.

    Args:
        control: The agent's answer.
        model: Limits of the vehicle.
        dt: Step length, seconds.
        command: (4,) filled: columns ``DriveCommand`` or ``PoseCommand``, by the mode.

    Returns:
        The ``CommandMode`` of the row.

    Raises:
        AgentError: If the answer is not a control, or contains a number that is not finite.
    """
    if isinstance(control, AccelerationControl):
        # The usual answer, on the hot path: one check, without lookups in enums.
        command[_ACCELERATION], command[_STEER] = acceleration, steer = control
        if math.isfinite(acceleration + steer):
            return _DRIVE
        mode = CommandMode.DRIVE
    elif isinstance(control, PedalControl):
        throttle = min(max(control.throttle, 0.0), 1.0)
        brake = min(max(control.brake, 0.0), 1.0)
        # The result of min and max with NaN depends on the order: check before.
        if not math.isfinite(control.throttle + control.brake):
            raise _invalid(f"the agent answered pedals that are not finite: {control}")
        command[DriveCommand.ACCELERATION] = (
            -brake * model.max_deceleration if brake > 0.0 else throttle * model.max_acceleration
        )
        command[DriveCommand.STEER] = control.steer * model.max_steer
        mode = CommandMode.DRIVE
    elif isinstance(control, PoseControl):
        speed = math.nan if control.speed is None else control.speed
        command[:] = control.x, control.y, control.yaw, speed
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
    # A pose may lack a speed, which has been checked above.
    used = len(DriveCommand) if mode is CommandMode.DRIVE else PoseCommand.SPEED
    if not math.isfinite(sum(command[:used].tolist())):
        raise _invalid(f"the agent answered a number that is not finite: {control}")
    return int(mode)


def _write_trajectory(control: TrajectoryControl, dt: float, command: FloatArray) -> None:
    points = np.asarray(control.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != len(TrajectoryCol) or len(points) < 2:
        raise _invalid(
            f"the agent answered a trajectory of shape {points.shape}; allowed: (n >= 2, 4) "
            "with columns time, x, y, speed"
        )
    if not bool(np.all(np.isfinite(points))) or bool(
        np.any(np.diff(points[:, TrajectoryCol.TIME]) <= 0.0)
    ):
        raise _invalid("the agent answered a trajectory with times that do not ascend, or NaN")
    here, soon = points[:, TrajectoryCol.TIME] - dt, max(dt, 1e-3)
    ways = points[:, TrajectoryCol.X], points[:, TrajectoryCol.Y]
    x, y = (float(np.interp(0.0, here, way)) for way in ways)
    ahead_x, ahead_y = (float(np.interp(soon, here, way)) for way in ways)
    speed = float(np.interp(0.0, here, points[:, TrajectoryCol.SPEED]))
    dx, dy = ahead_x - x, ahead_y - y
    if math.hypot(dx, dy) < _NOWHERE:
        dx, dy = (float(way[-1] - way[0]) for way in ways)
    # A vehicle that stops keeps its heading.
    yaw = math.atan2(dy, dx) if math.hypot(dx, dy) >= _NOWHERE else math.nan
    command[:] = (x, y, yaw, speed)


def _invalid(message: str) -> AgentError:
    return AgentError(message, cause="agent_invalid_control")
