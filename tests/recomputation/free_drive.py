"""An ego's progress beside that of a drive without other actors, computed by an envelope.

The speed at a place is bounded by that at every other place: squared, it is at most the other's
plus twice the acceleration times the distance.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import shapely

from tests.recomputation.recording import Drive, Floats
from tests.recomputation.routes import Progress, waits_at_signal
from tests.recomputation.speeds import stretches
from tests.recomputation.town import read_town

SIDEWAYS = 2.2
BRAKING = 1.8
ACCELERATION = 1.8
LEAST = 2.0
"""m/s², m/s², m/s² and m/s of the drive."""

SIMILAR = 0.5
"""Cosine of the angle between a route and the lanes that it may be on."""


@cache
def _lanes(town: str) -> tuple[list[str], shapely.STRtree]:
    lanes = {key: lane for key, lane in read_town(town).lanes.items() if len(lane.line) > 1}
    return list(lanes), shapely.STRtree([shapely.LineString(lane.line) for lane in lanes.values()])


def limits_along(town: str, line: Floats) -> tuple[Floats, Floats]:
    """Returns the lowest and the highest limit of the lanes that each place may be on.

    Where lanes overlap, in junctions, there may be several. Beside all lanes the limits of the
    place before hold.
    """
    names, tree = _lanes(town)
    lanes = read_town(town).lanes
    low, high = np.full(len(line), np.nan), np.full(len(line), np.nan)
    way = np.gradient(line, axis=0)
    points = np.asarray(shapely.points(line))
    asked, found = tree.query(points, predicate="dwithin", distance=3.0)
    for k, number in zip(asked.tolist(), found.tolist(), strict=True):
        lane, geometry = lanes[names[number]], tree.geometries[number]
        # Half a metre more: borders of lanes are no sharp lines in junctions.
        if geometry.distance(points[k]) > 0.5 * lane.width + 0.5:
            continue
        s = geometry.project(points[k])
        ends = [geometry.interpolate(min(max(s + d, 0.0), geometry.length)) for d in (-0.5, 0.5)]
        ahead = np.array([ends[1].x - ends[0].x, ends[1].y - ends[0].y])
        if ahead @ way[k] < SIMILAR * np.hypot(*ahead) * np.hypot(*way[k]):
            continue
        low[k] = np.fmin(low[k], lane.limit)
        high[k] = np.fmax(high[k], lane.limit)
    known = np.flatnonzero(~np.isnan(low))
    last = known[np.maximum(np.searchsorted(known, np.arange(len(line)), side="right") - 1, 0)]
    return low[last], high[last]


def compared_progress(
    town: str, drive: Drive, progress: Progress, step_length: float, friction: float
) -> tuple[float, float]:
    """Returns the least and the greatest ratio that the limits along the route allow."""
    start = float(np.clip(drive.route_s[0], 0.0, drive.arc[-1]))
    count = max(int(np.ceil(drive.arc[-1] - start)), 1) + 1
    places = np.linspace(start, float(drive.arc[-1]), count)
    line = np.stack([np.interp(places, drive.arc, drive.line[:, k]) for k in (0, 1)], axis=1)
    waits = waits_at_signal(drive, progress)
    stops: list[float] = []
    for first, _ in stretches(waits):
        if drive.route_s[first] >= (stops[-1] if stops else start) + 3.0:
            stops.append(float(drive.route_s[first]))
    forwards = drive.vx[0] * np.cos(drive.yaw[0]) + drive.vy[0] * np.sin(drive.yaw[0])
    clock, now = np.zeros(drive.count), 0.0
    for k in range(1, drive.count):
        now += 0.0 if waits[k] else step_length
        clock[k] = now
    ratios = []
    for limits in limits_along(town, line):
        bound = np.maximum(np.minimum(limits, _bend_speeds(line, friction)), LEAST)
        bound[0] = min(bound[0], max(forwards, 0.0))
        for stop in stops:
            bound[np.argmin(np.abs(places - stop))] = 0.0
        times = _times(places, bound, BRAKING * friction)
        end = min(times[-1], now)
        own = float(np.interp(end, clock, drive.route_s)) - start
        free = float(np.interp(end, times, places)) - start
        ratios.append(0.0 if own < -2.0 else min(max(own, 2.0) / max(free, 2.0), 1.0))
    return min(ratios), max(ratios)


def _bend_speeds(line: Floats, friction: float) -> Floats:
    """Returns the speed of a sideways acceleration, by the mean curvature over five places."""
    ways = np.diff(line, axis=0) @ np.array([1.0, 1j])
    curvature = np.zeros(len(line))
    if len(ways) > 1:
        turns = np.abs(np.angle(ways[1:] / ways[:-1]))
        curvature[1:-1] = 2.0 * turns / (np.abs(ways[1:]) + np.abs(ways[:-1]))
    if len(line) >= 5:
        around = np.pad(curvature, 2)
        curvature = np.mean([around[k : k + len(line)] for k in range(5)], axis=0)
    return np.asarray(np.sqrt(SIDEWAYS * friction / np.maximum(curvature, 1e-4)))


def _times(places: Floats, bound: Floats, braking: float) -> Floats:
    """Returns the seconds to each place, as fast as the bounds and the accelerations allow."""
    apart = places[None, :] - places[:, None]
    gained = np.where(apart >= 0.0, 2.0 * braking * apart, -2.0 * ACCELERATION * apart)
    speed = np.sqrt((bound[None, :] ** 2 + gained).min(axis=1))
    total = [0.0]
    for length, one, other in zip(np.diff(places), speed[:-1], speed[1:], strict=True):
        total.append(total[-1] + 2.0 * length / max(one + other, 1e-9))
    return np.array(total)
