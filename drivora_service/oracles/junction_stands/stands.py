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
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import Col
from drivora_service.oracles.junction_stands.paths import (
    JunctionPath,
    line_through,
    path_of,
    path_straight_on,
)

STRIP = 1.0
"""Metres to either side of the middle of a way that a car needs on it: half the width of one."""

_CROSSING_ANGLE = math.radians(30.0)
"""Least angle between two ways before a junction for one to cross the other, as for
post-encroachment times: ways that join at less are those of lanes that end."""

_ONE_PLACE = 1.0
"""Metres; an ego that advances by less between two stops has not left the place."""


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
        path: Its way through the junction.
        front: Metres along that way to its front.
    """

    junction: str
    movement: Movement | None
    rows: tuple[int, ...]
    entered: int | None
    box: Polygon
    crossing: tuple[Movement, ...]
    path: JunctionPath
    front: float


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
    path = path_of(ego.network, movement) if movement else path_straight_on(ego, row)
    x, y = ego.location(row)
    return JunctionStand(
        junction=junction,
        movement=movement,
        rows=rows,
        entered=entered,
        box=box,
        crossing=crossing,
        path=path,
        front=float(path.line.project(Point(x, y))) + 0.5 * ego.actor.length,
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


@lru_cache(maxsize=16)
def _junction_ways(network: RoadNetwork) -> _JunctionWays:
    table = right_of_way(network).by_lane
    movements = tuple({one.lanes: one for one in table.values()}.values())
    lines = tuple(line_through(network, one.lanes) for one in movements)
    return _JunctionWays(movements=movements, lines=lines, tree=STRtree(lines))
