"""Bit masks that SUMO takes: what a vehicle regards, when it changes lanes, where it is placed.

Source: SUMO's documentation, *Change Vehicle State* of TraCI: speed mode, lane change mode, and
``keepRoute`` of ``moveToXY``.
"""

from __future__ import annotations

from enum import IntFlag


class SpeedMode(IntFlag):
    """What limits the speed that a vehicle chooses; without any, it keeps the speed that is set."""

    SAFE_SPEED = 1 << 0
    MAX_ACCELERATION = 1 << 1
    MAX_DECELERATION = 1 << 2
    RIGHT_OF_WAY = 1 << 3
    """Of vehicles that approach a junction."""
    RED_LIGHTS = 1 << 4


NO_SPEED_LIMITS = int(SpeedMode(0))
OBEYS_ALL = int(
    SpeedMode.SAFE_SPEED
    | SpeedMode.MAX_ACCELERATION
    | SpeedMode.MAX_DECELERATION
    | SpeedMode.RIGHT_OF_WAY
    | SpeedMode.RED_LIGHTS
)
"""SUMO's default."""


class LaneChangeMode(IntFlag):
    """For what a vehicle changes lanes, two bits for each purpose.

    The lower bit allows changes that do not conflict with a request by TraCI, which Drivora never
    makes; without any, the vehicle keeps its lane.
    """

    STRATEGIC = 0b01 << 0
    """To follow its route."""
    COOPERATIVE = 0b01 << 2
    SPEED_GAIN = 0b01 << 4
    KEEP_RIGHT = 0b01 << 6
    RESPECT_GAPS = 0b10 << 8
    """Others' speeds and the gaps that they need to brake are respected."""
    SUBLANE = 0b01 << 10


KEEPS_LANE = int(LaneChangeMode(0))
CHANGES_LANES = int(
    LaneChangeMode.STRATEGIC
    | LaneChangeMode.COOPERATIVE
    | LaneChangeMode.SPEED_GAIN
    | LaneChangeMode.KEEP_RIGHT
    | LaneChangeMode.RESPECT_GAPS
    | LaneChangeMode.SUBLANE
)
"""SUMO's default."""


class Placing(IntFlag):
    """Where a vehicle may be placed."""

    ON_ROUTE = 1 << 0
    """Only on the lanes of its route."""
    ANYWHERE = 1 << 1
    """At any pose, on a lane open to it if one is near."""
    ANY_LANE = 1 << 2
    """On lanes that are not open to it, too. With ``ANYWHERE`` as well, SUMO 1.28 crashed under a
    walker on a junction with crossings: not used."""
