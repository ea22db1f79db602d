"""Breaches by the ego that led to a collision, which a careful driver would not have committed.

A driver who makes the danger cannot plead that there was no time left to avoid it. So the breach
must have to do with the collision: the ego still was where it might not be, it did not keep the
distance to the vehicle that it ran into, it set off towards what stood in its way, or at the speed
limit it could have braked.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.observations.leaders import SAME_WAY
from drivora_service.observations.line_crossings import Crossing
from drivora_service.observations.run_view import BorderCol, EgoView
from drivora_service.observations.trace import Col, EgoCol, Light
from drivora_service.observations.yielding.vehicle_conflicts import leaving_row
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.speeding import Speeding, overspeed
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.tailgating import Tailgating

OUTSIDE = 0.3
"""Tolerance in metres beyond the road of the ego's own direction (nuPlan)."""

_AFTER_JUNCTION = 2.0
"""Seconds after the ego has left a junction in which a stop that it did not make there counts: the
time in which traffic that comes from the side reaches it."""

_SET_OFF = 4.0
"""Seconds before the contact in which setting off led to it; the foresight of a careful driver."""

_STOOD = 0.1
"""m/s below which an actor stands."""


class Breach(StrEnum):
    """A breach by the ego that excludes a careful driver."""

    RED_LIGHT = "red_light"
    """It was inside a junction that it had entered on red."""
    OFF_ITS_SIDE = "off_its_side"
    """It was off the road, or on the side of the other direction."""
    STOP_SIGN = "stop_sign"
    """It had driven past a stop sign at the junction, or just before."""
    FAILURE_TO_YIELD = "failure_to_yield"
    """It went before the other, which had the right of way."""
    MANOEUVRE = "manoeuvre"
    """It came into the way of the other by a manoeuvre for which it is responsible."""
    TAILGATING = "tailgating"
    """It followed the other too closely when the risk became perceptible."""
    SETTING_OFF = "setting_off"
    """It had stood, and set off towards an actor that stood in its way and was in sight."""
    SPEEDING = "speeding"
    """It drove faster than allowed then; at the limit, braking would have been in time."""


