"""Where an ego stands in a junction, on a place that the ways of other movements lead over."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from shapely import LineString, Point, Polygon, STRtree

from drivora_service.geometry.angles import wrap_angle
from drivora_service.networks.right_of_way import Movement, right_of_way
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col
from drivora_service.oracles.stretches import stretches

STRIP = 1.0
"""Metres to either side of the middle of a way that a car needs on it: half the width of one."""

_CROSSING_ANGLE = math.radians(30.0)
"""Least angle between two ways before a junction for one to cross the other, as for
post-encroachment times: ways that join at less are those of lanes that end."""

_ONE_PLACE = 1.0
"""Metres; an ego that advances by less between two stops has not left the place."""

_AHEAD = 80.0
"""Metres behind a junction up to which the way is followed."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JunctionStand:
    """A stay of an ego at a place in a junction.

    Attributes:
        junction: Id of the junction.
        movement: The movement that the ego drives; None if it follows none.
        rows: (k,) rows of the ego in which it stands there, ascending.
        entered: Row in which its front passed the stop line; None if it began behind the line.
        box: Its box.
        crossing: Movements of others that lead over this place.
        way: Middle of its way from the lane before the junction on, metres.
        front: Metres along ``way`` to its front.
        behind: Metres along ``way`` to the first lane behind the junction.
    """

    junction: str
    movement: Movement | None
    rows: tuple[int, ...]
    entered: int | None
    box: Polygon
    crossing: tuple[Movement, ...]
    way: LineString
    front: float
    behind: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _JunctionWays:
    """The ways through all junctions of a network.

    Attributes:
        movements: The movements.
        lines: The middle of each.
        tree: Spatial index of ``lines``.
    """

    movements: tuple[Movement, ...]
    lines: tuple[LineString, ...]
    tree: STRtree


def find_junction_stands(ego: EgoView, *, standing_speed: float) -> tuple[JunctionStand, ...]:
    """Returns the stays of an ego in junctions in the order of time.

    Places over which no way of others leads are left out, and so are networks without a file:
    the table of movements is in it.

    Args:
        ego: The ego.
        standing_speed: m/s below which it stands.
    """
    if not ego.network.path.is_file():
        return ()
    return tuple(
        stand
        for rows in _places(ego, standing_speed)
        if (stand := _find_stand(ego, rows)) is not None
    )


def line_through(network: RoadNetwork, lanes: tuple[int, ...]) -> LineString:
    """Returns the middle of lanes that lead into one another."""
    points = np.concatenate([network.lanes[lane].shape for lane in lanes])
    return LineString(points[np.concatenate(([True], np.any(np.diff(points, axis=0), axis=1)))])


def _places(ego: EgoView, standing_speed: float) -> list[tuple[int, ...]]:
    """Returns the rows in which the ego stands, for each place at which it does."""
    places: list[list[int]] = []
    way = np.cumsum(ego.moved)
    for first, last in stretches(ego.speed < standing_speed):
        if places and way[first] - way[places[-1][-1]] < _ONE_PLACE:
            places[-1] += range(first, last)
        else:
            places.append(list(range(first, last)))
    return [tuple(rows) for rows in places]


def _find_stand(ego: EgoView, rows: tuple[int, ...]) -> JunctionStand | None:
    box = Polygon(ego.corners[rows[-1]])
    ways = _junction_ways(ego.network)
    over = [ways.movements[k] for k in ways.tree.query(box.buffer(STRIP), predicate="intersects")]
    if not over:
        return None
    row = rows[-1]
    movement, entered = _own_movement(ego, row, {one.junction for one in over})
    if movement is None and not ego.in_junction[row]:
        return None
    junction = movement.junction if movement else over[0].junction
    heading = _heading_before(ego, movement, row)
    crossing = tuple(
        sorted(
            (
                one
                for one in over
                if one.junction == junction
                and one.incoming >= 0
                and abs(wrap_angle(_end_heading(ego.network.lanes[one.incoming]) - heading))
                >= _CROSSING_ANGLE
            ),
            key=lambda one: one.lanes,
        )
    )
    if not crossing:
        return None
    way, behind = _way(ego, movement, row)
    x, y = ego.location(row)
    return JunctionStand(
        junction=junction,
        movement=movement,
        rows=rows,
        entered=entered,
        box=box,
        crossing=crossing,
        way=way,
        front=float(way.project(Point(x, y))) + 0.5 * ego.actor.length,
        behind=behind,
    )


def _own_movement(
    ego: EgoView, row: int, junctions: set[str]
) -> tuple[Movement | None, int | None]:
    """Returns the ego's movement in one of some junctions, and the row in which it began."""
    table = right_of_way(ego.network).by_lane
    for crossing in reversed(ego.crossings):
        if crossing.front > row:
            continue
        found = [
            table[way.inside[-1]] for way in crossing.ways if way.inside and way.inside[-1] in table
        ]
        found = [one for one in found if one.junction in junctions]
        if found:
            return min(found, key=lambda one: _cost(ego, one, row)), crossing.front
        break
    lane = int(ego.lanes[row])
    own = table.get(lane)
    return (own if own is not None and own.junction in junctions else None), None


def _cost(ego: EgoView, movement: Movement, row: int) -> tuple[bool, float]:
    """Returns what makes a movement less probable: the lane, then the distance from the route."""
    middle = line_through(ego.network, movement.lanes).interpolate(0.5, normalized=True)
    return int(ego.lanes[row]) not in movement.lanes, LineString(ego.route.line).distance(middle)


def _heading_before(ego: EgoView, movement: Movement | None, row: int) -> float:
    """Returns the ego's direction before the junction, radians."""
    if movement is None or movement.incoming < 0:
        return float(ego.states[row, Col.YAW])
    return _end_heading(ego.network.lanes[movement.incoming])


def _end_heading(lane: Lane) -> float:
    return lane.position_at(float(lane.arc[-1]))[2]


def _way(ego: EgoView, movement: Movement | None, row: int) -> tuple[LineString, float]:
    """Returns the ego's way, and the metres along it to the first lane behind the junction."""
    network = ego.network
    if movement is None:
        x, y = ego.location(row)
        yaw = float(ego.states[row, Col.YAW])
        ahead = (x + _AHEAD * math.cos(yaw), y + _AHEAD * math.sin(yaw))
        return LineString([(x, y), ahead]), 0.5 * _AHEAD
    before = (movement.incoming,) if movement.incoming >= 0 else ()
    behind = line_through(network, (*before, *movement.lanes)).length
    lanes = [*before, *movement.lanes]
    length = 0.0
    while length < _AHEAD and network.lanes[lanes[-1]].connections:
        connections = network.lanes[lanes[-1]].connections
        straight = [one for one in connections if one.direction == "s"]
        following = (straight or list(connections))[0].to_lane
        if following in lanes:
            break
        lanes.append(following)
        length += float(network.lanes[following].arc[-1])
    return line_through(network, tuple(lanes)), behind


@lru_cache(maxsize=16)
def _junction_ways(network: RoadNetwork) -> _JunctionWays:
    table = right_of_way(network).by_lane
    movements = tuple({one.lanes: one for one in table.values()}.values())
    lines = tuple(line_through(network, one.lanes) for one in movements)
    return _JunctionWays(movements=movements, lines=lines, tree=STRtree(lines))
