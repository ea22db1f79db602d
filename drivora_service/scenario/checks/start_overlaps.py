"""Checks for actors that overlap when they appear.

An actor keeps its first pose from the moment at which it appears until it moves: an ego from 0 to
its start time, an NPC at its start time only, or while it waits at its first waypoint, and one that
never moves (an obstacle, a parked vehicle, a standing walker) from its start time on. Two actors
overlap at their start if these times and their boxes overlap.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from drivora_service.errors import Problem
from drivora_service.geometry.outlines import box_corners
from drivora_service.scenario.checks.placed_actors import PlacedActor

TOUCH = 0.02
"""Metres by which boxes may overlap."""
LEVEL_GAP = 3.0
"""Difference of heights from which on two actors are on different levels of a bridge, metres."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StartPose:
    """The pose in which an actor appears: centre and height in metres, heading in radians."""

    actor: PlacedActor
    x: float
    y: float
    yaw: float
    height: float = 0.0


def check_overlaps(poses: Sequence[StartPose]) -> list[Problem]:
    """Reports each actor that overlaps a preceding one of the document, with the first of those."""
    boxes = [(pose, pose.actor.model) for pose in poses]
    known = [(pose, model) for pose, model in boxes if model is not None]
    columns = np.array([(p.x, p.y, p.yaw, m.length, m.width) for p, m in known]).reshape(-1, 5)
    x, y, yaw, length, width = columns.T
    corners = box_corners(x, y, yaw, length - TOUCH, width - TOUCH)
    polygons = np.asarray(shapely.polygons(corners))
    later, earlier = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    first: dict[int, int] = {}
    for a, b in zip(later.tolist(), earlier.tolist(), strict=True):
        if b < a and b < first.get(a, a) and _meet(known[a][0], known[b][0]):
            first[a] = b
    return [
        _problem(known[a][0], known[b][0], polygons[a].intersection(polygons[b]).area)
        for a, b in sorted(first.items())
    ]


def _still(actor: PlacedActor) -> tuple[float, float]:
    """Returns the begin and end of the time in its first pose, seconds."""
    if actor.is_ego:
        return 0.0, actor.start_time
    if len(actor.places) == 1:
        return actor.start_time, math.inf
    return actor.start_time, actor.start_time + (actor.places[0].wait or 0.0)


def _meet(one: StartPose, other: StartPose) -> bool:
    (start, end), (other_start, other_end) = _still(one.actor), _still(other.actor)
    same_level = abs(one.height - other.height) <= LEVEL_GAP
    return same_level and start <= other_end and other_start <= end


def _problem(pose: StartPose, other: StartPose, shared: float) -> Problem:
    gap = math.hypot(pose.x - other.x, pose.y - other.y)
    return Problem(
        pointer=pose.actor.place_pointer(0),
        code="overlapping_start",
        message=(
            f"{pose.actor.id!r} at ({pose.x:.2f}, {pose.y:.2f}) overlaps {other.actor.id!r} "
            f"({other.actor.pointer}): centres {gap:.2f} m apart, {shared:.2f} m² shared; move one "
            "of them or let it start at another time"
        ),
    )
