"""Meetings of routes inside junctions, where they come from different sides and cross or merge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np
import shapely

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.road_network import RoadNetwork

SAME_LINE = 1.5
"""Metres: lines with points at most 1 m apart that are nearer are on the same lane or cross;
adjacent lanes are further apart."""

CLEAR_WIDTH = 2.6
"""Metres; nearer lines cannot be driven side by side: a car's width and a margin."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Meeting:
    """Two routes that meet.

    Attributes:
        first: Index of one route.
        second: Index of the other route, greater than ``first``.
        zones: For each of the two, (enter, leave) arc lengths on its line in metres between which
            the other one's line is nearer than ``CLEAR_WIDTH``.
    """

    first: int
    second: int
    zones: tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Passage:
    """A way of a route through a junction: (n, 2) points with their (n,) arc lengths, metres."""

    junction: int
    points: FloatArray
    arc: FloatArray


def find_meetings(network: RoadNetwork, lines: Sequence[FloatArray]) -> tuple[Meeting, ...]:
    """Finds meetings of routes: each way of one through a junction with each way of another.

    Routes that enter a junction on the same lane do not meet in it: one follows the other.
    Heights are ignored, so a route on a bridge over a junction passes it too.

    Args:
        network: The road network.
        lines: (n, 2) reference line of each route, metres, points at most 1 m apart.

    Returns:
        Meetings in the order of the routes, then along the first.
    """
    passages = _passages(network, lines)
    return tuple(
        Meeting(first=first, second=second, zones=zones)
        for first, second in combinations(range(len(lines)), 2)
        for one in passages[first]
        for other in passages[second]
        if one.junction == other.junction and (zones := _zones(one, other)) is not None
    )


def meeting_matrix(network: RoadNetwork, lines: Sequence[FloatArray]) -> BoolArray:
    """Returns (n, n) flags of meeting routes, symmetric; no route meets itself.

    Args:
        network: The road network.
        lines: As for :func:`find_meetings`.
    """
    meet = np.zeros((len(lines), len(lines)), dtype=np.bool_)
    for meeting in find_meetings(network, lines):
        meet[meeting.first, meeting.second] = meet[meeting.second, meeting.first] = True
    return meet


@lru_cache(maxsize=128)
def _junctions(network: RoadNetwork) -> shapely.STRtree:
    """Returns the outlines of the junctions; those without area are omitted."""
    outlines = [
        shapely.make_valid(shapely.Polygon(shape))
        for shape in network.junction_shapes.values()
        if len(shape) >= 3
    ]
    kept = [outline for outline in outlines if outline.area > 0.0]
    shapely.prepare(kept)
    return shapely.STRtree(kept)


def _passages(network: RoadNetwork, lines: Sequence[FloatArray]) -> list[list[_Passage]]:
    """Returns each route's ways through junctions, in order along it."""
    counts = [len(line) for line in lines]
    owner = np.repeat(np.arange(len(lines)), counts)
    place = np.concatenate([np.arange(count) for count in counts]) if counts else np.empty(0)
    passages: list[list[_Passage]] = [[] for _ in lines]
    if not len(owner):
        return passages
    arcs = [arc_lengths(line) for line in lines]
    points = shapely.points(np.concatenate(lines))
    point, junction = _junctions(network).query(points, predicate="intersects")
    order = np.lexsort((point, junction))
    point, junction = point[order], junction[order]
    begins = np.ones(len(point), dtype=np.bool_)
    # A way ends where the junction, the route, or the run of points ends.
    begins[1:] = (np.diff(junction) != 0) | (np.diff(point) != 1) | (np.diff(owner[point]) != 0)
    for part in np.split(np.arange(len(point)), np.flatnonzero(begins)[1:]):
        if len(part) < 2:
            continue
        route = int(owner[point[part[0]]])
        rows = place[point[part]].astype(np.intp)
        passages[route].append(
            _Passage(
                junction=int(junction[part[0]]),
                points=lines[route][rows],
                arc=arcs[route][rows],
            )
        )
    return [sorted(ways, key=lambda way: float(way.arc[0])) for ways in passages]


def _zones(
    one: _Passage, other: _Passage
) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Returns the zones in which two ways through a junction are too near, ``None`` without any."""
    gaps = np.hypot(*(one.points[:, None] - other.points[None]).transpose(2, 0, 1))
    if gaps[0, 0] < SAME_LINE or gaps.min() >= SAME_LINE:
        return None
    near = gaps < CLEAR_WIDTH
    mine, theirs = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
    return (
        (float(one.arc[mine[0]]), float(one.arc[mine[-1]])),
        (float(other.arc[theirs[0]]), float(other.arc[theirs[-1]])),
    )
