"""The parts of a document that may be left out: actors, settings, waypoints, and optional values.

Every function returns one edit for each part; any number of them can be applied together. The ADS
under test, its parameters and the ego that fails always stay.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivora_service.scenario.document_problems import model_at
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.suites.minimization.edits import Edit, Place, content_of, removal

ACTORS = {
    "ego_vehicles": "ego",
    "npc_vehicles": "NPC vehicle",
    "npc_walkers": "walker",
    "npc_obstacles": "obstacle",
}
"""Lists of actors in a document, with the name of one of them."""

PATCHES = "friction_patches"

_MOVING = ("ego_vehicles", "npc_vehicles", "npc_walkers")
_KEPT = frozenset({"agent", "config_path"})
"""Keys of an ego that say which ADS is under test."""
_SETTINGS = ("seed", "stuck_after")


def actors(document: ScenarioDocument, ego: str) -> list[Edit]:
    """Returns the removal of each actor but the ego that fails, of patches and of background."""
    content = content_of(document)
    found = [
        removal((key, index), f"without {name} {actor['id']}")
        for key, name in ACTORS.items()
        for index, actor in enumerate(content.get(key, ()))
        if not (key == "ego_vehicles" and actor["id"] == ego)
    ]
    found += [
        removal((PATCHES, index), f"without patch {patch['id']}")
        for index, patch in enumerate(content.get(PATCHES, ()))
    ]
    if "background_traffic" in content:
        found.append(removal(("background_traffic",), "without background traffic"))
    return found


def settings(document: ScenarioDocument) -> list[Edit]:
    """Returns the removal of each setting of weather, lights, region, extensions and run."""
    content = content_of(document)
    places: list[Place] = [("weather", name) for name in content.get("weather", ())]
    places += [
        ("weather_changes", index) for index in range(len(content.get("weather_changes", ())))
    ]
    for index, change in enumerate(content.get("weather_changes", ())):
        places += [
            ("weather_changes", index, "weather", name) for name in change.get("weather", ())
        ]
    places += _light_places(content.get("traffic_lights", {}))
    places += [("extensions", name) for name in content.get("extensions", ())]
    places += [(name,) for name in _SETTINGS if name in content]
    if "region_segment" in content["map_region"]:
        places.append(("map_region", "region_segment"))
    if "start_time" in (content.get("background_traffic") or {}):
        places.append(("background_traffic", "start_time"))
    return [removal(place, f"without {' '.join(map(str, place))}") for place in places]


def waypoints(document: ScenarioDocument) -> list[Edit]:
    """Returns the removal of each waypoint; the start and the end of an ego's route stay."""
    content, found = content_of(document), []
    for key in _MOVING:
        for index, actor in enumerate(content.get(key, ())):
            last = len(actor["route"]) - 1
            numbers = range(1, last) if key == "ego_vehicles" else range(last + 1)
            if key != "ego_vehicles" and last == 0:
                continue
            found += [
                removal((key, index, "route", number), f"{actor['id']} without waypoint {number}")
                for number in numbers
            ]
    return found


def details(document: ScenarioDocument) -> list[Edit]:
    """Returns the removal of each optional value of an actor, its waypoints, and of a patch."""
    content = content_of(document)
    return [
        removal(place, f"{actor['id']} without {' '.join(map(str, place[2:]))}")
        for key in (*ACTORS, PATCHES)
        for index, actor in enumerate(content.get(key, ()))
        for place in _optional_places(actor, (key, index))
    ]


def _light_places(lights: dict[str, Any]) -> Iterator[Place]:
    for name, value in lights.items():
        if name != "junctions":
            yield ("traffic_lights", name)
            continue
        for junction, times in value.items():
            yield ("traffic_lights", name, junction)
            if len(times) > 1:
                for time in times:
                    yield ("traffic_lights", name, junction, time)


def _optional_places(part: Any, place: Place) -> Iterator[Place]:
    if isinstance(part, list):
        for index, item in enumerate(part):
            yield from _optional_places(item, (*place, index))
    elif isinstance(part, dict):
        fields = model_at(ScenarioDocument, place).model_fields
        for key, value in part.items():
            if key in _KEPT:
                continue
            if not fields[key].is_required():
                yield (*place, key)
            elif isinstance(value, dict | list):
                yield from _optional_places(value, (*place, key))
