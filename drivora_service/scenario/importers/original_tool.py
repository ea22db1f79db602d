"""Reads scenario files of the original, CARLA-based tool.

Its files are JSON in CARLA's frame with key names of their own: ``trigger_time`` is our
``start_time``, ``npc_statics`` our ``npc_obstacles``, ``traffic_light`` our ``traffic_lights``,
``region`` (``[x_min, x_max, y_min, y_max]``) our ``region_segment``. Waypoints carry pitch, roll,
``road_option`` and lane data, which are unused here, since the lane graph is the network's. What a
file says about Python entry points is dropped: a document never names code.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.importers.imported import ImportedScenario, short_name
from drivora_service.scenario.plain_data import plain_data

DEFAULT_VEHICLE = "vehicle.lincoln.mkz_2017"

_ACTOR_LISTS: Mapping[str, str] = {
    "ego_vehicles": "ego_vehicles",
    "npc_vehicles": "npc_vehicles",
    "npc_walkers": "npc_walkers",
    "npc_statics": "npc_obstacles",
}
_WEATHER = (
    "cloudiness",
    "precipitation",
    "precipitation_deposits",
    "wind_intensity",
    "sun_azimuth_angle",
    "sun_altitude_angle",
    "fog_density",
    "fog_distance",
    "wetness",
    "fog_falloff",
)
_SILENT = frozenset({"pitch", "roll", "rolename", "color", "category", "scenario_type", "pattern"})
"""Keys without effect on a run; dropped without a note."""
_BACK: Mapping[str, str] = {
    "npc_obstacles": "npc_statics",
    "start_time": "trigger_time",
    "traffic_lights": "traffic_light",
    "region_segment": "region",
}


def is_original(content: Mapping[str, Any]) -> bool:
    """Returns whether a file is of the original tool, by keys that only these have."""
    if any(key in content for key in ("scenario_type", "npc_statics", "traffic_light")):
        return True
    egos = content.get("ego_vehicles")
    first = egos[0] if isinstance(egos, list) and egos else None
    return isinstance(first, Mapping) and ("trigger_time" in first or "entry_point" in first)


def import_original(
    data: str | bytes | Mapping[str, Any], *, agent: str = "idm"
) -> ImportedScenario:
    """Reads a file of the original tool.

    Args:
        data: Its text, or data from a JSON parser.
        agent: The agent that drives every ego; that of the file names Python code.

    Raises:
        InvalidDocument: Every problem, with pointers into the original file.
    """
    content, odd = plain_data(data)
    if odd:
        raise InvalidDocument(tuple(odd))
    reader = _Reader(agent)
    translated = reader.scenario(content)
    try:
        document = parse_document(translated)
    except InvalidDocument as error:
        raise InvalidDocument(
            tuple(
                Problem(
                    pointer=_original_pointer(problem.pointer),
                    code=problem.code,
                    message=problem.message,
                )
                for problem in error.problems
            )
        ) from error
    name = short_name(str(content.get("id") or ""), document.map_region.town)
    return ImportedScenario(name=name, document=document, notes=reader.notes())


def _original_pointer(place: str) -> str:
    tokens = [_BACK.get(token, token) for token in place.split("/")]
    if "region" in tokens:
        tokens = tokens[: tokens.index("region") + 1]
    return "/".join(tokens)


class _Reader:
    """Translates one file and records dropped parts."""

    def __init__(self, agent: str) -> None:
        self._agent = agent
        self._dropped: Counter[str] = Counter()
        self._remarks: list[str] = []

    def notes(self) -> tuple[str, ...]:
        """Notes on dropped parts, in a stable order."""
        dropped = [f"dropped {key} ({count} times)" for key, count in sorted(self._dropped.items())]
        return (*self._remarks, *dropped)

    def scenario(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Translates the whole file."""
        result: dict[str, Any] = {"frame": "carla"}
        for original, ours in _ACTOR_LISTS.items():
            actors = content.get(original)
            if actors is not None:
                result[ours] = (
                    [self._actor(actor, ours) for actor in actors]
                    if isinstance(actors, list)
                    else actors
                )
        if content.get("map_region") is not None:
            result["map_region"] = self._map_region(content["map_region"], result)
        if content.get("weather") is not None:
            result["weather"] = self._select(content["weather"], _WEATHER, "weather")
        if content.get("traffic_light") is not None:
            result["traffic_lights"] = self._lights(content["traffic_light"])
        if isinstance(content.get("id"), str):
            result["extensions"] = {"original_tool:id": content["id"]}
        known = {*_ACTOR_LISTS, "map_region", "weather", "traffic_light", "id"}
        self._drop(content, known, "")
        return result

    def _actor(self, actor: Any, kind: str) -> Any:
        if not isinstance(actor, Mapping):
            return actor
        result = self._select(actor, ("id", "model", "trigger_time", "route", "location"), kind)
        if "trigger_time" in result:
            result["start_time"] = result.pop("trigger_time")
        if kind == "ego_vehicles":
            result["agent"] = {"name": self._agent}
        if "model" not in result and kind in ("ego_vehicles", "npc_vehicles"):
            result["model"] = DEFAULT_VEHICLE
            self._remarks.append(f"{kind} {actor.get('id')!r} has no model; took {DEFAULT_VEHICLE}")
        if isinstance(result.get("route"), list):
            result["route"] = [self._waypoint(place, kind) for place in result["route"]]
        if "location" in result:
            result["location"] = self._waypoint(result["location"], kind)
        return result

    def _waypoint(self, place: Any, kind: str) -> Any:
        if not isinstance(place, Mapping):
            return place
        keys = (
            ("x", "y", "z", "yaw") if kind == "npc_obstacles" else ("x", "y", "z", "yaw", "speed")
        )
        result = self._select(place, keys, "waypoints")
        if kind == "npc_walkers" and result.get("speed") == 0:
            del result["speed"]
            self._dropped["speed 0 of walkers' waypoints"] += 1
        return result

    def _map_region(self, region: Any, scenario: Mapping[str, Any]) -> Any:
        if not isinstance(region, Mapping):
            return region
        result = self._select(region, ("town",), "map_region", also=("region",))
        corners = region.get("region")
        if corners is None:
            return result
        if not (isinstance(corners, list) and len(corners) == 4 and all(map(_is_number, corners))):
            message = "found no list of four numbers; [x_min, x_max, y_min, y_max] is needed"
            problem = Problem(pointer="/map_region/region", code="region", message=message)
            raise InvalidDocument((problem,))
        xs, ys = corners[:2], corners[2:]
        places = [place for place in _places(scenario) if _is_place(place)]
        grown_xs = [*xs, *(place["x"] for place in places)]
        grown_ys = [*ys, *(place["y"] for place in places)]
        segment = {
            "min_x": min(grown_xs),
            "max_x": max(grown_xs),
            "min_y": min(grown_ys),
            "max_y": max(grown_ys),
        }
        if [*segment.values()] != [float(value) for value in corners]:
            self._remarks.append("the region was grown to contain every position of the scenario")
        return {**result, "region_segment": segment}

    def _lights(self, lights: Any) -> Any:
        pattern = lights.get("pattern") if isinstance(lights, Mapping) else None
        if pattern is not None:
            self._remarks.append(
                f"the traffic-light pattern {pattern!r} is not carried; the network's own "
                "programmes run with the given times"
            )
        return self._select(lights, ("green_time", "red_time", "yellow_time"), "traffic_light")

    def _select(
        self, source: Any, keys: tuple[str, ...], where: str, also: tuple[str, ...] = ()
    ) -> Any:
        """Selects the given keys, and notes the others."""
        if not isinstance(source, Mapping):
            return source
        self._drop(source, {*keys, *also}, where)
        return {key: source[key] for key in keys if source.get(key) is not None}

    def _drop(self, source: Mapping[str, Any], known: set[str], where: str) -> None:
        for key, value in source.items():
            if key not in known and key not in _SILENT and value is not None:
                self._dropped[f"{str(key)[:60]!r}{' of ' + where if where else ''}"] += 1


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_place(place: Any) -> bool:
    return isinstance(place, Mapping) and _is_number(place.get("x")) and _is_number(place.get("y"))


def _places(scenario: Mapping[str, Any]) -> list[Any]:
    places: list[Any] = []
    for kind in _ACTOR_LISTS.values():
        actors = scenario.get(kind)
        for actor in actors if isinstance(actors, list) else ():
            if isinstance(actor, Mapping):
                route = actor.get("route")
                places += route if isinstance(route, list) else []
                places.append(actor.get("location"))
    return places
