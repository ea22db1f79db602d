"""Stop lines that an ego drove over, on its route or off it, and its movements after them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.stop_lines import StopLines, WayThrough, stop_lines
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col

LINE_WIDTH = 1.2
"""Width of a stop line relative to its lane, for the front (CARLA Leaderboard)."""

TAIL_WIDTH = 3.0
"""The same factor for the tail, which follows the front."""


class _Track(NamedTuple):
    """The way of a point of an ego.

    Attributes:
        x, y: (n,) metres.
        z: (n,) metres.
        cos, sin: (n,) of the ego's heading.
        width: Width of a line for this point relative to its lane.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    cos: FloatArray
    sin: FloatArray
    width: float


class _Line(NamedTuple):
    """A stop line, as wide as it counts for a point.

    Attributes:
        x, y: Its middle, metres.
        along_x, along_y: Direction of its lane, of length 1.
        height: Metres.
        half_width: Metres to either side.
    """

    x: float
    y: float
    along_x: float
    along_y: float
    height: float
    half_width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """A crossing of a stop line by an ego along its lane.

    Attributes:
        line: Row of ``StopLines``.
        front: First row of the ego with its front beyond the line.
        tail: First row with its tail beyond it; ``None`` if there is none.
        ways: The movements from the line that it may have driven: one, unless the trace ends too
            early or the ego followed no movement.
    """

    line: int
    front: int
    tail: int | None
    ways: tuple[WayThrough, ...]


def find_line_crossings(ego: EgoView) -> tuple[Crossing, ...]:
    """Returns every crossing of a stop line in the order of time; see ``EgoView.crossings``."""
    if ego.count < 2:
        return ()
    lines = stop_lines(ego.network)
    fronts_way = _track(ego, 0.5 * ego.actor.length, LINE_WIDTH)
    tails_way = _track(ego, -0.5 * ego.actor.length, TAIL_WIDTH)
    found = []
    for line in _near(ego, lines):
        fronts = _passages(lines, line, fronts_way)
        tails = _passages(lines, line, tails_way)
        for front, following in itertools.pairwise((*fronts, ego.count)):
            tail = next((row for row in tails if front <= row < following), None)
            found.append(
                Crossing(
                    line=line, front=front, tail=tail, ways=_find_movements(ego, lines, line, front)
                )
            )
    return tuple(sorted(found, key=lambda crossing: (crossing.front, crossing.line)))


def _near(ego: EgoView, lines: StopLines) -> list[int]:
    """Returns the lines that the ego's box may have touched."""
    path = ego.states[:, [Col.X, Col.Y]]
    reach = ego.actor.length + 2.0 * LINE_WIDTH * float(np.max(lines.half_widths, initial=0.0))
    low, high = path.min(axis=0) - reach, path.max(axis=0) + reach
    inside = np.all((lines.points >= low) & (lines.points <= high), axis=1)
    near = []
    for line in np.flatnonzero(inside).tolist():
        away = path - lines.points[line]
        if np.min(np.einsum("ij,ij->i", away, away)) <= reach**2:
            near.append(line)
    return near


def _track(ego: EgoView, offset: float, width: float) -> _Track:
    """Returns the way of the point ``offset`` metres before the ego's centre."""
    cos, sin = elementary.cos(ego.states[:, Col.YAW]), elementary.sin(ego.states[:, Col.YAW])
    return _Track(
        x=ego.states[:, Col.X] + offset * cos,
        y=ego.states[:, Col.Y] + offset * sin,
        z=np.ascontiguousarray(ego.states[:, Col.Z]),
        cos=cos,
        sin=sin,
        width=width,
    )


def _passages(lines: StopLines, line: int, track: _Track) -> list[int]:
    """Returns the rows in which a point of the ego is beyond a line for the first time.

    Args:
        lines: The stop lines of the network.
        line: Row of ``lines``.
        track: Way of the point.
    """
    x, y = lines.points[line].tolist()
    along_x, along_y = lines.headings[line].tolist()
    crossed = _Line(
        x=x,
        y=y,
        along_x=along_x,
        along_y=along_y,
        height=float(lines.heights[line]),
        half_width=track.width * float(lines.half_widths[line]),
    )
    found: list[int] = _rows_beyond(track, crossed).tolist()
    return found


@compiled
def _rows_beyond(track: _Track, line: _Line) -> IntArray:
    """Returns the rows in which a track is beyond a line that it was not beyond one row before."""
    along_x, along_y = line.along_x, line.along_y
    rows = np.empty(track.x.shape[0], dtype=np.int64)
    count = 0
    before = 0.0
    for k in range(track.x.shape[0]):
        x, y = track.x[k] - line.x, track.y[k] - line.y
        ahead = x * along_x + y * along_y
        if (
            k > 0
            and before <= 0.0
            and ahead > 0.0
            and track.cos[k] * along_x + track.sin[k] * along_y > 0.0
            and abs(track.z[k] - line.height) <= LEVEL_GAP
        ):
            share = -before / (ahead - before)
            here = y * along_x - x * along_y
            there = (track.y[k - 1] - line.y) * along_x - (track.x[k - 1] - line.x) * along_y
            if abs(there + share * (here - there)) <= line.half_width:
                rows[count] = k
                count += 1
        before = ahead
    return rows[:count]


def _find_movements(
    ego: EgoView, lines: StopLines, line: int, front: int
) -> tuple[WayThrough, ...]:
    """Returns the movements that agree best with the lanes driven after a line.

    Movements from the lane have priority over those from the others of its edge, which count if the
    ego turned from the wrong lane.
    """
    network = ego.network
    own = lines.ways[line]
    edge = network.lanes[int(lines.lanes[line])].edge_id
    beside = [
        way
        for other in np.flatnonzero(np.isin(lines.lanes, network.edge_lanes[edge])).tolist()
        if other != line
        for way in lines.ways[other]
    ]
    visited = _lanes_behind(ego, edge, front)
    left = [lane for lane in visited if not network.lanes[lane].is_internal]
    for ways in (own, beside):
        if left:
            found = [way for way in ways if way.exit_edge == network.lanes[left[0]].edge_id]
        else:
            found = [way for way in ways if way.inside and set(way.inside) & set(visited)]
        if len(found) > 1:
            found = [way for way in found if set(way.inside) & set(visited)] or found
        if found:
            return tuple(found)
    return own


def _lanes_behind(ego: EgoView, edge: str, front: int) -> list[int]:
    """Returns the ego's lanes after a line, up to the first after the junction."""
    visited: list[int] = []
    for lane in ego.lanes[front:].tolist():
        if lane < 0 or (visited and lane == visited[-1]):
            continue
        here = ego.network.lanes[lane]
        if here.edge_id == edge:
            continue
        visited.append(lane)
        if not here.is_internal:
            break
    return visited
