"""Evasion at full grip: simultaneous braking and steering within the drivable area.

A search over few manoeuvres: steering to the left or right for a time, then back to the direction
of the path, braking throughout by a share of the grip; the rest of the friction circle is available
for steering. The vehicle is a kinematic bicycle with a limited rate of the steering wheel.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.drivable_area import near_area
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.ground import vehicle_friction
from drivora_service.oracles.avoidability.braking_evasion import WAIT, meets, place_on, pose_on
from drivora_service.oracles.avoidability.replayed_contact import Replay

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
        (n, 3) x, y and heading, one for each row after ``row``; ``None`` if no manoeuvre avoids all
        actors.
    """
    poses = np.zeros((len(replay.others) - 1 - row, 3))
    for share in BRAKING_SHARES:
        for side in (1.0, -1.0):
            for time in ASIDE_TIMES:
                count = _evade(
                    row,
                    replay.step,
                    (share, side, time, grip, brakes, wheelbase, max_steer),
                    replay.contact,
                    replay.length,
                    replay.width,
                    replay.path,
                    float(replay.speed[row]),
                    replay.others,
                    replay.present,
                    replay.sizes,
                    replay.walks,
                    replay.road,
                    replay.patches,
                    poses,
                )
                if count > 0 and _on_road(network, poses[:count], replay):
                    return poses[:count]
    return None


def _on_road(network: RoadNetwork, poses: FloatArray, replay: Replay) -> bool:
    corners = box_corners(poses[:, 0], poses[:, 1], poses[:, 2], replay.length, replay.width)
    return bool(near_area(network, corners.reshape(-1, 2), OUTSIDE).all())


@compiled
def _evade(
    row: int,
    step: float,
    manoeuvre: tuple[float, float, float, float, float, float, float],
    contact: int,
    length: float,
    width: float,
    path: FloatArray,
    speed: float,
    others: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    walks: BoolArray,
    road: FloatArray,
    patches: FloatArray,
    poses: FloatArray,
) -> int:
    """Fills the poses of one manoeuvre; returns their number, 0 if it touches an actor."""
    share, side, aside, road_grip, brakes, wheelbase, max_steer = manoeuvre
    x, y, yaw = path[row, 1], path[row, 2], path[row, 3]
    arc, i = path[row, 0], row
    steer = math.atan(path[row, 4] * wheelbase)
    followed = np.zeros(sizes.shape[0], dtype=np.bool_)
    stood = 0.0
    turn_back = False
    straight = False
    count = len(poses)
    for t in range(count):
        grip = road_grip * vehicle_friction(x, y, 0.0, yaw, wheelbase, road[row + t], patches)
        braking = min((_STRAIGHT_SHARE if straight else share) * grip, brakes)
        slower = max(speed - braking * step, 0.0)
        mean = 0.5 * (speed + slower)
        speed = slower
        arc += mean * step
        i = place_on(path, arc, i)
        heading = pose_on(path, arc, i)[2]
        turned = side * (yaw - heading)
        if t * step >= aside:
            turn_back = True
        free = math.sqrt(max(grip * grip - braking * braking, 0.0))
        most = math.atan(wheelbase * free / max(mean * mean, 0.25))
        most = min(most, max_steer)
        wanted = side * most
        if turn_back and not straight:
            # The change of heading until the steering is back in the middle.
            unwound = mean * steer * steer / (2.0 * STEER_RATE * wheelbase)
            wanted = -wanted
            straight = turned <= (unwound if steer * side < 0.0 else 0.0)
        if straight:
            braking = min(_STRAIGHT_SHARE * grip, brakes)
            most = min(math.atan(wheelbase * 0.3 * grip / max(mean * mean, 0.25)), max_steer)
            wanted = min(max((heading - yaw) * wheelbase / max(mean * 0.3, 0.1), -most), most)
        steer += min(max(wanted - steer, -STEER_RATE * step), STEER_RATE * step)
        rate = mean * math.tan(steer) / wheelbase
        if abs(rate * mean) > grip:
            rate = math.copysign(grip / mean, rate)
        slip = math.atan(0.5 * wheelbase * rate / max(mean, 0.5))
        x += mean * math.cos(yaw + slip + 0.5 * rate * step) * step
        y += mean * math.sin(yaw + slip + 0.5 * rate * step) * step
        yaw += rate * step
        poses[t] = x, y, yaw
        at = row + t + 1
        if meets(
            x, y, yaw, length, width, speed <= 0.0 and at > contact,
            others[at], present[at], sizes, walks, followed,
        ):  # fmt: skip
            return 0
        if speed <= 0.0:
            stood += step
            if at > contact and stood >= WAIT:
                return t + 1
    return count
