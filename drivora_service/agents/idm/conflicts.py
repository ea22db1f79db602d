"""The conflict zones of an agent's route, where others cross it in junctions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute, LaneRun

_CLEAR_WIDTH = 2.6
"""Two lines nearer than this cannot be driven side by side, metres: a car's width and a margin."""
_APPROACH = 90.0
_SPACING = 2.0


class LineCol(IntEnum):
    """Columns of lines with their arc length, metres."""

    X = 0
    Y = 1
    ARC = 2


class ZoneCol(IntEnum):
    """Columns of ``Conflicts.zones``; places are metres of arc length."""

    ENTER = 0
    """Begin of the zone on the run's line."""
    LEAVE = 1
    """Its end on the run's line."""
    GATE = 2
    """The stop line before the junction, on the run's line."""
    EXIT = 3
    """End of the junction, on the run's line."""
    YIELDS = 4
    """1 if the other movement has the right of way."""
    SIGNALISED = 5
    """1 if a traffic light controls the junction."""
    FOE_ENTER = 6
    """Begin of the zone on the foe's line."""
    FOE_LEAVE = 7
    """Its end on the foe's line."""


class Conflicts(NamedTuple):
    """Conflict zones of one lane run, in order along it.

    Attributes:
        zones: (C, 8), columns ``ZoneCol``.
        first: (C + 1,) begin of each foe's line in ``foes``.
        foes: (n, 3) the foes' lines, columns ``LineCol``: approach and way through the junction,
            concatenated.
    """

    zones: FloatArray
    first: IntArray
    foes: FloatArray


def _chain_line(network: RoadNetwork, lanes: Sequence[int]) -> FloatArray:
    points = np.concatenate([network.lanes[lane].shape for lane in lanes])
    keep = np.concatenate(([True], np.hypot(*np.diff(points, axis=0).T) > 1e-3))
    line = points[keep]
    if len(line) < 2:
        return network.lanes[lanes[0]].shape
    arc = arc_lengths(line)
    fine = np.linspace(0.0, arc[-1], max(2, int(np.ceil(arc[-1] / _SPACING)) + 1))
    return np.column_stack((np.interp(fine, arc, line[:, 0]), np.interp(fine, arc, line[:, 1])))


def _approach(network: RoadNetwork, movement: Movement) -> list[int]:
    """Returns the lanes that lead into a movement, as far back as an approach is relevant."""
    table = right_of_way(network)
    lanes: list[int] = []
    lane, length = movement.incoming, 0.0
    while lane >= 0 and length < _APPROACH and lane not in lanes:
        lanes.insert(0, lane)
        length += network.lanes[lane].length
        lane = table.before.get(lane, (-1,))[0]
    return lanes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Zone:
    enter: float
    leave: float
    gate: float
    exit: float
    must_yield: bool
    signalised: bool
    line: FloatArray
    foe_enter: float
    foe_leave: float


def _near_range(
    mine: FloatArray, theirs: FloatArray
) -> tuple[NDArray[np.intp], NDArray[np.intp]] | None:
    gaps = np.hypot(mine[:, None, 0] - theirs[None, :, 0], mine[:, None, 1] - theirs[None, :, 1])
    near = gaps < _CLEAR_WIDTH
    if not near.any():
        return None
    return np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))


@lru_cache(maxsize=256)
def find_conflicts(network: RoadNetwork, run: LaneRun, route: LaneRoute) -> Conflicts:
    """Finds the conflict zones along a lane run.

    Args:
        network: The road network.
        run: The lane run.
        route: The whole route: its signals determine the junctions with lights.
    """
    table = right_of_way(network)
    lights = {signal.traffic_light for signal in route.signals}
    zones: list[_Zone] = []
    handled: set[int] = set()
    for position, lane in enumerate(run.lanes):
        movement = table.by_lane.get(lane)
        if movement is None or not movement.foes or lane in handled:
            continue
        handled.update(movement.lanes)
        way = _chain_line(network, movement.lanes)
        gate = _place_on(run, way[0], position)
        span = float(arc_lengths(way)[-1])
        signalised = bool(lights) and _has_light(network, movement)
        for foe_lane in movement.foes:
            foe = table.by_lane[foe_lane]
            through = _chain_line(network, foe.lanes)
            found = _near_range(way, through)
            if found is None:
                continue
            mine, theirs = found
            approach = _approach(network, foe)
            line = (
                np.concatenate((_chain_line(network, approach), through)) if approach else through
            )
            arc = arc_lengths(line)
            base = float(arc[-1] - arc_lengths(through)[-1])
            way_arc, through_arc = arc_lengths(way), arc_lengths(through)
            zones.append(
                _Zone(
                    enter=gate + float(way_arc[mine[0]]),
                    leave=gate + float(way_arc[mine[-1]]),
                    gate=gate,
                    exit=gate + span,
                    must_yield=foe_lane in movement.yields_to,
                    signalised=signalised,
                    line=line,
                    foe_enter=base + float(through_arc[theirs[0]]),
                    foe_leave=base + float(through_arc[theirs[-1]]),
                )
            )
    return _lay(sorted(zones, key=lambda zone: zone.enter))


def _has_light(network: RoadNetwork, movement: Movement) -> bool:
    if movement.incoming < 0:
        return False
    return any(
        connection.to_lane == movement.lanes[0] and connection.traffic_light
        for connection in network.lanes[movement.incoming].connections
    )


def _place_on(run: LaneRun, point: FloatArray, position: int) -> float:
    """Returns the arc length on the run's line of a junction's entry.

    A run may pass the same junction twice; the share of lanes before it selects the passage.
    """
    distance = np.hypot(run.line[:, 0] - point[0], run.line[:, 1] - point[1])
    near = np.flatnonzero(distance < float(distance.min()) + 1.0)
    share = position / max(len(run.lanes), 1) * float(run.arc[-1])
    best = near[int(np.argmin(np.abs(run.arc[near] - share)))]
    return float(run.arc[best])


def _lay(zones: Sequence[_Zone]) -> Conflicts:
    laid = np.zeros((len(zones), len(ZoneCol)))
    for row, zone in zip(laid, zones, strict=True):
        row[ZoneCol.ENTER], row[ZoneCol.LEAVE] = zone.enter, zone.leave
        row[ZoneCol.GATE], row[ZoneCol.EXIT] = zone.gate, zone.exit
        row[ZoneCol.YIELDS], row[ZoneCol.SIGNALISED] = zone.must_yield, zone.signalised
        row[ZoneCol.FOE_ENTER], row[ZoneCol.FOE_LEAVE] = zone.foe_enter, zone.foe_leave
    foes = [np.column_stack((zone.line, arc_lengths(zone.line))) for zone in zones]
    counts = np.cumsum([len(foe) for foe in foes], dtype=np.int64)
    return Conflicts(
        zones=laid,
        first=np.concatenate((np.zeros(1, dtype=np.int64), counts)),
        foes=np.concatenate(foes) if foes else np.empty((0, len(LineCol))),
    )
