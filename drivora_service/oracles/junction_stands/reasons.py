"""Reasons for an ego to stand in a junction: what it gives way to, and what is in its way."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.ops import substring

from drivora_service.geometry.array_shapes import BoolArray, IntArray
from drivora_service.networks.projection import project_points
from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.observations.leaders import VEHICLES
from drivora_service.observations.recorded_signals import signal_in_run
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, EgoCol, Light, Role
from drivora_service.oracles.junction_stands.paths import line_through
from drivora_service.oracles.junction_stands.room import (
    QUEUE_GAP,
    boxes_of,
    corridor_of,
    enters_without_room,
    on_level,
)
from drivora_service.oracles.junction_stands.stands import STRIP, JunctionStand

_MOVING = 0.5
"""m/s from which on an actor is taken to be coming."""

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
    if not entered_without_room(ego, stand):
        excused |= _in_the_way(ego, stand, rows)
    lights = ego.lights[list(stand.rows)]
    distance = ego.value(EgoCol.LIGHT_DISTANCE)[list(stand.rows)]
    with np.errstate(invalid="ignore"):
        excused |= (lights >= Light.YELLOW) & (distance >= 0.0) & (distance <= _needed(ego, stand))
    touched = [one.step for one in ego.trace.contacts if ego.row in (one.ego, one.other)]
    # After an accident, the ego stays where it happened.
    excused |= rows >= min(touched, default=ego.trace.step_count)
    return excused


def entered_without_room(ego: EgoView, stand: JunctionStand) -> bool:
    """Returns whether an ego entered the junction although there was no room for it behind it."""
    if stand.entered is None or stand.movement is None:
        return False
    return enters_without_room(ego, stand.path, stand.entered)


def _needed(ego: EgoView, stand: JunctionStand) -> float:
    """Returns the metres by which the ego must advance to leave the junction."""
    return max(stand.path.behind + ego.actor.length - stand.front, 0.0)


def _in_the_way(ego: EgoView, stand: JunctionStand, rows: IntArray) -> BoolArray:
    """Returns the rows in which an actor is in the way out of the junction."""
    end = stand.front + _needed(ego, stand) + QUEUE_GAP
    corridor = corridor_of(ego, stand.path.line, stand.front, end)
    shapely.prepare(corridor)
    found = np.zeros(len(rows), dtype=np.bool_)
    for actor in ego.trace.actors:
        if actor.row != ego.row:
            here = ego.trace.present[rows, actor.row]
            here &= on_level(ego, actor, rows, stand.rows[0])
            found[here] |= shapely.intersects(corridor, boxes_of(ego.trace, actor, rows[here]))
    return found


def _walkers_ahead(ego: EgoView, stand: JunctionStand, rows: IntArray) -> BoolArray:
    """Returns the rows in which a walker is in the way out, or about to be."""
    end = stand.front + _needed(ego, stand) + QUEUE_GAP
    corridor = corridor_of(ego, stand.path.line, stand.front, end)
    found = np.zeros(len(rows), dtype=np.bool_)
    for actor in ego.trace.actors:
        if actor.role is not Role.NPC_WALKER:
            continue
        states = ego.trace.states[rows, actor.row]
        here = ego.trace.present[rows, actor.row]
        here &= on_level(ego, actor, rows, stand.rows[0])
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
    ahead = substring(stand.path.line, stand.front - ego.actor.length, stand.path.behind).buffer(
        STRIP
    )
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
