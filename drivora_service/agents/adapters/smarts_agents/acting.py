"""Conversion of a policy's poses every tenth of a second to poses for each step.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import SupportsFloat

import numpy as np

from drivora_service.agents.adapters.lights import light_speed
from drivora_service.agents.adapters.reference import Reference
from drivora_service.agents.interface import Observation, PoseControl
from drivora_service.observations.trace import Col

PERIOD = 0.1
"""Period of a policy in seconds, in which it wants to reach its pose."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """Pose that a policy wants to reach ``PERIOD`` after ``time``.

    Attributes:
        pace: Change of x, y and yaw per second on the way there.
    """

    x: float
    y: float
    yaw: float
    time: float
    pace: tuple[float, float, float]


def target_of(observation: Observation, x: float, y: float, yaw: float) -> Target:
    """Returns the target of a policy from the present pose to the given one."""
    from_x, from_y, from_yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
    turn = math.remainder(yaw - from_yaw, math.tau)
    way = (x - from_x) / PERIOD, (y - from_y) / PERIOD, turn / PERIOD
    return Target(x=x, y=y, yaw=yaw, time=observation.time, pace=way)


def pose_of(answer: Iterable[SupportsFloat]) -> tuple[float, float, float]:
    """Returns x, y and heading of a policy's answer, which ends with a duration."""
    x, y, heading, *_ = (float(value) for value in answer)
    return x, y, heading


def allowed_speed(reference: Reference, observation: Observation) -> float:
    """Returns the speed that limit, bends and lights allow, m/s.

    SMARTS places a vehicle at the pose of a policy's answer, regardless of its tyres, and has
    no lights.
    """
    away = reference.line - observation.ego[[Col.X, Col.Y]]
    nearest = int(np.argmin((away**2).sum(axis=1)))
    return min(float(reference.speeds[nearest]), light_speed(observation))


def step_towards(
    target: Target, observation: Observation, step_length: float, allowed: float
) -> PoseControl:
    """Returns the pose after this step, on the way to the target and no faster than allowed.

    A step that ends after the target's time continues beyond it at the same pace.

    Args:
        target: Target of the policy.
        observation: Observation of this step.
        step_length: Seconds.
        allowed: m/s.
    """
    x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
    left = max(target.time + PERIOD - observation.time, 0.0)
    beyond = max(step_length - left, 0.0)
    share = step_length / max(left, step_length)
    dx, dy = share * (target.x - x), share * (target.y - y)
    turn = share * math.remainder(target.yaw - yaw, math.tau)
    if beyond > 1e-9:
        dx, dy, turn = (
            part + beyond * pace for part, pace in zip((dx, dy, turn), target.pace, strict=True)
        )
    wanted, most = math.hypot(dx, dy), allowed * step_length
    if wanted > most:
        dx, dy, turn = (part * most / wanted for part in (dx, dy, turn))
    return PoseControl(x + dx, y + dy, yaw + turn)
