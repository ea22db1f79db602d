"""The situation of the vehicle: a few numbers, with a description in words and as a vector.

Gaps are metres between bumpers, speeds m/s along the road.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.agents.adapters.dilu.decisions import Decision
from drivora_service.geometry.array_shapes import FloatArray

_LITTLE = 0.1
"""m/s that count as no difference."""

_SIGHT = 100.0
"""Maximum distance in the comparison of situations, metres."""

_LONG = 10.0
"""Maximum time to collision in the comparison of situations, seconds."""

_CLEAR_AHEAD, _CLEAR_BEHIND = 1.5, 1.5
"""Least headway of a gap ahead and behind to count as free, seconds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighbour:
    """An actor ahead or behind in a lane.

    Attributes:
        gap: Metres, at least 0.
        speed: m/s.
    """

    gap: float
    speed: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Beside:
    """An adjacent lane to which the vehicle may change.

    Attributes:
        ahead: The next actor ahead there.
        behind: The next actor behind there.
    """

    ahead: Neighbour | None = None
    behind: Neighbour | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """The situation for a decision.

    Attributes:
        speed: Speed of the vehicle, m/s.
        wanted: Desired speed by the decisions so far, m/s.
        allowed: Speed allowed by limit and bends, m/s.
        ahead: The next actor ahead in its lane.
        left: The lane to the left, ``None`` if it may not change to one.
        right: The lane to the right, likewise.
        stop: Metres to a light that it has to stop for.
        crossing: Metres to a place where an actor will cross its way.
    """

    speed: float
    wanted: float
    allowed: float
    ahead: Neighbour | None = None
    left: Beside | None = None
    right: Beside | None = None
    stop: float | None = None
    crossing: float | None = None


def available(situation: Situation) -> tuple[Decision, ...]:
    """Returns the decisions that can be carried out, as in DiLu and highway-env."""
    s = situation
    possible = {
        Decision.LEFT: s.left is not None,
        Decision.KEEP: True,
        Decision.RIGHT: s.right is not None,
        Decision.ACCELERATE: s.wanted < s.allowed - _LITTLE,
        Decision.DECELERATE: s.wanted > _LITTLE,
    }
    return tuple(decision for decision, may in possible.items() if may)


def describe_situation(situation: Situation) -> str:
    """Returns the full description of a situation."""
    s = situation
    return " ".join(
        [
            f"You drive at {s.speed:.1f} m/s and want {s.wanted:.1f} m/s; allowed are "
            f"{s.allowed:.1f} m/s.",
            f"Ahead in your lane: {_describe_neighbour(s.ahead, s.speed) or 'nobody near'}.",
            f"Lane to the left: {_describe_lane(s.left, s.speed)}.",
            f"Lane to the right: {_describe_lane(s.right, s.speed)}.",
            *([] if s.stop is None else [f"You must stop at a light in {s.stop:.0f} m."]),
            *([] if s.crossing is None else [f"Somebody will cross in {s.crossing:.0f} m."]),
        ]
    )


def in_brief(situation: Situation) -> str:
    """Returns a brief description, for a model that reads a hundred tokens a second."""
    s = situation
    return " ".join(
        [
            *(["Standing."] if s.speed < 0.5 else []),
            "Too slow." if s.wanted < s.allowed - 2.0 else "Speed right.",
            "Road free." if s.ahead is None else _ahead_in_brief(s.ahead, s.speed),
            _lane_in_brief("left", s.left, s.speed),
            _lane_in_brief("right", s.right, s.speed),
            *([] if s.stop is None else [f"Red light {s.stop:.0f} m."]),
            *([] if s.crossing is None else [f"Car crosses {s.crossing:.0f} m."]),
        ]
    )


def features(situation: Situation) -> FloatArray:
    """Returns the (9,) vector by which situations are compared; a difference of 1 is large."""
    s = situation
    return np.array(
        [
            s.speed / 6.0,
            # The margin to the allowed speed shows the possible gain.
            (s.allowed - s.speed) / 4.0,
            (s.allowed - s.wanted) / 3.0,
            _gap(s.ahead) / 30.0,
            _seconds_to_collision(s) / 4.0,
            1.5 * _is_open(s.left, s.speed),
            1.5 * _is_open(s.right, s.speed),
            _halting_share(s.speed, s.stop),
            _halting_share(s.speed, s.crossing),
        ]
    )


def _pace(neighbour: Neighbour, speed: float) -> str:
    pace = neighbour.speed - speed
    return "slower" if pace < -1.0 else "faster" if pace > 1.0 else "as fast"


def _describe_neighbour(neighbour: Neighbour | None, speed: float) -> str:
    if neighbour is None:
        return ""
    return f"{neighbour.gap:.0f} m away, at {neighbour.speed:.1f} m/s ({_pace(neighbour, speed)})"


def _describe_lane(lane: Beside | None, speed: float) -> str:
    if lane is None:
        return "none"
    return (
        f"ahead {_describe_neighbour(lane.ahead, speed) or 'nobody'}, behind "
        f"{_describe_neighbour(lane.behind, speed) or 'nobody'}"
    )


def _ahead_in_brief(ahead: Neighbour, speed: float) -> str:
    pace = _pace(ahead, speed)
    if pace == "as fast":
        return f"Car {ahead.gap:.0f} m ahead."
    return f"{pace.capitalize()} car {ahead.gap:.0f} m ahead."


def _lane_in_brief(side: str, lane: Beside | None, speed: float) -> str:
    if lane is None:
        return f"No {side}."
    return (
        f"{side.capitalize()} free." if _is_open(lane, speed) else f"{side.capitalize()} blocked."
    )


def _gap(neighbour: Neighbour | None) -> float:
    return _SIGHT if neighbour is None else min(neighbour.gap, _SIGHT)


def _seconds_to_collision(s: Situation) -> float:
    if s.ahead is None or s.ahead.speed >= s.speed:
        return _LONG
    return min(s.ahead.gap / (s.speed - s.ahead.speed), _LONG)


def _is_open(lane: Beside | None, speed: float) -> float:
    """Returns 1 for a lane with room, else 0."""
    if lane is None:
        return 0.0
    ahead, behind = lane.ahead, lane.behind
    blocked = ahead is not None and ahead.gap < max(_CLEAR_AHEAD * speed, 8.0)
    pressed = behind is not None and behind.gap < max(_CLEAR_BEHIND * behind.speed, 5.0)
    return float(not blocked and not pressed)


def _halting_share(speed: float, distance: float | None) -> float:
    """Returns the nearness of a halt: 0 far or none, 1 where comfortable braking begins."""
    if distance is None:
        return 0.0
    return min(1.5, (speed**2 / 4.0 + 8.0) / max(distance, 1.0))
