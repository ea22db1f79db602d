"""Signals of an ego at junctions: its movement, and those that have the right of way."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from shapely import LineString, line_locate_point, points

from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.right_of_way import right_of_way
from drivora_service.networks.stop_lines import WayThrough, stop_lines
from drivora_service.observations.line_crossings import Crossing
from drivora_service.observations.recorded_signals import signal_shown
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, Light
from drivora_service.observations.yielding.conflict import Conflict
from drivora_service.observations.yielding.vehicle_conflicts import vehicle_conflicts
from drivora_service.observations.yielding.walker_conflicts import walker_conflicts
from drivora_service.oracles.junction_stands.paths import path_of
from drivora_service.oracles.junction_stands.room import enters_without_room

_ATTENTION = 4.0
"""Seconds after the ego's passage within which others count, as in ``failure_to_yield``."""

_APPROACH = 150.0
"""Metres before the end of a lane within which the distance is measured."""

_YIELDING: WeakKeyDictionary[EgoView, Yielding] = WeakKeyDictionary()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Yielding:
    """What an ego left to those with the right of way, in the rows in which it went before them.

    Attributes:
        gap: (n,) least seconds to a vehicle; NaN in other rows.
        braking: (n,) hardest braking of a vehicle, m/s²; NaN in other rows.
        walker_gap: (n,) least seconds to a walker; NaN in other rows.
    """

    gap: FloatArray
    braking: FloatArray
    walker_gap: FloatArray


def junction_distance(ego: EgoView) -> FloatArray:
    """Returns the (n,) metres from the front to the end of its lane before a junction.

    NaN on other lanes, and where the end is more than 150 m away.
    """
    distances = np.full(ego.count, np.nan)
    for index in np.unique(ego.lanes).tolist():
        lane = ego.network.lanes[index] if index >= 0 else None
        if lane is None or lane.is_internal or not lane.connections:
            continue
        away = np.hypot(*(ego.states[:, [Col.X, Col.Y]] - lane.shape[-1]).T)
        here = np.flatnonzero((ego.lanes == index) & (away <= _APPROACH))
        if not len(here):
            continue
        # The last part of the lane: locating points takes longer the more corners a line has.
        corner = int(np.searchsorted(lane.arc, lane.arc[-1] - 2.0 * _APPROACH))
        line = LineString(lane.shape[max(min(corner, len(lane.arc) - 1) - 1, 0) :])
        centres = points(ego.states[here, Col.X], ego.states[here, Col.Y])
        distances[here] = line.length - line_locate_point(line, centres) - 0.5 * ego.actor.length
    return distances


def turning(ego: EgoView, directions: str) -> FloatArray:
    """Returns the (n,) rows in which the ego drives a movement of one of SUMO's directions."""
    rows = np.zeros(ego.count)
    for crossing, way in _find_movements(ego):
        if way.connection.direction in directions:
            rows[_through(ego, crossing, way)] = 1.0
    return rows


def turn_angle(ego: EgoView) -> FloatArray:
    """Returns the (n,) radians between the lanes before and behind a movement; NaN elsewhere."""
    angles = np.full(ego.count, np.nan)
    for crossing, way in _find_movements(ego):
        behind = ego.network.lanes[way.inside[-1]].connections
        if behind:
            heading = ego.network.lanes[behind[0].to_lane].position_at(0.0)[2]
            angle = abs(wrap_angle(heading - _heading_before(ego, crossing)))
            angles[_through(ego, crossing, way)] = angle
    return angles


def turned(ego: EgoView) -> FloatArray:
    """Returns the (n,) radians between heading and lane before a movement; NaN elsewhere."""
    angles = np.full(ego.count, np.nan)
    for crossing, way in _find_movements(ego):
        rows = _through(ego, crossing, way)
        turn = ego.states[rows, Col.YAW] - _heading_before(ego, crossing)
        angles[rows] = np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi)
    return angles


def at_signal(ego: EgoView) -> FloatArray:
    """Returns the (n,) rows in a junction in which a signal in operation controls the movement."""
    rows = np.zeros(ego.count)
    for crossing, way in _find_movements(ego):
        shown = signal_shown(ego, way.connection)
        if shown is not None and shown[crossing.front] != Light.NONE:
            rows[_through(ego, crossing, way)] = 1.0
    return rows


def wrong_lane(ego: EgoView) -> FloatArray:
    """Returns the (n,) rows in a junction of a movement that is not permitted from its lane."""
    rows = np.zeros(ego.count)
    lines = stop_lines(ego.network)
    for crossing, way in _find_movements(ego):
        if way not in lines.ways[crossing.line]:
            rows[_through(ego, crossing, way)] = 1.0
    return rows


def entered_without_room(ego: EgoView) -> FloatArray:
    """Returns the (n,) rows in a junction that the ego entered without room for it behind it."""
    rows = np.zeros(ego.count)
    if not ego.network.path.is_file():
        return rows
    table = right_of_way(ego.network).by_lane
    for crossing, way in _find_movements(ego):
        movement = table.get(way.inside[-1])
        if movement is not None and enters_without_room(
            ego, path_of(ego.network, movement), crossing.front
        ):
            rows[_through(ego, crossing, way)] = 1.0
    return rows


def yielding(ego: EgoView) -> Yielding:
    """Returns what the ego left to those with the right of way."""
    if ego not in _YIELDING:
        gap, braking = _least(ego, vehicle_conflicts(ego, attention=_ATTENTION))
        walker_gap, _ = _least(ego, walker_conflicts(ego, attention=_ATTENTION))
        _YIELDING[ego] = Yielding(gap=gap, braking=braking, walker_gap=walker_gap)
    return _YIELDING[ego]


def _least(ego: EgoView, conflicts: Iterator[Conflict]) -> tuple[FloatArray, FloatArray]:
    gap, braking = np.full(ego.count, np.nan), np.full(ego.count, np.nan)
    for conflict in conflicts:
        row = conflict.row
        gap[row] = np.fmin(gap[row], conflict.lag)
        braking[row] = np.fmax(braking[row], conflict.braking)
    return gap, braking


def _heading_before(ego: EgoView, crossing: Crossing) -> float:
    """Returns the direction of the lane that ends at a line, radians."""
    along_x, along_y = stop_lines(ego.network).headings[crossing.line].tolist()
    return math.atan2(along_y, along_x)


def _find_movements(ego: EgoView) -> Iterator[tuple[Crossing, WayThrough]]:
    """Yields the crossings of stop lines after which the ego's movement is known."""
    for crossing in ego.crossings:
        if len(crossing.ways) == 1 and crossing.ways[0].inside:
            yield crossing, crossing.ways[0]


def _through(ego: EgoView, crossing: Crossing, way: WayThrough) -> slice:
    """Returns the rows from the front's passing a line to the last inside the junction."""
    inside = np.isin(ego.lanes, way.inside)
    inside[: crossing.front] = False
    rows = np.flatnonzero(inside)
    if not len(rows):
        return slice(crossing.front, crossing.front + 1)
    # A later drive through the same junction is another crossing.
    gaps = np.flatnonzero(np.diff(rows) > 1)
    last = int(rows[gaps[0]] if len(gaps) else rows[-1])
    return slice(crossing.front, last + 1)
