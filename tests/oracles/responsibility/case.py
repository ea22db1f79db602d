"""A case of responsibility: a scenario and the verdict that it must get."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from drivora_service.geometry.lines import arc_lengths
from drivora_service.scenario.documents import ScenarioDocument, document_text, parse_document
from tests.oracles.responsibility.ways import TICK, Drive, Point

EGO_MODEL = "vehicle.lincoln.mkz_2020"
OTHER_MODEL = "vehicle.toyota.prius"
WALKER_MODEL = "walker.pedestrian.0001"

AT_FAULT = "at fault"
NOT_AT_FAULT = "not at fault"
UNDETERMINED = "undetermined"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ego:
    """A scripted ego and where its route leads."""

    drive: Drive
    to: Point
    name: str = "ego"


@dataclass(frozen=True, slots=True, kw_only=True)
class Car:
    """A vehicle that follows its way whatever happens; most braking and cornering in m/s²."""

    drive: Drive
    name: str = "other"
    model: str = OTHER_MODEL
    deceleration: float | None = None
    lateral_acceleration: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Parked:
    """A vehicle that stands; ``yaw`` in degrees."""

    at: Point
    yaw: float = 0.0
    name: str = "other"
    model: str = OTHER_MODEL
    start_time: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstacle:
    """An object that stands; ``yaw`` in degrees."""

    at: Point
    yaw: float = 0.0
    name: str = "other"
    model: str = "static.prop.container"
    start_time: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Walker:
    """A pedestrian; speed in m/s."""

    points: tuple[Point, ...]
    speed: float = 1.4
    name: str = "other"
    start_time: float = 0.0


Other = Car | Parked | Obstacle | Walker


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A collision with a known answer.

    Attributes:
        name: Also of the document's file.
        happens: What happens, in a sentence.
        expected: Of the first ego's verdict.
        source: Where the expected verdict comes from.
        expected_of: Expected verdicts of further egos.
        seconds: ``max_sim_time``.
    """

    name: str
    happens: str
    expected: str
    source: str
    town: str
    egos: tuple[Ego, ...]
    others: tuple[Other, ...] = ()
    expected_of: Mapping[str, str] = field(default_factory=dict)
    lights: Mapping[str, Any] | None = None
    seconds: float = 12.0

    def document(self) -> ScenarioDocument:
        """The scenario."""
        content: dict[str, Any] = {
            "version": "1.0",
            "frame": "sumo",
            "ego_vehicles": [_ego(ego, self.seconds) for ego in self.egos],
            "map_region": {"town": self.town},
            "seed": 1,
            "max_sim_time": self.seconds,
        }
        for other in self.others:
            key, entry = _other(other)
            content.setdefault(key, []).append(entry)
        if self.lights is not None:
            content["traffic_lights"] = dict(self.lights)
        return parse_document(content)

    def text(self) -> str:
        """The document as it is stored."""
        return document_text(self.document())


def _place(point: Point, **more: Any) -> dict[str, Any]:
    return {"x": round(float(point[0]), 3), "y": round(float(point[1]), 3), **more}


def _ego(ego: Ego, seconds: float) -> dict[str, Any]:
    drive = ego.drive
    start = _place(drive.at(0.0), yaw=round(drive.heading, 2))
    return {
        "id": ego.name,
        "model": EGO_MODEL,
        "route": [start, _place(ego.to)],
        "initial_speed": round(drive.speed(0.0), 2),
        "agent": {"name": "scripted", "parameters": {"trajectory": drive.script(seconds)}},
    }


def _car(car: Car) -> dict[str, Any]:
    drive = car.drive
    if len(drive.speeds) == 1:
        speed = round(drive.speed(0.0), 2)
        route = [_place(point, speed=speed) for point in drive.way]
    else:
        route = _changing(drive)
    entry: dict[str, Any] = {
        "id": car.name,
        "model": car.model,
        "route": route,
        "behavior": "replay",
    }
    if drive.start_time:
        entry["start_time"] = drive.start_time
    if car.deceleration is not None:
        entry["deceleration"] = car.deceleration
    if car.lateral_acceleration is not None:
        entry["lateral_acceleration"] = car.lateral_acceleration
    return entry


def _changing(drive: Drive) -> list[dict[str, Any]]:
    """Waypoints for a speed that changes; a stop is one with more road behind it."""
    route = [_place(drive.at(0.0), speed=round(drive.speed(0.0), 2))]
    last = drive.speeds[-1]
    for k in range(1, math.ceil((last[0] + 0.01) / TICK) + 1):
        s, speed = drive.driven(TICK * k), drive.speed(TICK * k)
        if s - drive.driven(TICK * (k - 1)) > 0.15:
            route.append(_place(drive.at(s), speed=round(speed, 2)))
    arc = arc_lengths(drive.way)
    rest = drive.way[arc > drive.driven(last[0]) + 0.3]
    route += [_place(point, speed=round(last[1], 2)) for point in rest]
    return route


def _other(other: Other) -> tuple[str, dict[str, Any]]:
    if isinstance(other, Car):
        return "npc_vehicles", _car(other)
    if isinstance(other, Parked):
        entry: dict[str, Any] = {
            "id": other.name,
            "model": other.model,
            "route": [_place(other.at, yaw=other.yaw)],
        }
        key = "npc_vehicles"
    elif isinstance(other, Obstacle):
        location = _place(other.at, yaw=other.yaw)
        entry = {"id": other.name, "model": other.model, "location": location}
        key = "npc_obstacles"
    else:
        points = [_place(point, speed=other.speed) for point in other.points]
        entry = {"id": other.name, "model": WALKER_MODEL, "route": points}
        key = "npc_walkers"
    if other.start_time:
        entry["start_time"] = other.start_time
    return key, entry