BREACH_IN_WORDS = {
    Breach.RED_LIGHT: "came into the junction on red",
    Breach.OFF_ITS_SIDE: "left its side of the road",
    Breach.STOP_SIGN: "drove past a stop sign",
    Breach.FAILURE_TO_YIELD: "took the right of way",
    Breach.MANOEUVRE: "came into the way of the other",
    Breach.TAILGATING: "began to follow too closely",
    Breach.SETTING_OFF: "set off towards what stood in its way",
    Breach.SPEEDING: "began to drive too fast",
}
"""What the ego did, by its breach."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnBreach:
    """A breach by the ego that led to a collision.

    Attributes:
        kind: The breach.
        row: The ego's row in which it began.
    """

    kind: Breach
    row: int


def find_own_breach(
    ego: EgoView,
    k: int,
    counterpart: int,
    perceived: int,
    *,
    in_time_at_limit: Callable[[], bool],
    manoeuvre: int | None = None,
    was_hidden: bool = False,
) -> OwnBreach | None:
    """Returns the ego's breach that led to a collision, the gravest first; None without one.

    Args:
        ego: The ego.
        k: Its row at the contact.
        counterpart: Row of the other actor in the trace.
        perceived: The ego's row from which on the risk was perceptible; ``k`` if it was not.
        in_time_at_limit: Returns whether the careful driver would have braked in time from there on
            if the ego had kept the speed limit.
        manoeuvre: The ego's row in which it came into the way of the other by a manoeuvre for which
            it is responsible; None without one.
        was_hidden: Whether the other came into sight only when the risk became perceptible.
    """
    # One after the other, as some of them take long to find.
    candidates = _breaches(ego, k, counterpart, perceived, in_time_at_limit, manoeuvre, was_hidden)
    return next(candidates, None)


def _breaches(
    ego: EgoView,
    k: int,
    counterpart: int,
    perceived: int,
    in_time_at_limit: Callable[[], bool],
    manoeuvre: int | None,
    was_hidden: bool,
) -> Iterator[OwnBreach]:
    if (row := _find_astray(ego, k)) is not None:
        yield OwnBreach(kind=Breach.OFF_ITS_SIDE, row=row)
    if (row := _find_red_entry(ego, k)) is not None:
        yield OwnBreach(kind=Breach.RED_LIGHT, row=row)
    if (row := _find_stop_run(ego, k, counterpart)) is not None:
        yield OwnBreach(kind=Breach.STOP_SIGN, row=row)
    if (row := _find_right_of_way_taken(ego, k, counterpart)) is not None:
        yield OwnBreach(kind=Breach.FAILURE_TO_YIELD, row=row)
    if manoeuvre is not None:
        yield OwnBreach(kind=Breach.MANOEUVRE, row=max(manoeuvre, 0))
    if (row := _find_tailgating(ego, counterpart, perceived)) is not None:
        yield OwnBreach(kind=Breach.TAILGATING, row=row)
    if not was_hidden and (row := _find_setting_off(ego, k, counterpart)) is not None:
        yield OwnBreach(kind=Breach.SETTING_OFF, row=row)
    if (row := _find_speeding(ego, perceived)) is not None and in_time_at_limit():
        yield OwnBreach(kind=Breach.SPEEDING, row=row)


def _find_astray(ego: EgoView, k: int) -> int | None:
    """Returns the row since which an ego that is off its side in row ``k`` has been there."""
    return _since(_astray(ego), k)


def _since(flags: BoolArray, k: int) -> int | None:
    """Returns the first row of the flagged stretch that includes row ``k``; None without one."""
    if not flags[k]:
        return None
    unset = np.flatnonzero(~flags[:k])
    return int(unset[-1]) + 1 if len(unset) else 0


def _astray(ego: EgoView) -> BoolArray:
    """Returns (n,) whether it was off the road, or beyond the road of its direction.

    Inside junctions, where lanes of all directions overlap, only the former counts.
    """
    turn = elementary.cos(ego.states[:, Col.YAW] - ego.value(EgoCol.LANE_HEADING))
    with np.errstate(invalid="ignore"):
        left = ego.room_beside[:, BorderCol.LEFT] < -OUTSIDE
        oncoming = (left | (turn < 0.0)) & ~ego.in_junction
    astray: BoolArray = oncoming | (ego.outside > OUTSIDE)
    return astray


def _find_red_entry(ego: EgoView, k: int) -> int | None:
    """Returns the row in which the ego passed the stop line of its present junction on red."""
    if not ego.in_junction[k]:
        return None
    distance = ego.value(EgoCol.LIGHT_DISTANCE)
    row = k
    while row > 0 and not (distance[row] < 0.0 <= distance[row - 1]):
        if not (ego.in_junction[row] or distance[row] < 0.0):
            return None
        row -= 1
    return row if row and ego.lights[row] == Light.RED else None


def _find_stop_run(ego: EgoView, k: int, counterpart: int) -> int | None:
    """Returns the row in which the ego drove past the stop sign of a junction that it was in.

    An actor that followed it over the line is not one for which it had to stop.
    """
    oracle = StopSign()
    for crossing in reversed(ego.crossings):
        if crossing.front > k or not _is_concerned(ego, crossing, k):
            continue
        passage = oracle.judge_passage(ego, crossing)
        if passage is None or not passage.ran or _follows(ego, passage.row, counterpart):
            continue
        return passage.row
    return None


def _is_concerned(ego: EgoView, crossing: Crossing, k: int) -> bool:
    after = round(_AFTER_JUNCTION / ego.step_length)
    if len(crossing.ways) == 1 and crossing.ways[0].inside:
        return k <= leaving_row(ego, crossing) + after
    return k <= crossing.front + after


def _follows(ego: EgoView, k: int, other: int) -> bool:
    """Returns whether an actor is behind the ego on its way in row ``k``."""
    if not ego.trace.present[ego.first + k, other]:
        return False
    state, own = ego.trace.states[ego.first + k, other], ego.states[k]
    dx, dy = state[Col.X] - own[Col.X], state[Col.Y] - own[Col.Y]
    cos, sin = math.cos(own[Col.YAW]), math.sin(own[Col.YAW])
    ahead, across = dx * cos + dy * sin, abs(dy * cos - dx * sin)
    reach = 0.5 * (ego.actor.width + ego.trace.actors[other].width)
    same_way = math.cos(state[Col.YAW] - own[Col.YAW]) >= math.cos(SAME_WAY)
    return bool(ahead < 0.0 and across < reach and same_way)


def _find_right_of_way_taken(ego: EgoView, k: int, counterpart: int) -> int | None:
    """Returns the row in which the ego took the right of way of the actor that it touched."""
    oracle = FailureToYield()
    for conflict in oracle.find_conflicts(ego):
        recent = conflict.row <= k and conflict.other == counterpart
        if recent and oracle.hinders(conflict):
            return conflict.row
    return None


def _find_tailgating(ego: EgoView, counterpart: int, perceived: int) -> int | None:
    """Returns the row since which the ego followed the other too closely as the risk came up."""
    oracle = Tailgating()
    ahead, needed = oracle.measure(ego)
    near = (ahead.room < needed) & ahead.same_way & (ahead.actor == counterpart)
    # A vehicle that has just cut in leaves the driver behind some time to fall back.
    row = _since(near, min(perceived, ego.count - 1))
    if row is None or (perceived - row) * ego.step_length < oracle.duration - 1e-9:
        return None
    return row


def _find_setting_off(ego: EgoView, k: int, counterpart: int) -> int | None:
    """Returns the row in which an ego set off towards an actor that stood in its way till then.

    The motion of an ego that stands meets nothing, so that the risk becomes perceptible only when
    it already moves. A driver who looks ahead does not set off.
    """
    stood = np.flatnonzero(np.hypot(ego.states[:k, Col.VX], ego.states[:k, Col.VY]) < _STOOD)
    if not len(stood):
        return None
    row = int(stood[-1])
    if (k - row) * ego.step_length > _SET_OFF + 1e-9:
        return None
    since = slice(ego.first + row, ego.first + k)
    if not ego.trace.present[since, counterpart].all():
        return None
    other = ego.trace.states[since, counterpart]
    stays = bool((np.hypot(other[:, Col.VX], other[:, Col.VY]) < _STOOD).all())
    return row if stays else None


def _find_speeding(ego: EgoView, perceived: int) -> int | None:
    """Returns the row since which the ego was too fast as the risk came up."""
    limit = ego.value(EgoCol.SPEED_LIMIT)
    return _since(overspeed(ego) > Speeding().excess * np.nan_to_num(limit), perceived)
