"""Broken documents: each is refused, and the place of the problem is named."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.validation import validate_document
from tests.scenario.conftest import GOOD

Change = Callable[[dict[str, Any]], Any]


def put(*path: str | int, value: Any) -> Change:
    """A change that sets the value at a path."""

    def change(content: dict[str, Any]) -> dict[str, Any]:
        place: Any = content
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value
        return content

    return change


def drop(*path: str | int) -> Change:
    """A change that removes what is at a path."""

    def change(content: dict[str, Any]) -> dict[str, Any]:
        place: Any = content
        for key in path[:-1]:
            place = place[key]
        del place[path[-1]]
        return content

    return change


def text(make: Callable[[str], str | bytes]) -> Change:
    """A change of the document's text."""
    return lambda content: make(json.dumps(content))


def nested(depth: int) -> Any:
    value: Any = 0
    for _ in range(depth):
        value = [value]
    return value


EGO = ("ego_vehicles", 0)
NPC = {"id": "npc", "model": "audi.tt", "route": [{"x": 60.0, "y": 290.0}]}
WALKER = {"id": "walker", "model": "0001", "route": [{"x": 60.0, "y": 160.0}]}
CONE = {"id": "cone", "model": "trafficcone01", "location": {"x": 60.0, "y": 160.0}}

ICE = {"id": "ice", "location": {"x": 60, "y": 153}, "length": 9, "width": 3, "friction": 0.1}

