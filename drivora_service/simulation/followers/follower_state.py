"""The state of a follower: its columns, its phases and its reactions."""

from __future__ import annotations

from enum import IntEnum


class FollowerPhase(IntEnum):
    """The phase of a follower."""

    WAITING = 0
    MOVING = 1
    DONE = 2


class Reaction(IntEnum):
    """A follower's reaction to other actors."""

    NONE = 0
    BRAKES = 1


class FollowerCol(IntEnum):
    """Columns of ``Followers.state``."""

    S = 0
    """Arc length, metres."""
    SPEED = 1
    """m/s; before the start, the initial speed."""
    CURSOR = 2
    """Index of the path point at or before ``S``, relative to the path's beginning."""
    PHASE = 3
    START_TIME = 4
    REACTION = 5
    STAYS = 6
    """Whether it stays at its last point instead of being removed."""
    MAX_ACCELERATION = 7
    MAX_DECELERATION = 8
    LENGTH = 9
    WIDTH = 10
    WAITED = 11
    """Seconds for which it has stood, waiting for another."""
    WAITS_FOR = 12
    """Row of the actor that it waits for; -1 for none."""
    DECELERATION = 13
    """m/s² of its braking where its path plans it within the grip; 0: the path plans comfortably,
    and the follower corrects itself as it drives."""
    NEXT_STOP = 14
    """Index of the next path point at which it stands for a time, relative to the path's beginning;
    the number of its points if there is none."""
    LAST_STOP = 15
    """Index of the last such point that it has left; -1 for none."""
    STOOD = 16
    """Seconds for which it has stood at the next such point; -1 before it is there."""
