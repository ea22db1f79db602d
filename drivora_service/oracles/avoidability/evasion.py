"""Evasion at full grip: simultaneous braking and steering within the drivable area.

A search over few manoeuvres: steering to the left or right for a time, then back to the direction
of the path, braking throughout by a share of the grip; the rest of the friction circle is available
for steering. The vehicle is a kinematic bicycle with a limited rate of the steering wheel.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.drivable_area import near_area
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.ground import vehicle_friction
from drivora_service.observations.trace import Col
from drivora_service.oracles.avoidability.braking_evasion import (
    WAIT,
    is_run_into,
    meets,
    place_on,
    pose_on,
)
from drivora_service.oracles.avoidability.replayed_contact import DrivenCol, Replay

BRAKING_SHARES = (0.0, 0.5, 0.8, 0.95)
"""Shares of the grip used for braking while steering."""

ASIDE_TIMES = (0.2, 0.4, 0.6, 0.8, 1.0, 1.3, 1.6, 2.0)
"""Seconds of steering aside before steering back."""

STEER_RATE = 0.7
"""rad/s of the front wheels (as in the ego's dynamics)."""

OUTSIDE = 0.3
"""Metres that a corner may be outside the drivable area (nuPlan)."""

_STRAIGHT_SHARE = 0.95
"""Share of the grip used for braking once the ego is back in direction; the rest steers."""


class _Manoeuvre(NamedTuple):
    """Braking and steering aside, then back.

    Attributes:
        braking: Share of the grip used for braking while steering.
        side: 1 to the left, -1 to the right.
        time: Seconds of steering aside before steering back.
    """

    braking: float
    side: float
    time: float


class _Vehicle(NamedTuple):
    """What limits the vehicle.

    Attributes:
        grip: Highest friction of the road times gravity, m/s².
        brakes: Full deceleration, m/s².
        wheelbase: Metres.
        max_steer: Radians at the front wheels.
    """

    grip: float
    brakes: float
    wheelbase: float
    max_steer: float


def find_evasion(
    replay: Replay,
    network: RoadNetwork,
    row: int,
    *,
    grip: float,
    brakes: float,
    wheelbase: float,
    max_steer: float,
) -> FloatArray | None:
    """Returns a manoeuvre from ``row`` on that avoids all actors within the drivable area.

    Args:
        replay: The collision.
        network: The network with the drivable area.
        row: Row of the replay.
        grip: Highest friction of the road times gravity, m/s²; slippery places and worse weather
            leave less.
        brakes: Full deceleration of the vehicle, m/s².
        wheelbase: Metres.
        max_steer: Radians at the front wheels.

    Returns:
        (n, 3), columns ``Col`` up to ``YAW``, one for each row after ``row``; ``None`` if no
        manoeuvre avoids all actors.
    """
    poses = np.zeros((len(replay.others) - 1 - row, Col.YAW + 1))
    vehicle = _Vehicle(grip=grip, brakes=brakes, wheelbase=wheelbase, max_steer=max_steer)
    for share in BRAKING_SHARES:
        for side in (1.0, -1.0):
            for time in ASIDE_TIMES:
                manoeuvre = _Manoeuvre(braking=share, side=side, time=time)
                count = _evade(replay, row, vehicle, manoeuvre, poses)
                if count > 0 and _on_road(network, poses[:count], replay):
                    return poses[:count]
    return None


def _on_road(network: RoadNetwork, poses: FloatArray, replay: Replay) -> bool:
    x, y, yaw = poses.T
    corners = box_corners(x, y, yaw, replay.length, replay.width)
    return bool(near_area(network, corners.reshape(-1, 2), OUTSIDE).all())


@compiled
def _evade(
    replay: Replay, row: int, vehicle: _Vehicle, manoeuvre: _Manoeuvre, poses: FloatArray
) -> int:
    """Fills the poses of one manoeuvre; returns their number, 0 if it touches an actor."""
    step, contact, path = replay.step, replay.contact, replay.path
    wheelbase, side = vehicle.wheelbase, manoeuvre.side
    x, y, yaw = path[row, DrivenCol.X], path[row, DrivenCol.Y], path[row, DrivenCol.YAW]
    arc, speed, i = path[row, DrivenCol.ARC], replay.speed[row], row
    steer = math.atan(path[row, DrivenCol.CURVATURE] * wheelbase)
    followed = np.zeros(replay.sizes.shape[0], dtype=np.bool_)
    stood = 0.0
    turn_back = False
    straight = False
    count = len(poses)
    for t in range(count):
        friction = vehicle_friction(x, y, 0.0, yaw, wheelbase, replay.road[row + t], replay.patches)
        grip = vehicle.grip * friction
        share = _STRAIGHT_SHARE if straight else manoeuvre.braking
        braking = min(share * grip, vehicle.brakes)
        slower = max(speed - braking * step, 0.0)
        mean = 0.5 * (speed + slower)
        speed = slower
        arc += mean * step
        i = place_on(path, arc, i)
        _, _, heading = pose_on(path, arc, i)
        turned = side * (yaw - heading)
        if t * step >= manoeuvre.time:
            turn_back = True
        free = math.sqrt(max(grip * grip - braking * braking, 0.0))
        most = math.atan(wheelbase * free / max(mean * mean, 0.25))
        most = min(most, vehicle.max_steer)
        wanted = side * most
        if turn_back and not straight:
            # The change of heading until the steering is back in the middle.
            unwound = mean * steer * steer / (2.0 * STEER_RATE * wheelbase)
            wanted = -wanted
            straight = turned <= (unwound if steer * side < 0.0 else 0.0)
        if straight:
            braking = min(_STRAIGHT_SHARE * grip, vehicle.brakes)
            most = math.atan(wheelbase * 0.3 * grip / max(mean * mean, 0.25))
            most = min(most, vehicle.max_steer)
            wanted = min(max((heading - yaw) * wheelbase / max(mean * 0.3, 0.1), -most), most)
        steer += min(max(wanted - steer, -STEER_RATE * step), STEER_RATE * step)
        rate = mean * math.tan(steer) / wheelbase
        if abs(rate * mean) > grip:
            rate = math.copysign(grip / mean, rate)
        slip = math.atan(0.5 * wheelbase * rate / max(mean, 0.5))
        x += mean * math.cos(yaw + slip + 0.5 * rate * step) * step
        y += mean * math.sin(yaw + slip + 0.5 * rate * step) * step
        yaw += rate * step
        poses[t, Col.X], poses[t, Col.Y], poses[t, Col.YAW] = x, y, yaw
        at = row + t + 1
        if meets(replay, at, x, y, yaw, speed <= 0.0 and at > contact, followed):
            return 0
        if speed <= 0.0:
            stood += step
            if at > contact and stood >= WAIT:
                return 0 if is_run_into(replay, x, y, yaw, arc) else t + 1
    return count
