"""Conflicts of an ego with actors that have the right of way, at junctions and on crossings."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import shapely
from shapely import LineString, Polygon

from drivora_service.compilation import compiled
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.networks.projection import project_points
from drivora_service.networks.right_of_way import right_of_way
from drivora_service.networks.road_network import Connection, RoadNetwork
from drivora_service.networks.stop_lines import WayThrough
from drivora_service.observations.leaders import VEHICLES
from drivora_service.observations.line_crossings import Crossing
from drivora_service.observations.recorded_signals import signal_letter
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col, Role

_NEAR = 80.0
"""Radius around the ego in which others are considered, metres."""

_ALONE = 20.0
"""Metres ahead of a vehicle in which another actor is the reason for its braking."""

_MOVING = 0.5
"""m/s below which the ego is not in another actor's way."""

_CROSSING = re.compile(r":.+_c\d+_\d+")


class _Box(NamedTuple):
    """Length and width of an actor, metres."""

    length: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Conflict:
    """A conflict in which an ego went before an actor that has the right of way.

    Attributes:
        row: Row of the ego at which it took the right of way.
        other: Row of the actor in the trace.
        lag: Seconds from the ego's leaving a place to the other's reaching it; inf if never.
        braking: m/s² of the other's braking because of the ego.
        place: "junction" or "crossing".
    """

    row: int
    other: int
    lag: float
    braking: float
    place: str


def vehicle_conflicts(ego: EgoView, *, attention: float) -> Iterator[Conflict]:
    """Finds the vehicles with the right of way that the ego went before at junctions.

    Args:
        ego: The ego.
        attention: Seconds after the ego's passage within which others count.
    """
    if not ego.network.path.is_file():
        # SUMO's table of the right of way is in the network's file.
        return
    for crossing in ego.crossings:
        if len(crossing.ways) != 1 or not crossing.ways[0].inside:
            continue
        foes = _foes(ego, crossing, crossing.ways[0])
        if not foes:
            continue
        leaves = leaving_row(ego, crossing)
        last = min(leaves + round(attention / ego.step_length), ego.count - 1)
        for actor in ego.trace.actors:
            if actor.row == ego.row or actor.role not in VEHICLES:
                continue
            if not _drives_on(ego, actor.row, crossing.front, last, foes):
                continue
            lag = _lag(ego, actor.row, crossing.front, leaves, last)
            braking = _braking(ego, actor.row, crossing.front, leaves)
            if math.isfinite(lag):
                yield Conflict(
                    row=crossing.front, other=actor.row, lag=lag, braking=braking, place="junction"
                )


def walker_conflicts(ego: EgoView, *, attention: float) -> Iterator[Conflict]:
    """Finds the walkers with the right of way that the ego went before on crossings."""
    walkers = [actor for actor in ego.trace.actors if actor.role is Role.NPC_WALKER]
    if not walkers:
        return
    boxes = shapely.polygons(ego.corners)
    for area, entries in _crossings(ego.network):
        on = shapely.intersects(boxes, area) & (ego.speed >= _MOVING)
        if not on.any():
            continue
        first, leaves = int(np.argmax(on)), ego.count - 1 - int(np.argmax(on[::-1]))
        last = min(leaves + round(attention / ego.step_length), ego.count - 1)
        for walker in walkers:
            places = ego.trace.states[ego.first : ego.first + ego.count, walker.row]
            inside = shapely.contains_xy(area, places[:, Col.X], places[:, Col.Y])
            here = np.flatnonzero(inside[first : last + 1]) + first
            if not len(here):
                continue
            stepped = int(here[0])
            while stepped > 0 and inside[stepped - 1]:
                stepped -= 1
            if not any(_walker_first(ego, entry, stepped) for entry in entries):
                continue
            lag = _lag(ego, walker.row, first, leaves, last)
            if math.isfinite(lag):
                yield Conflict(row=first, other=walker.row, lag=lag, braking=0.0, place="crossing")


def _foes(ego: EgoView, crossing: Crossing, way: WayThrough) -> frozenset[int]:
    """Returns the lanes inside the junction with priority over the ego's movement."""
    letter = signal_letter(ego, way.connection, crossing.front)
    if letter is not None and letter != "g":
        return frozenset()
    table = right_of_way(ego.network)
    own = next((table.by_lane[lane] for lane in way.inside if lane in table.by_lane), None)
    if own is None:
        return frozenset()
    foes: set[int] = set()
    for lane in own.yields_to:
        foe = table.by_lane.get(lane)
        if foe is None or own.lanes[-1] in foe.yields_to:
            continue
        if letter is not None and not _may_go(ego, foe.incoming, foe.lanes, crossing.front):
            continue
        foes.update(foe.lanes)
    return frozenset(foes)


def _may_go(ego: EgoView, incoming: int, lanes: tuple[int, ...], row: int) -> bool:
    """Returns whether the signal of a movement is green."""
    if incoming < 0:
        return False
    for connection in ego.network.lanes[incoming].connections:
        if connection.to_lane in lanes:
            letter = signal_letter(ego, connection, row)
            return letter is None or letter in "Gg"
    return False


