"""Ways through junctions and motions along them, for the situations of right of way."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from tests.oracles.responsibility.ways import Drive, Point, lanes, meeting, town


@lru_cache(maxsize=256)
def way(name: str, *ids: str) -> FloatArray:
    """Centre lines of lanes, with those inside the junctions between them."""
    whole = [ids[0]]
    for lane in ids[1:]:
        whole += [*_inside(name, whole[-1], lane), lane]
    return lanes(name, *whole)


def _inside(name: str, begin: str, end: str) -> list[str]:
    network = town(name)
    target = network.lane_by_id[end]
    ways: list[list[int]] = [[network.lane_by_id[begin]]]
    while ways:
        done = ways.pop(0)
        for connection in network.lanes[done[-1]].connections:
            if connection.to_lane == target:
                return [network.lanes[lane].id for lane in done[1:]]
            if network.lanes[connection.to_lane].is_internal:
                ways.append([*done, connection.to_lane])
    raise ValueError(f"no movement from {begin} to {end}")


def fine(line: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Arc lengths every 0.25 m, and the places there."""
    arc = arc_lengths(line)
    steps = np.linspace(0.0, float(arc[-1]), max(2, math.ceil(float(arc[-1]) / 0.25)))
    return steps, np.column_stack([np.interp(steps, arc, line[:, axis]) for axis in (0, 1)])


def where(line: FloatArray, other: FloatArray, near: float = 1.0) -> Point:
    """The first place of a way at which another is not further away than ``near`` metres."""
    _, points = fine(line)
    _, foreign = fine(other)
    gaps = np.hypot(*(points[:, None] - foreign[None]).transpose(2, 0, 1)).min(axis=1)
    first = points[int(np.argmax(gaps <= near))]
    if gaps.min() > near:
        raise ValueError(f"the ways stay {gaps.min():.1f} m apart")
    return float(first[0]), float(first[1])


def place(line: FloatArray, at: Point, ahead: float) -> Point:
    """The place of a way so many metres beyond another of its places."""
    steps, points = fine(line)
    s = steps[int(np.argmin(np.hypot(points[:, 0] - at[0], points[:, 1] - at[1])))] + ahead
    arc = arc_lengths(line)
    return float(np.interp(s, arc, line[:, 0])), float(np.interp(s, arc, line[:, 1]))


def pace(first: float, *changes: tuple[float, float, float]) -> tuple[tuple[float, float], ...]:
    """Speeds over time.

    Args:
        first: m/s at the beginning.
        changes: Seconds at which a change begins, m/s² of it, and m/s after it.
    """
    speeds = [(0.0, first)]
    for begin, acceleration, speed in changes:
        if begin > speeds[-1][0]:
            speeds.append((begin, speeds[-1][1]))
        speeds.append((speeds[-1][0] + abs(speed - speeds[-1][1]) / acceleration, speed))
    return tuple(speeds)


def before(
    line: FloatArray, at: Point, gap: float, time: float, *speeds: tuple[float, float]
) -> Drive:
    """Along a way, so that its centre is ``gap`` metres before a place at a time."""
    return meeting(line, place(line, at, -gap), time, *speeds)


def going(
    name: str,
    ids: tuple[str, ...],
    across: tuple[str, ...],
    time: float,
    *speeds: tuple[float, float],
) -> Drive:
    """Along lanes, so that its centre is at a time where they reach those of another."""
    line = way(name, *ids)
    return meeting(line, where(line, way(name, *across)), time, *speeds)


def coming(
    name: str,
    ids: tuple[str, ...],
    across: tuple[str, ...],
    gap: float,
    time: float,
    *speeds: tuple[float, float],
) -> Drive:
    """Along lanes, so that its centre is at a time ``gap`` metres before those of another."""
    line = way(name, *ids)
    return before(line, where(line, way(name, *across)), gap, time, *speeds)


def along(name: str, ids: tuple[str, ...], begin: float) -> tuple[Point, ...]:
    """A place so many metres along lanes, and their end."""
    line = way(name, *ids)
    arc = arc_lengths(line)
    return tuple(
        (float(np.interp(s, arc, line[:, 0])), float(np.interp(s, arc, line[:, 1])))
        for s in (begin, float(arc[-1]) - 3.0)
    )
