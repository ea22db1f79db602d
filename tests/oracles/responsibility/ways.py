"""Ways and motions from which the cases of responsibility are built; metres and seconds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork

Point = tuple[float, float]

TICK = 0.25
"""Seconds between two places of a script."""


@lru_cache(maxsize=1)
def _catalogue() -> NetworkCatalogue:
    return NetworkCatalogue(shipped_networks())


def town(name: str) -> RoadNetwork:
    """A shipped network."""
    return _catalogue().get(name)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drive:
    """A motion along a way.

    Attributes:
        way: (n, 2) polyline that begins where the actor starts.
        speeds: Pairs of time and m/s, linear in between.
        start_time: Seconds at which it begins.
    """

    way: FloatArray
    speeds: tuple[tuple[float, float], ...]
    start_time: float = 0.0

    def driven(self, time: float) -> float:
        """Distance driven after ``time`` seconds."""
        fine = np.linspace(0.0, time, max(2, math.ceil(time / 0.01) + 1))
        times, values = np.array(self.speeds).T
        return float(np.trapezoid(np.interp(fine, times, values), fine))

    def speed(self, time: float) -> float:
        """Speed at a time."""
        times, values = np.array(self.speeds).T
        return float(np.interp(time, times, values))

    def at(self, s: float) -> Point:
        """Place at an arc length of the way."""
        arc = arc_lengths(self.way)
        return float(np.interp(s, arc, self.way[:, 0])), float(np.interp(s, arc, self.way[:, 1]))

    @property
    def length(self) -> float:
        """Of the way."""
        return float(arc_lengths(self.way)[-1])

    @property
    def heading(self) -> float:
        """At the start, degrees."""
        (x0, y0), (x1, y1) = self.way[0], self.way[1]
        return math.degrees(math.atan2(y1 - y0, x1 - x0))

    def script(self, until: float) -> list[list[float]]:
        """Places by time, as the agent ``scripted`` takes them."""
        places: list[list[float]] = []
        for time in np.arange(0.0, until + TICK, TICK).tolist():
            s = self.driven(time)
            if s > self.length:
                break
            x, y = self.at(s)
            places.append([round(time, 2), round(x, 2), round(y, 2)])
            if time > self.speeds[-1][0] and self.speeds[-1][1] == 0.0:
                break
        return places


def straight(*points: Point) -> FloatArray:
    """A polyline through points."""
    return np.array(points, dtype=np.float64)


def shift(x0: float, y0: float, begin: float, end: float, y1: float, x1: float) -> FloatArray:
    """Along x from (x0, y0), moving over to y1 between ``begin`` and ``end``, on to x1."""
    share = np.linspace(0.0, 1.0, 25)
    blend = share * share * (3.0 - 2.0 * share)
    middle = np.column_stack((begin + share * (end - begin), y0 + blend * (y1 - y0)))
    return np.vstack(((x0, y0), middle, (x1, y1)))


def lanes(name: str, *ids: str, left: float = 0.0) -> FloatArray:
    """Centre lines of lanes one after the other, shifted to the left by so many metres."""
    points = np.vstack([town(name).lane(lane).shape for lane in ids])
    arc = arc_lengths(points)
    points = points[np.concatenate(([True], np.diff(arc) > 0.05))]
    if left:
        ahead = np.gradient(points, axis=0)
        ahead /= np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
        points = points + left * np.column_stack((-ahead[:, 1], ahead[:, 0]))
    return points


def steady(way: FloatArray, speed: float, start_time: float = 0.0) -> Drive:
    """At constant speed from the beginning of a way."""
    return Drive(way=way, speeds=((0.0, speed),), start_time=start_time)


def meeting(way: FloatArray, at: Point, time: float, *speeds: tuple[float, float]) -> Drive:
    """Along a way so that the actor would be at a place at a time.

    Where the way is too short before that place, an actor of constant speed enters later.

    Args:
        way: Polyline; the part before the actor's start is cut off.
        at: A place on or near the way.
        time: Seconds.
        speeds: Pairs of time and m/s.
    """
    arc = arc_lengths(way)
    fine = np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / 0.1)))
    x, y = np.interp(fine, arc, way[:, 0]), np.interp(fine, arc, way[:, 1])
    s = float(fine[np.argmin(np.hypot(x - at[0], y - at[1]))])
    start = s - Drive(way=way, speeds=speeds).driven(time)
    if start < 0.0 and len(speeds) == 1:
        # It enters the scene at the beginning of the way, later.
        return Drive(way=way, speeds=speeds, start_time=round(-start / speeds[0][1], 2))
    if start < 0.0:
        raise ValueError(f"the way is {-start:.1f} m too short before {at}")
    first = (float(np.interp(start, arc, way[:, 0])), float(np.interp(start, arc, way[:, 1])))
    return Drive(way=np.vstack((first, way[arc > start + 0.05])), speeds=speeds)


def braking(
    begin: float, speed: float, deceleration: float = 6.0
) -> tuple[tuple[float, float], ...]:
    """Constant speed, then braking to a stop from a time on."""
    return ((0.0, speed), (begin, speed), (begin + speed / deceleration, 0.0))


def detour(
    x0: float, y0: float, out: tuple[float, float], y1: float, back: tuple[float, float], x1: float
) -> FloatArray:
    """Along x from (x0, y0), over to y1 between the places ``out``, back in ``back``, on to x1."""
    first = shift(x0, y0, *out, y1, 0.5 * (out[1] + back[0]))
    return np.vstack((first, shift(float(first[-1, 0]), y1, *back, y0, x1)[1:]))


def sway(way: FloatArray, begin: float, end: float, left: float) -> FloatArray:
    """A way that moves over to the left by so many metres between two of its arc lengths."""
    arc = arc_lengths(way)
    fine = np.arange(0.0, float(arc[-1]), 1.0)
    points = np.column_stack([np.interp(fine, arc, way[:, axis]) for axis in (0, 1)])
    ahead = np.gradient(points, axis=0)
    ahead /= np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    share = np.clip((fine - begin) / (end - begin), 0.0, 1.0)
    aside = left * share * share * (3.0 - 2.0 * share)
    moved: FloatArray = points + aside[:, None] * np.column_stack((-ahead[:, 1], ahead[:, 0]))
    return moved


def cut(way: FloatArray, begin: float) -> FloatArray:
    """A way from one of its arc lengths on."""
    arc = arc_lengths(way)
    first = [float(np.interp(begin, arc, way[:, axis])) for axis in (0, 1)]
    return np.vstack((first, way[arc > begin + 0.05]))