def leaving_row(ego: EgoView, crossing: Crossing) -> int:
    """Returns the first row of an ego after the junction behind a line, or its last one."""
    way = crossing.ways[0]
    inside = np.isin(ego.lanes, way.inside)
    inside[: crossing.front] = False
    rows = np.flatnonzero(inside)
    if not len(rows):
        return min(crossing.front + 1, ego.count - 1)
    behind = rows[-1] + 1
    length = ego.actor.length
    way_driven = np.cumsum(ego.moved)
    clear = np.flatnonzero(way_driven >= way_driven[min(behind, ego.count - 1)] + 0.5 * length)
    return int(clear[0]) if len(clear) else ego.count - 1


def _drives_on(ego: EgoView, other: int, first: int, last: int, lanes: frozenset[int]) -> bool:
    """Returns whether an actor is on one of some lanes in rows ``first`` to ``last``."""
    rows = slice(ego.first + first, ego.first + last + 1)
    states = ego.trace.states[rows, other]
    here = ego.trace.present[rows, other]
    if not here.any():
        return False
    away = np.hypot(
        states[:, Col.X] - ego.states[first : last + 1, Col.X],
        states[:, Col.Y] - ego.states[first : last + 1, Col.Y],
    )
    near = here & (away < _NEAR)
    if not near.any():
        return False
    found = project_points(
        ego.network, states[near][:, [Col.X, Col.Y]].copy(), states[near][:, Col.YAW].copy()
    )
    return bool(np.isin(found.lane, list(lanes)).any())


def _lag(ego: EgoView, other: int, first: int, leaves: int, last: int) -> float:
    """Returns the least seconds from the ego's being at a place to the other's being there."""
    actor = ego.trace.actors[other]
    rows = slice(ego.first, ego.first + ego.count)
    steps = _least_lag(
        ego.states,
        np.ascontiguousarray(ego.trace.states[rows, other]),
        np.ascontiguousarray(ego.trace.present[rows, other]),
        _Box(ego.actor.length, ego.actor.width),
        _Box(actor.length, actor.width),
        first,
        leaves,
        last,
    )
    return math.inf if steps < 0 else steps * ego.step_length


def _braking(ego: EgoView, other: int, first: int, leaves: int) -> float:
    """Returns the braking of another actor while only the ego was in its way, m/s²."""
    rows = slice(ego.first + first, ego.first + leaves + 1)
    states, present = ego.trace.states[rows], ego.trace.present[rows]
    yaw = states[:, other, Col.YAW]
    cos, sin = elementary.cos(yaw), elementary.sin(yaw)
    along = states[:, other, Col.AX] * cos + states[:, other, Col.AY] * sin
    speed = states[:, other, Col.VX] * cos + states[:, other, Col.VY] * sin
    braking = np.where(present[:, other] & (speed > 0.0), -along, 0.0)
    worst = int(np.argmax(braking))
    for actor in ego.trace.actors:
        if actor.row in (ego.row, other) or not present[worst, actor.row]:
            continue
        dx, dy = (states[worst, actor.row] - states[worst, other])[[Col.X, Col.Y]]
        ahead = dx * math.cos(yaw[worst]) + dy * math.sin(yaw[worst])
        across = abs(dy * math.cos(yaw[worst]) - dx * math.sin(yaw[worst]))
        if 0.0 < ahead < _ALONE and across < 2.5:
            return 0.0
    return max(float(braking[worst]), 0.0)


@lru_cache(maxsize=32)
def _crossings(network: RoadNetwork) -> tuple[tuple[Polygon, tuple[Connection, ...]], ...]:
    """Returns the areas of all crossings for walkers, and the connections to them."""
    entries: dict[int, list[Connection]] = {}
    for lane in network.lanes:
        for connection in lane.connections:
            entries.setdefault(connection.to_lane, []).append(connection)
    return tuple(
        (
            LineString(lane.shape).buffer(0.5 * lane.width, cap_style="flat"),
            tuple(entries.get(lane.index, ())),
        )
        for lane in network.lanes
        if lane.walkable and not lane.drivable and _CROSSING.fullmatch(lane.id)
    )


def _walker_first(ego: EgoView, entry: Connection, row: int) -> bool:
    letter = signal_letter(ego, entry, row)
    return entry.right_of_way == "M" if letter is None else letter in "Gg"


@compiled
def _least_lag(
    ego: FloatArray,
    other: FloatArray,
    present: BoolArray,
    own_box: _Box,
    box: _Box,
    first: int,
    leaves: int,
    last: int,
) -> int:
    """Returns the least rows from the ego's being at a place to the other's being there; or -1.

    Args:
        ego: (n, 9) its states, columns ``Col``.
        other: (n, 9) states of the other.
        present: (n,) flags of the other.
        own_box: Of the ego.
        box: Of the other.
        first: First row of the ego's places.
        leaves: Last row of its places.
        last: Last row of the other's.
    """
    best = last - first + 1
    reach = 0.5 * (math.hypot(own_box.length, own_box.width) + math.hypot(box.length, box.width))
    for t in range(first, leaves + 1):
        for u in range(t, min(t + best, last + 1)):
            if not present[u] or abs(other[u, Col.Z] - ego[t, Col.Z]) > LEVEL_GAP:
                continue
            dx, dy = other[u, Col.X] - ego[t, Col.X], other[u, Col.Y] - ego[t, Col.Y]
            if math.hypot(dx, dy) > reach:
                continue
            depth = overlap_depth(
                dx, dy, ego[t, Col.YAW], own_box.length, own_box.width,
                other[u, Col.YAW], box.length, box.width,
            )  # fmt: skip
            if depth > 0.0:
                best = u - t
                break
    return best if best <= last - first else -1
