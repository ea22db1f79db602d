"""The room behind a junction for an ego that enters it."""

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
from drivora_service.observations.leaders import SAME_WAY
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Actor, Col, Role, Trace
from drivora_service.oracles.junction_stands.paths import JunctionPath

QUEUE_GAP = 2.0
"""Metres between vehicles that stand one behind the other."""

_QUEUE_SPEED = 1.0
"""m/s up to which a vehicle ahead is part of a queue that does not move on."""

_NOTICE = 2.0
"""Seconds before its front passes the line by which an ego must have been able to see that there is
no room: as for a yellow light, it takes about as long to notice that and to stop."""


def enters_without_room(ego: EgoView, path: JunctionPath, entered: int) -> bool:
    """Returns whether an ego enters a junction although there is no room for it behind it.

    That is so if a vehicle, or anything else but a walker, already stands on its way, and the room
    before it is too short for the ego and for those that drive between them.

    Args:
        ego: The ego.
        path: Its way through the junction.
        entered: Row in which its front passes the stop line.
    """
    notice = max(entered - round(_NOTICE / ego.step_length), 0)
    return all(_is_full(ego, path, row) for row in (notice, entered))


def _is_full(ego: EgoView, path: JunctionPath, row: int) -> bool:
    step = ego.first + row
    steps = np.array([step])
    front = float(path.line.project(Point(*ego.location(row)))) + 0.5 * ego.actor.length
    corridor = corridor_of(ego, path.line, front, path.line.length)
    found = []
    for actor in ego.trace.actors:
        if actor.row == ego.row or actor.role is Role.NPC_WALKER:
            continue
        if not ego.trace.present[step, actor.row] or not on_level(ego, actor, steps, row)[0]:
            continue
        box = boxes_of(ego.trace, actor, steps)[0]
        if corridor.intersects(box):
            corners = shapely.points(shapely.get_coordinates(box)[:4])
            rear = float(shapely.line_locate_point(path.line, corners).min())
            found.append((rear, actor))
    needed = ego.actor.length
    for rear, actor in sorted(found, key=lambda one: one[0]):
        if float(ego.trace.speeds(actor.row)[step]) <= _QUEUE_SPEED:
            return rear - path.behind < needed
        if _goes_along(path.line, rear, float(ego.trace.states[step, actor.row, Col.YAW])):
            needed += actor.length + QUEUE_GAP
    return False


def _goes_along(way: LineString, s: float, yaw: float) -> bool:
    """Returns whether a heading is that of the way at a place, as of one that drives ahead."""
    here, further = way.interpolate(s), way.interpolate(s + 1.0)
    ahead = math.atan2(further.y - here.y, further.x - here.x)
    return abs(wrap_angle(yaw - ahead)) <= SAME_WAY


def corridor_of(ego: EgoView, way: LineString, start: float, end: float) -> BaseGeometry:
    """Returns the area that the ego needs along a part of its way."""
    part = substring(way, min(start, way.length), end)
    if not isinstance(part, LineString):
        return Point()
    return part.buffer(0.5 * ego.actor.width, cap_style="flat")


def boxes_of(trace: Trace, actor: Actor, rows: IntArray) -> NDArray[np.object_]:
    """Returns the (k,) boxes of an actor in rows of the trace in which it is present."""
    states = trace.states[rows, actor.row]
    corners = box_corners(
        states[:, Col.X], states[:, Col.Y], states[:, Col.YAW], actor.length, actor.width
    )
    boxes: NDArray[np.object_] = np.asarray(shapely.polygons(corners))
    return boxes


def on_level(ego: EgoView, actor: Actor, rows: IntArray, row: int) -> BoolArray:
    """Returns whether an actor is on the level of the ego in rows of the trace."""
    height = ego.states[row, Col.Z]
    level: BoolArray = np.abs(ego.trace.states[rows, actor.row, Col.Z] - height) <= LEVEL_GAP
    return level
