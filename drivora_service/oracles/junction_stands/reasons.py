"""Reasons for an ego to stand in a junction: what it gives way to, and what is in its way."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring

from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import BoolArray, IntArray
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.projection import project_points
from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.observations.leaders import SAME_WAY, VEHICLES
from drivora_service.observations.recorded_signals import signal_in_run
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Actor, Col, EgoCol, Light, Role
from drivora_service.oracles.junction_stands.stands import STRIP, JunctionStand, line_through

_MOVING = 0.5
"""m/s from which on an actor is taken to be coming."""

_QUEUE_GAP = 2.0
"""Metres between vehicles that stand one behind the other."""

_QUEUE_SPEED = 1.0
"""m/s up to which a vehicle ahead is part of a queue, as in ``law_53_blocked_junction``."""

_NOTICE = 2.0
"""Seconds before its front passes the line by which an ego must have seen that its exit is not
free: it takes as long to notice that and to stop, as for a yellow light."""

_APPROACH = 150.0
"""Metres before a junction within which vehicles are taken to be coming to it."""

_STEP_ASIDE = 3.0
"""Seconds for which walkers are thought ahead."""


def excused_rows(ego: EgoView, stand: JunctionStand, *, headway: float) -> BoolArray:
    """Returns the (k,) flags of the rows of a stand in which the ego has a reason to stand.

    Args:
        ego: The ego.
        stand: Its stay in a junction.
        headway: Seconds within which a vehicle that goes first is a reason to wait.
    """
    rows = ego.first + np.array(stand.rows)
    excused = _coming_first(ego, stand, rows, headway) | _walkers_ahead(ego, stand, rows)
    if not entered_blocked(ego, stand):
        excused |= _in_the_way(ego, stand, rows)
    lights = ego.lights[list(stand.rows)]
    distance = ego.value(EgoCol.LIGHT_DISTANCE)[list(stand.rows)]
    with np.errstate(invalid="ignore"):
        excused |= (lights >= Light.YELLOW) & (distance >= 0.0) & (distance <= _needed(ego, stand))
    touched = [one.step for one in ego.trace.contacts if ego.row in (one.ego, one.other)]
    # A driver who has had an accident stays where it happened.
    excused |= rows >= min(touched, default=ego.trace.step_count)
    return excused


def entered_blocked(ego: EgoView, stand: JunctionStand) -> bool:
    """Returns whether an ego entered a junction although there was no room for it behind it.

    That is so if a vehicle, or anything else, already stood on its way, and the room before it was
    too short for the ego and for those that drove between them.
    """
    if stand.entered is None or stand.movement is None:
        return False
    notice = max(stand.entered - round(_NOTICE / ego.step_length), 0)
    return all(_exit_is_full(ego, stand, row) for row in (notice, stand.entered))


def _exit_is_full(ego: EgoView, stand: JunctionStand, row: int) -> bool:
    step = ego.first + row
    steps = np.array([step])
    start = float(stand.way.project(Point(*ego.location(row)))) + 0.5 * ego.actor.length
    corridor = _corridor(ego, stand, start, stand.way.length)
    found = []
    for actor in ego.trace.actors:
        if actor.row == ego.row or actor.role is Role.NPC_WALKER:
            continue
        if not ego.trace.present[step, actor.row] or not _on_level(ego, actor, steps, row)[0]:
            continue
        box = _boxes(ego, actor, steps)[0]
        if corridor.intersects(box):
            corners = shapely.points(shapely.get_coordinates(box)[:4])
            rear = float(shapely.line_locate_point(stand.way, corners).min())
            found.append((rear, actor))
    needed = ego.actor.length
    for rear, actor in sorted(found, key=lambda one: one[0]):
        if float(ego.trace.speeds(actor.row)[step]) <= _QUEUE_SPEED:
            return rear - stand.behind < needed
        if _goes_along(stand.way, rear, float(ego.trace.states[step, actor.row, Col.YAW])):
            needed += actor.length + _QUEUE_GAP
    return False


def _goes_along(way: LineString, s: float, yaw: float) -> bool:
    """Returns whether a heading is that of the way at a place, as of one that drives ahead."""
    here, further = way.interpolate(s), way.interpolate(s + 1.0)
    ahead = math.atan2(further.y - here.y, further.x - here.x)
    return abs(wrap_angle(yaw - ahead)) <= SAME_WAY


def _needed(ego: EgoView, stand: JunctionStand) -> float:
    """Returns the metres by which the ego must advance to leave the junction."""
    return max(stand.behind + ego.actor.length - stand.front, 0.0)


def _in_the_way(ego: EgoView, stand: JunctionStand, rows: IntArray) -> BoolArray:
    """Returns the rows in which an actor is in the way out of the junction."""
    end = stand.front + _needed(ego, stand) + _QUEUE_GAP
    corridor = _corridor(ego, stand, stand.front, end)
    shapely.prepare(corridor)
    found = np.zeros(len(rows), dtype=np.bool_)
    for actor in ego.trace.actors:
        if actor.row != ego.row:
            here = ego.trace.present[rows, actor.row]
            here &= _on_level(ego, actor, rows, stand.rows[0])
            found[here] |= shapely.intersects(corridor, _boxes(ego, actor, rows[here]))
    return found


def _walkers_ahead(ego: EgoView, stand: JunctionStand, rows: IntArray) -> BoolArray:
    """Returns the rows in which a walker is in the way out, or about to be."""
    end = stand.front + _needed(ego, stand) + _QUEUE_GAP
    corridor = _corridor(ego, stand, stand.front, end)
    found = np.zeros(len(rows), dtype=np.bool_)
    for actor in ego.trace.actors:
        if actor.role is not Role.NPC_WALKER:
            continue
        states = ego.trace.states[rows, actor.row]
        here = ego.trace.present[rows, actor.row]
        here &= _on_level(ego, actor, rows, stand.rows[0])
        for seconds in np.arange(0.0, _STEP_ASIDE + 0.5, 0.5):
            x = states[here, Col.X] + seconds * states[here, Col.VX]
            y = states[here, Col.Y] + seconds * states[here, Col.VY]
            found[here] |= shapely.distance(corridor, shapely.points(x, y)) <= 0.5 * actor.width
    return found


def _coming_first(ego: EgoView, stand: JunctionStand, rows: IntArray, headway: float) -> BoolArray:
    """Returns the rows in which a vehicle that goes first is about to cross the ego's way."""
    found = np.zeros(len(rows), dtype=np.bool_)
    if stand.movement is None:
        return found
    table = right_of_way(ego.network)
    ahead = substring(stand.way, stand.front - ego.actor.length, stand.behind).buffer(STRIP)
    first = [table.by_lane[lane] for lane in stand.movement.yields_to if lane in table.by_lane]
    crossing = [
        foe for foe in first if line_through(ego.network, foe.lanes).buffer(STRIP).intersects(ahead)
    ]
    if not crossing:
        return found
    approaches = [_approach(ego, foe) for foe in crossing]
    reds = [_red(ego, foe, rows) for foe in crossing]
    for actor in ego.trace.actors:
        if actor.row == ego.row or actor.role not in VEHICLES:
            continue
        states = ego.trace.states[rows, actor.row]
        speed = np.hypot(states[:, Col.VX], states[:, Col.VY])
        here = np.flatnonzero(ego.trace.present[rows, actor.row] & (speed > _MOVING))
        if not len(here):
            continue
        on = project_points(
            ego.network, states[here][:, [Col.X, Col.Y]].copy(), states[here][:, Col.YAW].copy()
        )
        for foe, approach, red in zip(crossing, approaches, reds, strict=True):
            found[here[np.isin(on.lane, foe.lanes)]] = True
            for lane, beyond in approach.items():
                there = on.lane == lane
                away = beyond + float(ego.network.lanes[lane].arc[-1]) - on.s[there]
                soon = away <= headway * speed[here[there]]
                found[here[there][soon]] |= ~red[here[there][soon]]
    return found


