"""Conflicts of an ego with walkers that have the right of way on crossings."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import lru_cache

import numpy as np
import shapely
from shapely import LineString, Polygon, STRtree

from drivora_service.networks.right_of_way import right_of_way
from drivora_service.networks.road_network import Connection, RoadNetwork
from drivora_service.observations.recorded_signals import signal_letter, signal_shown
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, Light, Role
from drivora_service.observations.yielding.conflict import Conflict
from drivora_service.observations.yielding.encroachment import least_lag

_MOVING = 0.5
"""m/s below which the ego is not in another actor's way."""

_CROSSING = re.compile(r":.+_c\d+_\d+")


def walker_conflicts(ego: EgoView, *, attention: float) -> Iterator[Conflict]:
    """Finds the walkers with the right of way that the ego went before on crossings."""
    walkers = [actor for actor in ego.trace.actors if actor.role is Role.NPC_WALKER]
    if not walkers:
        return
    boxes = shapely.polygons(ego.corners)
    for crossing, area, entries in _crossings(ego.network):
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
            signs = [_signalled(ego, entry, stepped) for entry in entries]
            if any(sign is not None for sign in signs):
                goes_first = any(signs)
            else:
                goes_first = _gives_way_on(ego, crossing, entries, first)
            if not goes_first:
                continue
            lag = least_lag(ego, walker.row, first, leaves, last)
            if math.isfinite(lag):
                yield Conflict(row=first, other=walker.row, lag=lag, braking=0.0, place="crossing")


def gives_way_to_walkers(ego: EgoView) -> bool:
    """Returns whether walkers go before the ego on a crossing that it drove over, if any come."""
    crossings = _crossings(ego.network)
    moving = np.flatnonzero(ego.speed >= _MOVING)
    if not crossings or not len(moving):
        return False
    boxes = shapely.polygons(ego.corners[moving])
    rows, places = _crossing_tree(ego.network).query(boxes, predicate="intersects")
    for place in np.unique(places).tolist():
        on = moving[rows[places == place]]
        crossing, _, entries = crossings[place]
        shown = [
            signal[on.min() : on.max() + 1]
            for entry in entries
            if (signal := signal_shown(ego, entry)) is not None
        ]
        if shown:
            goes_first = any((signal == Light.GREEN).any() for signal in shown)
        else:
            goes_first = _gives_way_on(ego, crossing, entries, int(on.min()))
        if goes_first:
            return True
    return False


@lru_cache(maxsize=32)
def _crossing_tree(network: RoadNetwork) -> STRtree:
    return STRtree([area for _, area, _ in _crossings(network)])


@lru_cache(maxsize=32)
def _crossings(
    network: RoadNetwork,
) -> tuple[tuple[int, Polygon, tuple[Connection, ...]], ...]:
    """Returns the lanes of all crossings for walkers, their areas, and the connections to them."""
    entries: dict[int, list[Connection]] = {}
    for lane in network.lanes:
        for connection in lane.connections:
            entries.setdefault(connection.to_lane, []).append(connection)
    return tuple(
        (
            lane.index,
            LineString(lane.shape).buffer(0.5 * lane.width, cap_style="flat"),
            tuple(entries.get(lane.index, ())),
        )
        for lane in network.lanes
        if lane.walkable and not lane.drivable and _CROSSING.fullmatch(lane.id)
    )


def _signalled(ego: EgoView, entry: Connection, row: int) -> bool | None:
    """Returns whether walkers have a green signal in a row; None without a signal."""
    letter = signal_letter(ego, entry, row)
    return None if letter is None else letter in "Gg"


def _gives_way_on(ego: EgoView, crossing: int, entries: tuple[Connection, ...], first: int) -> bool:
    """Returns whether walkers go before the ego on a crossing without a signal.

    By the network's table for the ego's movement through the junction: a vehicle that turns may
    have to give way on a crossing on which one that drives straight on has not. By the crossing's
    own sign if the ego drives no movement.
    """
    junction, _, _ = ego.network.lanes[crossing].id.rpartition("_c")
    table = right_of_way(ego.network).by_lane if ego.network.path.is_file() else {}
    rows = [
        k
        for k, lane in enumerate(ego.lanes.tolist())
        if lane in table and f":{table[lane].junction}" == junction
    ]
    if not rows:
        return any(entry.right_of_way == "M" for entry in entries)
    # The passage of the junction that lies nearest to the ego's coming to the crossing.
    row = min(rows, key=lambda k: abs(k - first))
    return crossing in table[int(ego.lanes[row])].gives_way_on