BROKEN: dict[str, tuple[Change, str]] = {
    "empty text": (lambda _: "", ""),
    "no JSON": (text(lambda t: t[:-1]), ""),
    "no object": (lambda _: "[]", ""),
    "no UTF-8": (text(lambda t: t.encode() + b"\xff"), ""),
    "100 MB": (lambda _: b" " * 100_000_000, ""),
    "a million brackets": (lambda _: "[" * 1_000_000, ""),
    "nesting in a known key": (put("weather", value=nested(500)), ""),
    "nesting in free data": (put("extensions", value={"a:b": nested(40)}), ""),
    "two million values": (lambda _: '{"a": [' + "0," * 2_000_000 + "0]}", ""),
    "repeated key": (text(lambda t: t[:-1] + ', "frame": "sumo"}'), "/frame"),
    "half a surrogate": (put("extensions", value={"a:b": "\ud800"}), "/extensions/a:b"),
    "no ego list": (drop("ego_vehicles"), "/ego_vehicles"),
    "no egos": (put("ego_vehicles", value=[]), "/ego_vehicles"),
    "egos as an object": (put("ego_vehicles", value={}), "/ego_vehicles"),
    "ego is null": (put(*EGO, value=None), "/ego_vehicles/0"),
    "no route": (drop(*EGO, "route"), "/ego_vehicles/0/route"),
    "one waypoint": (drop(*EGO, "route", 1), "/ego_vehicles/0/route"),
    "number as text": (put(*EGO, "route", 0, "x", value="100"), "/ego_vehicles/0/route/0/x"),
    "boolean as number": (put(*EGO, "route", 0, "x", value=True), "/ego_vehicles/0/route/0/x"),
    "NaN": (put(*EGO, "route", 1, "y", value=float("nan")), "/ego_vehicles/0/route/1/y"),
    "infinity": (put(*EGO, "route", 1, "y", value=float("inf")), "/ego_vehicles/0/route/1/y"),
    "huge float": (put(*EGO, "route", 1, "y", value=1e300), "/ego_vehicles/0/route/1/y"),
    "huge integer": (put(*EGO, "route", 1, "y", value=10**40), "/ego_vehicles/0/route/1/y"),
    "negative speed": (put(*EGO, "route", 1, "speed", value=-1), "/ego_vehicles/0/route/1/speed"),
    "unknown key": (put(*EGO, "colour", value="red"), "/ego_vehicles/0/colour"),
    "unknown top key": (put("npc_cars", value=[]), "/npc_cars"),
    "id with a slash": (put(*EGO, "id", value="a/b"), "/ego_vehicles/0/id"),
    "long id": (put(*EGO, "id", value="a" * 65), "/ego_vehicles/0/id"),
    "number as id": (put(*EGO, "id", value=0), "/ego_vehicles/0/id"),
    "same id twice": (put("npc_vehicles", value=[{**NPC, "id": "ego_0"}]), "/npc_vehicles/0/id"),
    "negative start": (put(*EGO, "start_time", value=-0.1), "/ego_vehicles/0/start_time"),
    "agent as text": (put(*EGO, "agent", value="idm"), "/ego_vehicles/0/agent"),
    "agent and config_path": (put(*EGO, "config_path", value="idm"), "/ego_vehicles/0"),
    "config_path goes up": (
        lambda c: put(*EGO, "config_path", value="../idm.yaml")(drop(*EGO, "agent")(c)),
        "/ego_vehicles/0/config_path",
    ),
    "absolute config_path": (
        lambda c: put(*EGO, "config_path", value="/etc/passwd")(drop(*EGO, "agent")(c)),
        "/ego_vehicles/0/config_path",
    ),
    "agent is code": (
        put(*EGO, "agent", "name", value="os:system"),
        "/ego_vehicles/0/agent/name",
    ),
    "unknown agent": (put(*EGO, "agent", "name", value="nobody"), "/ego_vehicles/0/agent/name"),
    "unknown model": (put(*EGO, "model", value="vehicle.none"), "/ego_vehicles/0/model"),
    "walker as ego": (put(*EGO, "model", value="walker.pedestrian.0001"), "/ego_vehicles/0/model"),
    "ten thousand NPCs": (
        put("npc_vehicles", value=[{**NPC, "id": f"n{i}"} for i in range(10_000)]),
        "/npc_vehicles",
    ),
    "a billion vehicles": (
        put("background_traffic", value={"count": 10**9}),
        "/background_traffic/count",
    ),
    "half a vehicle": (
        put("background_traffic", value={"count": 1.5}),
        "/background_traffic/count",
    ),
    "count and density": (
        put("background_traffic", value={"count": 1, "density": 1.0}),
        "/background_traffic",
    ),
    "unknown behaviour": (
        put("npc_vehicles", value=[{**NPC, "behavior": "wild"}]),
        "/npc_vehicles/0/behavior",
    ),
    "SUMO without a way": (
        put("npc_vehicles", value=[{**NPC, "behavior": "sumo"}]),
        "/npc_vehicles/0/route",
    ),
    "running walker": (
        put("npc_walkers", value=[{**WALKER, "route": [{"x": 60, "y": 160, "speed": 50}]}]),
        "/npc_walkers/0/route/0/speed",
    ),
    "obstacle of a kilometre": (
        put("npc_obstacles", value=[{**CONE, "length": 1000.0}]),
        "/npc_obstacles/0/length",
    ),
    "frictionless patch": (
        put("friction_patches", value=[{**ICE, "friction": 0.0}]),
        "/friction_patches/0/friction",
    ),
    "patch of a kilometre": (
        put("friction_patches", value=[{**ICE, "length": 1000.0}]),
        "/friction_patches/0/length",
    ),
    "patch without a width": (
        put("friction_patches", value=[{k: v for k, v in ICE.items() if k != "width"}]),
        "/friction_patches/0/width",
    ),
    "101 patches": (
        put("friction_patches", value=[{**ICE, "id": f"ice_{n}"} for n in range(101)]),
        "/friction_patches",
    ),
    "patch with an actor's id": (
        put("friction_patches", value=[{**ICE, "id": "ego_0"}]),
        "/friction_patches/0/id",
    ),
    "patch beside the road": (
        put("friction_patches", value=[{**ICE, "location": {"x": 60.0, "y": 175.0}}]),
        "/friction_patches/0/location",
    ),
    "patch off the map": (
        put("friction_patches", value=[{**ICE, "location": {"x": 9e5, "y": 0.0}}]),
        "/friction_patches/0/location",
    ),
    "rain of 200 %": (put("weather", value={"precipitation": 200}), "/weather/precipitation"),
    "light of no time": (
        put("traffic_lights", value={"green_time": 0}),
        "/traffic_lights/green_time",
    ),
    "unknown light": (
        put("traffic_lights", value={"junctions": {"none": {}}}),
        "/traffic_lights/junctions/none",
    ),
    "step of nothing": (put("step_length", value=0), "/step_length"),
    "seed below zero": (put("seed", value=-1), "/seed"),
    "year-long run": (put("max_sim_time", value=3e7), "/max_sim_time"),
    "unknown version": (put("version", value="2.0"), "/version"),
    "unknown frame": (put("frame", value="ros"), "/frame"),
    "extension without a name space": (put("extensions", value={"note": 1}), "/extensions/note"),
    "large extension": (put("extensions", value={"a:b": "x" * 300_000}), "/extensions"),
    "no town": (drop("map_region", "town"), "/map_region/town"),
    "unknown town": (put("map_region", "town", value="Town12"), "/map_region/town"),
    "town is a path": (put("map_region", "town", value="../tee-town"), "/map_region/town"),
    "empty region": (
        put("map_region", "region_segment", value={"min_x": 1, "max_x": 1, "min_y": 0, "max_y": 1}),
        "/map_region/region_segment",
    ),
    "start outside the region": (
        put(
            "map_region",
            "region_segment",
            value={"min_x": 0, "max_x": 50, "min_y": 0, "max_y": 400},
        ),
        "/ego_vehicles/0/route/0",
    ),
    "start off the map": (put(*EGO, "route", 0, "x", value=9e5), "/ego_vehicles/0/route/0"),
    "walker off the map": (
        put("npc_walkers", value=[{**WALKER, "route": [{"x": 60, "y": 160}, {"x": 9e5, "y": 0}]}]),
        "/npc_walkers/0/route/1",
    ),
    "start is the destination": (
        put(*EGO, "route", 1, value=GOOD["ego_vehicles"][0]["route"][0]),
        "/ego_vehicles/0/route/1",
    ),
    "overlapping starts": (
        put("npc_obstacles", value=[{**CONE, "location": {"x": 99.0, "y": 152.0}}]),
        "/npc_obstacles/0/location",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_documents(name: str, networks: NetworkCatalogue) -> None:
    change, pointer = BROKEN[name]
    changed = change(copy.deepcopy(GOOD))
    data = changed if isinstance(changed, str | bytes) else json.dumps(changed)
    with pytest.raises(InvalidDocument) as caught:
        validate_document(parse_document(data), networks, ("idm",))
    assert [problem.pointer for problem in caught.value.problems] == [pointer]
    assert all(problem.message and problem.code for problem in caught.value.problems)


def test_the_unbroken_document_passes(networks: NetworkCatalogue) -> None:
    assert validate_document(parse_document(json.dumps(GOOD)), networks, ("idm",)).notes == ()