def _approach(ego: EgoView, foe: Movement) -> dict[int, float]:
    """Returns the lanes that lead to a movement, with the metres from their ends to its start."""
    table = right_of_way(ego.network)
    found: dict[int, float] = {}
    ahead = [(foe.incoming, 0.0)] if foe.incoming >= 0 else []
    while ahead:
        lane, beyond = ahead.pop(0)
        if lane in found or beyond > _APPROACH:
            continue
        found[lane] = beyond
        length = float(ego.network.lanes[lane].arc[-1])
        ahead += [(before, beyond + length) for before in table.before.get(lane, ())]
    return found


def _red(ego: EgoView, foe: Movement, rows: IntArray) -> BoolArray:
    """Returns the rows in which the signal of a movement is red."""
    red = np.zeros(len(rows), dtype=np.bool_)
    if foe.incoming >= 0:
        for connection in ego.network.lanes[foe.incoming].connections:
            if connection.to_lane in foe.lanes:
                shown = signal_in_run(ego.trace, connection)
                if shown is not None:
                    red = shown[rows] == Light.RED
    return red


def _corridor(ego: EgoView, stand: JunctionStand, start: float, end: float) -> BaseGeometry:
    """Returns the area that the ego needs along a part of its way."""
    part = substring(stand.way, min(start, stand.way.length), end)
    if not isinstance(part, LineString):
        return Point()
    return part.buffer(0.5 * ego.actor.width, cap_style="flat")


def _boxes(ego: EgoView, actor: Actor, rows: IntArray) -> NDArray[np.object_]:
    """Returns the (k,) boxes of an actor in rows of the trace in which it is present."""
    states = ego.trace.states[rows, actor.row]
    corners = box_corners(
        states[:, Col.X], states[:, Col.Y], states[:, Col.YAW], actor.length, actor.width
    )
    boxes: NDArray[np.object_] = np.asarray(shapely.polygons(corners))
    return boxes


def _on_level(ego: EgoView, actor: Actor, rows: IntArray, row: int) -> BoolArray:
    """Returns whether an actor is on the level of the ego in rows of the trace."""
    height = ego.states[row, Col.Z]
    level: BoolArray = np.abs(ego.trace.states[rows, actor.row, Col.Z] - height) <= LEVEL_GAP
    return level
