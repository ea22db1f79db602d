"""The passage of a party through the junction of the collision."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from shapely import LineString, Point
from shapely.geometry.base import BaseGeometry

from drivora_service.geometry.angles import wrap_angle
from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.observations.trace import Col
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.scene import Scene

_FARTHEST = 1.3
"""Mean metres from the middle of a way through the junction up to which an actor follows it."""

_TURN_WEIGHT = 2.0
"""Metres that count for a radian between an actor's heading and a way."""

_LEAST = 0.5
"""Least time that is compared with a way, seconds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Passage:
    """An actor's way through a junction.

    Attributes:
        movement: The way that it followed; None if it followed none.
        entered: Row of the trace at which it came into the junction.
        red: Whether its signal was red then; None if there is no signal.
        link: Traffic light and index of its signal there, or None.
        area: Area of the lanes that it may use: before, in and behind the junction.
    """

    movement: Movement | None
    entered: int
    red: bool | None
    link: tuple[str, int] | None
    area: BaseGeometry | None


def junction_of(scene: Scene) -> str | None:
    """Returns the id of the junction in which the two touched, None outside junctions."""
    if scene.road_lanes() or not scene.network.path.is_file():
        return None
    table = right_of_way(scene.network).by_lane
    for tolerance in (0.0, 1.0):
        inside = [
            table[lane].junction
            for lane in scene.areas.drivable_at(scene.impact.place, tolerance)
            if lane in table
        ]
        if inside:
            return max(sorted(set(inside)), key=inside.count)
    return None


def passage(scene: Scene, party: Party, junction: str) -> Passage:
    """Finds the way of a party through a junction."""
    table = right_of_way(scene.network).by_lane
    movements = {
        movement.lanes: movement for movement in table.values() if movement.junction == junction
    }
    inside = scene.areas.union({lane for lanes in movements for lane in lanes})
    touching = np.array([box.intersects(inside) for box in party.boxes])
    outside = np.flatnonzero(~touching)
    first = int(outside[-1]) + 1 if len(outside) else 0
    first = min(first, party.count - 1)
    begin = max(0, min(first, party.count - 1 - round(_LEAST / party.step_length)))
    costs = {lanes: _cost(scene, party, movement, begin) for lanes, movement in movements.items()}
    best = min(sorted(costs), key=lambda lanes: costs[lanes], default=None)
    if best is None or costs[best] > _FARTHEST:
        return Passage(movement=None, entered=party.step(first), red=None, link=None, area=None)
    movement = movements[best]
    link = find_signal(scene, movement)
    return Passage(
        movement=movement,
        entered=party.step(first),
        red=None if link is None else signal_is_red(scene, link, party.step(first)),
        link=link,
        area=scene.areas.union(_chain(scene, movement)),
    )


def signal_is_red(scene: Scene, link: tuple[str, int], step: int) -> bool:
    """Returns whether a signal was red at a row of the trace."""
    light, place = link
    trace = scene.trace
    if light not in trace.light_ids:
        return False
    shown = trace.light_state_names[int(trace.light_states[step, trace.light_ids.index(light)])]
    return 0 <= place < len(shown) and shown[place] in "ru"


def find_signal(scene: Scene, movement: Movement) -> tuple[str, int] | None:
    """Returns the traffic light of a movement and its place there; None without one."""
    if movement.incoming < 0:
        return None
    for connection in scene.network.lanes[movement.incoming].connections:
        if connection.to_lane == movement.lanes[0] and connection.traffic_light:
            return connection.traffic_light, connection.link_index
    return None


def _chain(scene: Scene, movement: Movement) -> list[int]:
    lanes = list(movement.lanes)
    behind = scene.network.lanes[lanes[-1]].connections
    return [
        *([movement.incoming] if movement.incoming >= 0 else []),
        *lanes,
        *(connection.to_lane for connection in behind),
    ]


def _cost(scene: Scene, party: Party, movement: Movement, begin: int) -> float:
    """Returns how far an actor was from a way through the junction, metres."""
    lanes = [scene.network.lanes[lane] for lane in _chain(scene, movement)]
    line = LineString(np.vstack([lane.shape for lane in lanes]))
    costs = []
    for k in range(begin, party.count):
        x, y = party.place(k)
        s = line.project(Point(x, y))
        foot, ahead = line.interpolate(s), line.interpolate(min(s + 0.5, line.length))
        behind = line.interpolate(max(s - 0.5, 0.0))
        heading = math.atan2(ahead.y - behind.y, ahead.x - behind.x)
        turn = abs(wrap_angle(float(party.states[k, Col.YAW]) - heading))
        costs.append(float(np.hypot(x - foot.x, y - foot.y)) + _TURN_WEIGHT * turn)
    return float(np.mean(costs))
