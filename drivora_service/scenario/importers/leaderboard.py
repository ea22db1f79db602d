"""Reads route files of the CARLA Leaderboard: the flat form of 1.0 and the nested one of 2.x.

A route becomes the route of one ego. Its town's coordinates are CARLA's. Scenarios that the
Leaderboard starts from trigger points (2.x) are behaviours of its own runner and are not imported;
the notes list them. Of weather that changes along the route (2.x), that of the start is used.
"""

from __future__ import annotations

from collections import Counter
from typing import Any
from xml.etree import ElementTree

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.importers.imported import ImportedScenario, short_name
from drivora_service.scenario.plain_data import MAX_DEPTH, MAX_DOCUMENT_BYTES, decode_text, refusal

EGO_MODEL = "vehicle.lincoln.mkz_2017"
MAX_ROUTES = 2000
_WAYPOINT = ("x", "y", "z", "yaw")
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


def import_routes(data: str | bytes, *, agent: str = "idm") -> tuple[ImportedScenario, ...]:
    """Reads every route of a file.

    Args:
        data: Text of the XML file.
        agent: The agent that drives every ego.

    Raises:
        InvalidDocument: Every problem; pointers start with ``/routes/INDEX`` of the route.
    """
    root = _parse_xml(decode_text(data, MAX_DOCUMENT_BYTES))
    routes = root.findall("route")
    if root.tag != "routes" or not routes:
        raise refusal("no_routes", f"found <{root.tag}>; <routes> with <route> in it is needed")
    if len(routes) > MAX_ROUTES:
        raise refusal("too_long", f"found {len(routes)} routes; at most {MAX_ROUTES} are allowed")
    problems: list[Problem] = []
    scenarios: list[ImportedScenario] = []
    for index, route in enumerate(routes):
        try:
            scenarios.append(_scenario(route, agent))
        except InvalidDocument as error:
            problems += [
                Problem(
                    pointer=f"/routes/{index}{problem.pointer}",
                    code=problem.code,
                    message=problem.message,
                )
                for problem in error.problems
            ]
    if problems:
        raise InvalidDocument(tuple(problems))
    return tuple(scenarios)


def _parse_xml(text: str) -> ElementTree.Element:
    """Parses XML without a document type, so without entities, and of bounded depth."""
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise refusal("not_xml", "found a document type; it is not allowed")
    parser = ElementTree.XMLParser(target=_Bounded(ElementTree.TreeBuilder()))
    try:
        parser.feed(text)
        root: ElementTree.Element = parser.close()
    except ElementTree.ParseError as error:
        raise refusal("not_xml", f"not XML: {error}") from error
    except ValueError as error:  # an encoding that the text does not have
        raise refusal("not_xml", f"not XML: {error}") from error
    return root


class _Bounded:
    """Passes elements to a tree builder, up to a maximum depth."""

    def __init__(self, builder: ElementTree.TreeBuilder) -> None:
        self._builder = builder
        self._depth = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Opens an element."""
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise refusal("too_deep", f"found nesting deeper than {MAX_DEPTH} levels")
        self._builder.start(tag, attributes)

    def end(self, tag: str) -> None:
        """Closes an element."""
        self._depth -= 1
        self._builder.end(tag)

    def close(self) -> ElementTree.Element:
        """Returns the root."""
        return self._builder.close()


def _scenario(route: ElementTree.Element, agent: str) -> ImportedScenario:
    notes: list[str] = []
    identifier = route.get("id", "0")
    town = route.get("town", "")
    weather = _weather(route, notes)
    places = route.findall("waypoint") or route.findall("waypoints/position")
    content: dict[str, Any] = {
        "frame": "carla",
        "map_region": {"town": town},
        "ego_vehicles": [
            {
                "id": "ego_0",
                "model": EGO_MODEL,
                "agent": {"name": agent},
                "route": [_numbers(place, _WAYPOINT) for place in places],
            }
        ],
        "extensions": {"leaderboard:route": identifier},
    }
    if weather is not None:
        content["weather"] = _numbers(weather, _WEATHER)
    kinds = Counter(item.get("type", "?") for item in route.findall("scenarios/scenario"))
    if kinds:
        listing = ", ".join(f"{kind} ({count})" for kind, count in sorted(kinds.items()))
        notes.append(f"scenarios of the Leaderboard's runner are not carried: {listing}")
    known = {"waypoint", "waypoints", "weather", "weathers", "scenarios"}
    others = sorted({str(child.tag) for child in route} - known)
    if others:
        notes.append(f"not carried: {', '.join(others)}")
    return ImportedScenario(
        name=short_name(f"{town}_route_{identifier.zfill(2)}", "route"),
        document=parse_document(content),
        notes=tuple(notes),
    )


def _weather(route: ElementTree.Element, notes: list[str]) -> ElementTree.Element | None:
    stages = route.findall("weather") + route.findall("weathers/weather")
    if not stages:
        return None
    if len(stages) > 1:
        notes.append(
            f"the weather changes {len(stages) - 1} times along the route; "
            "that of its start was taken"
        )
    return min(stages, key=_percentage)


def _percentage(stage: ElementTree.Element) -> float:
    number = _number(stage.get("route_percentage", "0"))
    return number if isinstance(number, float) else float("inf")


def _numbers(element: ElementTree.Element, names: tuple[str, ...]) -> dict[str, float | str]:
    return {name: _number(element.attrib[name]) for name in names if name in element.attrib}


def _number(text: str) -> float | str:
    """Reads a number; other text is kept, which the document rejects with its place."""
    try:
        return float(text)
    except ValueError:
        return text
