"""The starts of actors, and whether two of them are too near to one another.

No collision may be unavoidable at the start of a scenario: boxes keep a clear distance, and an
actor that starts at speed has the room to brake for the actor ahead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivora_service.geometry.boxes import overlap_depth
from drivora_service.search.space.driven_path import DrivenPath, Pose

CLEAR_AHEAD = 2.0
"""Least lengthwise distance of the boxes of two vehicles, metres."""
CLEAR_OF_EGO = 7.0
"""Metres that other actors keep ahead of and behind the start of an ego."""
_CLEAR_BESIDE = 0.3
_BRAKING = 3.0
"""Deceleration of a vehicle for an actor that starts ahead of it, m/s²: comfortable for a car."""
_REACTION = 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Start:
    """The place, time and speed at which an actor appears.

    Attributes:
        pose: Centre of its box.
        length: Metres.
        width: Metres.
        appears: Time of its appearance, seconds.
        until: Time up to which it stays there, seconds; ``appears`` if it moves at once.
        speed: Initial speed, m/s.
        path: Its path; ``None`` for actors that do not follow lanes.
        s: Arc length on ``path``, metres.
        clear: Metres that other actors keep ahead of and behind it.
    """

    pose: Pose
    length: float
    width: float
    appears: float = 0.0
    until: float = 0.0
    speed: float = 0.0
    path: DrivenPath | None = None
    s: float = 0.0
    clear: float = CLEAR_AHEAD


def too_near(one: Start, other: Start) -> bool:
    """Returns whether two starts are too near to each other."""
    if one.appears > other.until or other.appears > one.until:
        return False
    if _boxes_too_near(one, other):
        return True
    return _cannot_stop(one, other) or _cannot_stop(other, one)


def _boxes_too_near(one: Start, other: Start) -> bool:
    clear = max(one.clear, other.clear)
    dx, dy = other.pose.x - one.pose.x, other.pose.y - one.pose.y
    reach = one.length + one.width + other.length + other.width + clear
    if max(abs(dx), abs(dy)) > reach:
        return False
    depth = overlap_depth(
        dx,
        dy,
        one.pose.yaw,
        one.length + clear,
        one.width + _CLEAR_BESIDE,
        other.pose.yaw,
        other.length + clear,
        other.width + _CLEAR_BESIDE,
    )
    return bool(depth > 0.0)


def _cannot_stop(one: Start, other: Start) -> bool:
    """Returns whether ``other`` is ahead of ``one``, slower, and within its braking distance."""
    if one.path is None or one.speed <= 0.0:
        return False
    along = other.speed * max(math.cos(other.pose.yaw - one.pose.yaw), 0.0)
    braking = max(one.speed**2 - along**2, 0.0) / (2.0 * _BRAKING)
    room = other.clear + _REACTION * one.speed + braking + 0.5 * (one.length + other.length)
    if math.hypot(other.pose.x - one.pose.x, other.pose.y - one.pose.y) > room:
        return False
    s, gap = one.path.place_of(other.pose.x, other.pose.y)
    in_the_way = gap < 0.5 * (one.width + other.width) + _CLEAR_BESIDE
    return in_the_way and 0.0 < s - one.s < room
