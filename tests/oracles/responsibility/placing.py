"""Places of cases by the lanes of a network: before and after borders, across lanes; metres."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from tests.oracles.responsibility.case import OTHER_MODEL, Car, Case, Ego, Other
from tests.oracles.responsibility.ways import Drive, Point, meeting, town

CARS = 4.7
"""Between the centres of an ego and a car behind it that touch."""

Speeds = tuple[tuple[float, float], ...]


def placed(
    name: str,
    happens: str,
    expected: str,
    source: str,
    where: str,
    ego: Drive,
    *others: Other,
    to: Point | None = None,
    lights: Mapping[str, Any] | None = None,
    seconds: float = 12.0,
) -> Case:
    """A case with one ego, whose route leads to the end of its way or to another place."""
    end = to or ego.at(ego.length - 1.0)
    return Case(
        name=name,
        happens=happens,
        expected=expected,
        source=source,
        town=where,
        egos=(Ego(drive=ego, to=end),),
        others=others,
        lights=lights,
        seconds=seconds,
    )


def brisk(*, drive: Drive, name: str = "other", model: str = OTHER_MODEL) -> Car:
    """A vehicle that brakes and corners as hard as its speeds ask."""
    return Car(drive=drive, name=name, model=model, deceleration=8.0, lateral_acceleration=8.0)


def along(way: FloatArray, at: Point, ahead: float) -> Point:
    """The place of a way so many metres after the one nearest to a point."""
    arc = arc_lengths(way)
    fine = np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / 0.1)))
    x, y = np.interp(fine, arc, way[:, 0]), np.interp(fine, arc, way[:, 1])
    s = float(fine[np.argmin(np.hypot(x - at[0], y - at[1]))]) + ahead
    return float(np.interp(s, arc, way[:, 0])), float(np.interp(s, arc, way[:, 1]))


def arc_of(way: FloatArray, at: Point) -> float:
    """Arc length of the place of a way nearest to a point."""
    arc = arc_lengths(way)
    fine = np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / 0.1)))
    x, y = np.interp(fine, arc, way[:, 0]), np.interp(fine, arc, way[:, 1])
    return float(fine[np.argmin(np.hypot(x - at[0], y - at[1]))])


def after(
    way: FloatArray, at: Point, ahead: float, time: float, *speeds: tuple[float, float]
) -> Drive:
    """Along a way, so many metres after a place at a time; constant speed or a course of it."""
    return meeting(way, along(way, at, ahead), time, *speeds)


def beginning(where: str, lane: str) -> Point:
    """Where a lane begins."""
    x, y = town(where).lane(lane).shape[0]
    return float(x), float(y)


def beside(where: str, lane: str, s: float, left: float) -> Point:
    """A place beside the centre of a lane at an arc length, metres to the left."""
    x, y, heading = town(where).lane(lane).position_at(s)
    return x - left * math.sin(heading), y + left * math.cos(heading)


def heading(where: str, lane: str, s: float) -> float:
    """Direction of a lane at an arc length, degrees."""
    return math.degrees(town(where).lane(lane).position_at(s)[2])
