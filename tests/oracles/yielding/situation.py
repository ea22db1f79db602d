"""A situation of right of way: a scenario, and what SUMO drives in it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.geometry.lines import arc_lengths
from drivora_service.scenario.documents import ScenarioDocument, document_text, parse_document
from tests.oracles.responsibility.case import (
    OTHER_MODEL,
    WALKER_MODEL,
    Car,
    Case,
    Ego,
    Other,
    Parked,
)
from tests.oracles.responsibility.ways import TICK, Drive, Point
from tests.oracles.yielding.paths import place, way, where


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven:
    """A vehicle that SUMO's own model drives along a route."""

    route: tuple[Point, ...]
    speed: float
    name: str = "other"
    model: str = OTHER_MODEL
    start_time: float = 0.0

    def entry(self) -> dict[str, Any]:
        """Of the document."""
        places = [{"x": round(x, 2), "y": round(y, 2)} for x, y in self.route]
        places[0]["speed"] = self.speed
        return {
            "id": self.name,
            "model": self.model,
            "route": places,
            "behavior": "sumo",
            "start_time": self.start_time,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Pedestrian:
    """A pedestrian with places and the speed on the way to each; a tiny one is a halt."""

    steps: tuple[tuple[float, float, float], ...]
    name: str = "other"
    start_time: float = 0.0

    def entry(self) -> dict[str, Any]:
        """Of the document."""
        return {
            "id": self.name,
            "model": WALKER_MODEL,
            "route": [{"x": x, "y": y, "speed": speed} for x, y, speed in self.steps],
            "start_time": self.start_time,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """A situation of right of way; ``known_answers`` has the actors that the ego hinders.

    Attributes:
        name: In kebab-case.
        happens: What happens, in a sentence.
        case: The scenario without what SUMO drives.
        driven: Vehicles that SUMO drives.
        walkers: Pedestrians whose speed changes.
        background: Number of vehicles of SUMO's background traffic.
        seed: Of the run.
    """

    name: str
    happens: str
    case: Case
    driven: tuple[Driven, ...] = ()
    walkers: tuple[Pedestrian, ...] = ()
    background: int = 0
    seed: int = 1

    def document(self) -> ScenarioDocument:
        """The scenario."""
        content: dict[str, Any] = json.loads(self.case.text())
        content["seed"] = self.seed
        cars = {car.name: car for car in self.case.others if isinstance(car, Car)}
        for entry in content.get("npc_vehicles", ()):
            car = cars.get(entry["id"])
            if car is not None and len(car.drive.speeds) > 1:
                entry["route"] = _waypoints(car.drive)
                entry["deceleration"] = _hardest(car.drive)
                entry["lateral_acceleration"] = 9.0
        if self.driven:
            entries = [vehicle.entry() for vehicle in self.driven]
            content["npc_vehicles"] = [*content.get("npc_vehicles", ()), *entries]
        if self.walkers:
            content["npc_walkers"] = [walker.entry() for walker in self.walkers]
        if self.background:
            content["background_traffic"] = {"count": self.background}
        return parse_document(content)

    def text(self) -> str:
        """The document as it is stored."""
        return document_text(self.document())


def _hardest(drive: Drive) -> float:
    """The deceleration that a vehicle needs for its speeds, m/s²."""
    pairs = zip(drive.speeds, drive.speeds[1:], strict=False)
    hardest = max((v0 - v1) / max(t1 - t0, 0.01) for (t0, v0), (t1, v1) in pairs)
    return round(max(3.0, 1.05 * hardest), 2)


def _waypoints(drive: Drive) -> list[dict[str, float]]:
    """Waypoints for speeds that change, with the time that it stands in between."""
    route: list[dict[str, float]] = [_waypoint(drive, 0.0)]
    last = drive.speeds[-1]
    ticks = math.ceil((last[0] + 0.01) / TICK)
    for k in range(1, ticks + 1):
        if drive.driven(TICK * k) - drive.driven(TICK * (k - 1)) > 0.15:
            route.append(_waypoint(drive, TICK * k))
        elif last[1] > 0.0 and drive.speed(TICK * k) == 0.0:
            route[-1]["wait"] = route[-1].get("wait", 0.0) + TICK
    for point in route:
        if "wait" in point:
            point["speed"] = max(point["speed"], 0.5)
    arc = arc_lengths(drive.way)
    rest = drive.way[arc > drive.driven(TICK * ticks) + 0.3]
    ends = [{"x": float(x), "y": float(y), "speed": round(last[1], 2)} for x, y in rest]
    return [{key: round(value, 3) for key, value in point.items()} for point in [*route, *ends]]


def _waypoint(drive: Drive, time: float) -> dict[str, float]:
    x, y = drive.at(drive.driven(time))
    return {"x": float(x), "y": float(y), "speed": round(drive.speed(time), 2)}


def situation(
    name: str,
    happens: str,
    town: str,
    ego: Drive,
    *others: Other | Driven | Pedestrian,
    to: Point | None = None,
    lights: Mapping[str, Any] | None = None,
    seconds: float = 16.0,
    background: int = 0,
    seed: int = 1,
) -> Situation:
    """A situation with one ego, whose route leads to the end of its way."""
    end = (float(ego.way[-1][0]), float(ego.way[-1][1]))
    case = Case(
        name=name,
        happens=happens,
        expected="",
        source="",
        town=town,
        egos=(Ego(drive=ego, to=to or end),),
        others=tuple(other for other in others if not isinstance(other, Driven | Pedestrian)),
        lights=lights,
        seconds=seconds,
    )
    return Situation(
        name=name,
        happens=happens,
        case=case,
        driven=tuple(other for other in others if isinstance(other, Driven)),
        walkers=tuple(other for other in others if isinstance(other, Pedestrian)),
        background=background,
        seed=seed,
    )


def standing(
    network: str, ids: tuple[str, ...], across: tuple[str, ...], gap: float, **more: Any
) -> Parked:
    """A vehicle that stands on lanes ``gap`` metres before they reach those of another."""
    line = way(network, *ids)
    at = place(line, where(line, way(network, *across)), -gap)
    ahead = place(line, at, 1.0)
    yaw = math.degrees(math.atan2(ahead[1] - at[1], ahead[0] - at[0]))
    return Parked(at=at, yaw=yaw, **more)
