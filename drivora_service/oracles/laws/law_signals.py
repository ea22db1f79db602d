"""The signals that formulas can name: quantities of an ego at every row, with unit and scale.

A signal that does not apply in a row (no vehicle ahead, no stop line) has the value that its
description names, far beyond any threshold: a comparison is then plainly true or plainly false.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Light
from drivora_service.oracles.laws.junction_signals import (
    at_signal,
    entered_without_room,
    junction_distance,
    turn_angle,
    turned,
    turning,
    wrong_lane,
    yielding,
)
from drivora_service.oracles.laws.lane_signals import has_lane_beside, lane_change
from drivora_service.oracles.laws.motion_signals import (
    acceleration,
    light_distance,
    shows_light,
    speed_limit,
)
from drivora_service.oracles.laws.signal_records import Signal, flag, measure
from drivora_service.oracles.laws.traffic_signals import (
    closing_from_behind,
    leader_gap,
    leader_speed,
    required_braking,
    time_to_collision,
    walker_distance,
)
from drivora_service.oracles.laws.units import ACCELERATION, METRE, RADIAN, SECOND, SPEED

FAR = 1000.0
"""Metres, or seconds: a place or a moment that there is none of."""

FAST = 100.0
"""m/s: a speed above any that is driven."""


SIGNALS: tuple[Signal, ...] = (
    measure("speed", SPEED, 10.0, "Speed over ground.", lambda ego: ego.speed),
    measure(
        "acceleration",
        ACCELERATION,
        5.0,
        "Acceleration along the heading; negative while the ego brakes.",
        acceleration,
    ),
    measure("speed_limit", SPEED, 10.0, "Speed limit of the ego's lane.", speed_limit, FAST),
    flag(
        "light_red",
        "The next signal on the route shows red.",
        lambda ego: shows_light(ego, Light.RED),
    ),
    flag(
        "light_yellow",
        "The next signal on the route shows yellow.",
        lambda ego: shows_light(ego, Light.YELLOW),
    ),
    flag(
        "light_green",
        "The next signal on the route shows green.",
        lambda ego: shows_light(ego, Light.GREEN),
    ),
    measure(
        "light_distance",
        METRE,
        20.0,
        "From the front bumper to the stop line of the next signal on the route; negative from the "
        "front's passing the line to the tail's.",
        light_distance,
        FAR,
    ),
    measure(
        "junction_distance",
        METRE,
        20.0,
        "From the front bumper along the ego's lane to its end before a junction; up to 150 m.",
        junction_distance,
        FAR,
    ),
    flag(
        "in_junction",
        "The ego's centre is on a lane inside a junction.",
        lambda ego: ego.in_junction.astype(np.float64),
    ),
    flag(
        "turning_left",
        "The ego turns left in a junction: from its front's passing the stop line to its leaving "
        "the junction.",
        lambda ego: turning(ego, "lL"),
    ),
    flag(
        "turning_right",
        "The ego turns right in a junction, over the same rows.",
        lambda ego: turning(ego, "rR"),
    ),
    flag(
        "turning_around",
        "The ego turns around in a junction, over the same rows.",
        lambda ego: turning(ego, "t"),
    ),
    flag(
        "turning",
        "The ego turns left, right or around in a junction, over the same rows.",
        lambda ego: turning(ego, "lLrRt"),
    ),
    measure(
        "turn_angle",
        RADIAN,
        1.0,
        "Over the same rows: angle between the lanes before and behind the ego's movement.",
        turn_angle,
        0.0,
    ),
    measure(
        "turned",
        RADIAN,
        1.0,
        "Over the same rows: angle between the ego's heading and the lane before its movement.",
        turned,
        0.0,
    ),
    flag(
        "at_signal",
        "The ego's movement through the junction has a signal that is in operation, over the same "
        "rows.",
        at_signal,
    ),
    flag(
        "wrong_lane",
        "The ego's movement through the junction is not permitted from the lane that it came in "
        "on, over the same rows.",
        wrong_lane,
    ),
    flag(
        "entered_without_room",
        "The ego's movement through the junction began although what stood on its way left no room "
        "for it behind the junction, over the same rows.",
        entered_without_room,
    ),
    measure(
        "yield_gap",
        SECOND,
        2.0,
        "In the row in which the ego's front enters a junction before a vehicle with the right of "
        "way: from the ego's leaving a place to that vehicle's reaching it.",
        lambda ego: yielding(ego).gap,
        FAR,
    ),
    measure(
        "yield_braking",
        ACCELERATION,
        5.0,
        "In the same row: the hardest braking of that vehicle while only the ego was in its way.",
        lambda ego: yielding(ego).braking,
        0.0,
    ),
    measure(
        "walker_yield_gap",
        SECOND,
        2.0,
        "In the row in which the ego comes onto a crossing before a walker with the right of way: "
        "from the ego's leaving a place to that walker's reaching it.",
        lambda ego: yielding(ego).walker_gap,
        FAR,
    ),
    flag(
        "fast_lane",
        "The ego is on the leftmost of two or more lanes of its direction.",
        lambda ego: has_lane_beside(ego, left=False, right=True),
    ),
    flag(
        "slow_lane",
        "The ego is on the rightmost of two or more lanes of its direction.",
        lambda ego: has_lane_beside(ego, left=True, right=False),
    ),
    flag(
        "lane_change_left",
        "In this row the ego's centre has come into the lane to its left.",
        lambda ego: lane_change(ego, to_left=True),
    ),
    flag(
        "lane_change_right",
        "In this row the ego's centre has come into the lane to its right.",
        lambda ego: lane_change(ego, to_left=False),
    ),
    flag(
        "lane_change",
        "In this row the ego's centre has come into the lane to its left or right.",
        lambda ego: lane_change(ego, to_left=True) + lane_change(ego, to_left=False),
    ),
    measure(
        "leader_gap",
        METRE,
        20.0,
        "To the vehicle ahead that goes the same way, in the strip of the ego's width.",
        leader_gap,
        FAR,
    ),
    measure(
        "leader_speed",
        SPEED,
        10.0,
        "Speed of that vehicle along the ego's heading.",
        leader_speed,
        FAST,
    ),
    measure(
        "follower_time",
        SECOND,
        4.0,
        "In the 2 s after a change of lanes: until the vehicle behind in the strip of the ego's "
        "width would touch it, at the speeds of the row.",
        closing_from_behind,
        FAR,
    ),
    measure(
        "time_to_collision",
        SECOND,
        4.0,
        "Until the first contact with an actor that is not behind, at the velocities of the row; "
        "at most 10 s ahead.",
        time_to_collision,
        FAR,
    ),
    measure(
        "required_braking",
        ACCELERATION,
        5.0,
        "Deceleration that keeps the ego from the actor ahead.",
        required_braking,
        FAST,
    ),
    measure(
        "walker_distance",
        METRE,
        20.0,
        "To the nearest walker, between the circles around both boxes.",
        walker_distance,
        FAR,
    ),
)
"""All signals, by subject."""

BY_NAME = {signal.name: signal for signal in SIGNALS}

_RECORDED: WeakKeyDictionary[EgoView, dict[str, FloatArray]] = WeakKeyDictionary()


def signal_values(ego: EgoView, name: str) -> FloatArray:
    """Returns the (n,) values of a signal of an ego; computed once for all laws."""
    known = _RECORDED.setdefault(ego, {})
    if name not in known:
        signal = BY_NAME[name]
        values = signal.values(ego)
        known[name] = np.where(np.isnan(values), signal.absent, values)
    return known[name]
