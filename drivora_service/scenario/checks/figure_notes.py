"""Notes on sizes, angles, weather, friction and traffic far from what there is on a road."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from drivora_service.geometry.angles import wrap_angle
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.noted_figures import placed
from drivora_service.scenario.conversion import drivable_kilometres, frame_of
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import PlaceDocument, WeatherDocument
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import NpcObstacle, Scenario, Waypoint
from drivora_service.scenario.models.actor_models import ActorKind, actor_model

LONGEST = 20.0
"""Metres; trucks with a trailer have up to 18.75 m (Directive 96/53/EC of the EU)."""
_SIZE_RATIO = 10.0
"""How many times as large or small as its model an object may be without being noted."""
_LARGE = 4.0
"""Metres up to which no object is noted as large."""
SLIPPERY = 0.05
"""Friction of wet ice, the least that a road has."""
QUEUE_DENSITY = 133.0
"""Vehicles a kilometre of a lane in a standing queue: 7.5 m each."""
_PERCENTAGES = (
    "cloudiness",
    "precipitation",
    "precipitation_deposits",
    "wind_intensity",
    "fog_density",
    "wetness",
)
_AS_DEGREES, _AS_RADIANS = math.radians(30.0), math.radians(15.0)
"""An angle is noted if it is at least so far off the lane in degrees, and at most in radians."""


def figure_notes(document: ScenarioDocument, scenario: Scenario, network: RoadNetwork) -> list[str]:
    """Returns notes on such figures of a scenario."""
    return [
        *_angle_notes(document, scenario, network),
        *_size_notes(scenario),
        *_friction_notes(scenario),
        *_weather_notes(document),
        *_traffic_note(scenario, network),
    ]


def _angle_notes(
    document: ScenarioDocument, scenario: Scenario, network: RoadNetwork
) -> Iterator[str]:
    frame = frame_of(document, network)
    lists: tuple[tuple[str, Sequence[Sequence[PlaceDocument]], Sequence[Sequence[Waypoint]]], ...]
    lists = (
        (
            "ego_vehicles",
            [one.route for one in document.ego_vehicles],
            [one.route for one in scenario.ego_vehicles],
        ),
        (
            "npc_vehicles",
            [one.route for one in document.npc_vehicles],
            [one.route for one in scenario.npc_vehicles],
        ),
    )
    for name, written, routes in lists:
        for index, (places, route) in enumerate(zip(written, routes, strict=True)):
            # One note an actor: its other angles are like it.
            for number, (place, point) in enumerate(zip(places, route, strict=True)):
                note = _angle_note(place.yaw, point, frame, network)
                if note:
                    yield placed((name, index, "route", number, "yaw"), note)
                    break


def _angle_note(
    yaw: float | None, point: Waypoint, frame: FrameTransform, network: RoadNetwork
) -> str:
    """Returns a note on an angle that is along the lane in radians, but not in degrees."""
    if yaw is None or not 0.0 < abs(yaw) <= 2.0 * math.pi:
        return ""
    lane = nearest_lane_position(network, point.x, point.y)
    if lane is None:
        return ""
    meant = math.degrees(yaw)
    is_off = _off(frame.yaw_to_network(yaw), lane.heading) > _AS_DEGREES
    if not is_off or _off(frame.yaw_to_network(meant), lane.heading) > _AS_RADIANS:
        return ""
    return (
        f"{yaw:g}° is across the lane there, and {yaw:g} rad along it; angles are in degrees, and "
        f"{yaw:g} rad are {meant:.3g}°"
    )


def _off(yaw: float, heading: float) -> float:
    """Returns the angle between two directions, either way round, radians."""
    turn = abs(wrap_angle(yaw - heading))
    return min(turn, math.pi - turn)


def _size_notes(scenario: Scenario) -> Iterator[str]:
    for index, obstacle in enumerate(scenario.npc_obstacles):
        for name in ("length", "width"):
            value = getattr(obstacle, name)
            if value is None:
                continue
            own = getattr(actor_model(ActorKind.OBSTACLE, obstacle.model), name)
            is_large = value > LONGEST or value > max(_SIZE_RATIO * own, _LARGE)
            if is_large or value < own / _SIZE_RATIO:
                yield placed(("npc_obstacles", index, name), _size_words(obstacle, value, own))


def _size_words(obstacle: NpcObstacle, value: float, own: float) -> str:
    return f"{value:g} m; {obstacle.model} itself has {own:g} m; sizes are in metres"


def _friction_notes(scenario: Scenario) -> Iterator[str]:
    for index, patch in enumerate(scenario.friction_patches):
        if patch.friction < SLIPPERY:
            yield placed(
                ("friction_patches", index, "friction"),
                f"{patch.friction:g}; wet ice has about {SLIPPERY:g}, packed snow 0.2, a wet road "
                "0.7",
            )


def _weather_notes(document: ScenarioDocument) -> Iterator[str]:
    yield from _fraction_note(("weather",), document.weather)
    for index, change in enumerate(document.weather_changes):
        yield from _fraction_note(("weather_changes", index, "weather"), change.weather)


def _fraction_note(place: tuple[str | int, ...], weather: WeatherDocument) -> Iterator[str]:
    """Yields a note on a weather whose percentages look like fractions."""
    given = {name: value for name in _PERCENTAGES if (value := getattr(weather, name))}
    if given and all(value <= 1.0 for value in given.values()):
        name, value = next(iter(given.items()))
        yield placed(
            (*place, name),
            f"{value:g} %, which has hardly an effect, and no other figure of this weather is "
            f"above 1 %; they are percentages from 0 to 100: {value:g} of 1 is {100 * value:g}",
        )


def _traffic_note(scenario: Scenario, network: RoadNetwork) -> Iterator[str]:
    background, kilometres = scenario.background_traffic, drivable_kilometres(network)
    if background is None or not kilometres or background.count <= QUEUE_DENSITY * kilometres:
        return
    yield placed(
        ("background_traffic",),
        f"{background.count} vehicles on {kilometres:.3g} km of lanes are "
        f"{background.count / kilometres:.0f} a kilometre; a standing queue has about "
        f"{QUEUE_DENSITY:.0f}",
    )
