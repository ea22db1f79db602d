"""Notes on times that lie beyond the end of the episode, or are far too long."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.checks.noted_figures import duration_words, placed
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import LightTimesDocument
from drivora_service.scenario.model import (
    EgoVehicle,
    NpcObstacle,
    NpcVehicle,
    NpcWalker,
    Scenario,
)

LONG_STAGE = 300.0
"""Seconds; the cycles of signal programmes last at most two to three minutes."""
LONG_YELLOW = 10.0
"""Seconds; yellow lasts 3 to 6 s, by the speed limit."""
LONG_RUN = 1800.0
"""Seconds up to which no time limit is noted as long."""
_LONG_RUN_FACTOR = 20.0
"""How many times the time that the routes need the limit may be without being noted."""
_SLOW = 1.0
"""m/s; an ego that is slower on average has not arrived when a derived time limit is over."""
_UNHURRIED = 5.0
"""m/s."""
_WAITING = 600.0
"""Seconds that a derived time limit may have for waiting at signals."""

_Actor = EgoVehicle | NpcVehicle | NpcWalker | NpcObstacle


def time_notes(document: ScenarioDocument, scenario: Scenario, network: RoadNetwork) -> list[str]:
    """Returns notes on the times of a scenario.

    Raises:
        NoRoute: An ego has no route.
    """
    return [
        *_late_notes(scenario, latest_end(scenario, network)),
        *_limit_note(scenario, network),
        *_light_notes(document),
    ]


def latest_end(scenario: Scenario, network: RoadNetwork) -> float:
    """Returns the time at which an episode has certainly ended, seconds.

    Its time limit; where that is derived from the routes, more than that.

    Raises:
        NoRoute: An ego has no route.
    """
    if scenario.max_sim_time is not None:
        return scenario.max_sim_time
    return _WAITING + _driving_time(scenario, network, _SLOW)


def _driving_time(scenario: Scenario, network: RoadNetwork, speed: float) -> float:
    """Returns when the last ego has arrived at such an average speed, seconds."""
    return max(
        ego.start_time + plan_route(network, route_points(ego.route)).length / speed
        for ego in scenario.ego_vehicles
    )


def _late_notes(scenario: Scenario, end: float) -> Iterator[str]:
    """Yields a note for each time at which the episode has ended."""
    is_given = scenario.max_sim_time is not None
    over = f"the run ends at {end:g} s" if is_given else f"the run has ended before {end:.0f} s"
    lists: tuple[tuple[str, Sequence[_Actor], str], ...] = (
        ("ego_vehicles", scenario.ego_vehicles, "it never drives"),
        ("npc_vehicles", scenario.npc_vehicles, "it never appears"),
        ("npc_walkers", scenario.npc_walkers, "it never appears"),
        ("npc_obstacles", scenario.npc_obstacles, "it never appears"),
    )
    for name, actors, effect in lists:
        for index, actor in enumerate(actors):
            if actor.start_time >= end:
                yield _late((name, index, "start_time"), actor.start_time, over, effect)
    for index, npc in enumerate(scenario.npc_vehicles):
        for number, point in enumerate(npc.route):
            if point.wait is not None and point.wait >= end:
                wait = ("npc_vehicles", index, "route", number, "wait")
                yield _late(wait, point.wait, over, "it stands there for the rest of the run")
    for index, change in enumerate(scenario.weather_changes):
        if change.time >= end:
            change_time = ("weather_changes", index, "time")
            yield _late(change_time, change.time, over, "it never changes")
    background = scenario.background_traffic
    if background is not None and background.start_time >= end:
        start = ("background_traffic", "start_time")
        yield _late(start, background.start_time, over, "there is none")


def _late(place: tuple[str | int, ...], time: float, over: str, effect: str) -> str:
    return placed(place, f"{duration_words(time)}; {over}: {effect}; times are in seconds")


def _limit_note(scenario: Scenario, network: RoadNetwork) -> Iterator[str]:
    limit = scenario.max_sim_time
    if limit is None or limit <= LONG_RUN:
        return
    needed = _driving_time(scenario, network, _UNHURRIED)
    if limit > _LONG_RUN_FACTOR * needed:
        yield placed(
            ("max_sim_time",),
            f"{duration_words(limit)}; the routes take about {needed:.0f} s at {_UNHURRIED:g} m/s; "
            "times are in seconds",
        )


def _light_notes(document: ScenarioDocument) -> Iterator[str]:
    lights = document.traffic_lights
    places: list[tuple[tuple[str | int, ...], LightTimesDocument]] = [(("traffic_lights",), lights)]
    places += [
        (("traffic_lights", "junctions", name), times) for name, times in lights.junctions.items()
    ]
    for place, times in places:
        for name, most in (
            ("green_time", LONG_STAGE),
            ("red_time", LONG_STAGE),
            ("yellow_time", LONG_YELLOW),
        ):
            value = getattr(times, name)
            if value is not None and value > most:
                yield placed(
                    (*place, name),
                    f"{duration_words(value)}; signals rarely show it for more than {most:g} s; "
                    "times are in seconds",
                )
