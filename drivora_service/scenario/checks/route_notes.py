"""Notes on the interpretation of a route's waypoints: detours, and omitted waypoints."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.route_matching import Leg
from drivora_service.networks.routes.routing import match_route
from drivora_service.scenario.checks.place_checks import OffLanePlace
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.model import NpcBehavior, Scenario, Waypoint

LONG_LEG_FACTOR = 1.5
LONG_LEG_LENGTH = 50.0
"""Factor and metres by which a leg must be longer than the straight lines between its waypoints to
be noted."""


def route_notes(scenario: Scenario, network: RoadNetwork) -> list[str]:
    """Returns notes on unexpected routes through waypoints.

    They concern the routes of the egos and of the NPCs that SUMO drives. A route of a start and a
    destination alone leaves its way open.

    Raises:
        NoRoute: One of the routes is not drivable.
    """
    driven = [npc for npc in scenario.npc_vehicles if npc.behavior is NpcBehavior.SUMO]
    return [
        note
        for kind, actors in (("ego", scenario.ego_vehicles), ("NPC", driven))
        for actor in actors
        if len(actor.route) > 2
        for note in _notes_of(network, f"{kind} {actor.id!r}", actor.route)
    ]


def snap_notes(
    snapped: Sequence[OffLanePlace], scenario: Scenario, network: RoadNetwork
) -> list[str]:
    """Returns a note for each waypoint of an ego that lies off the lanes and is passed.

    Raises:
        NoRoute: An ego has no route.
    """
    routes = {ego.id: ego.route for ego in scenario.ego_vehicles}
    notes = []
    for off in snapped:
        left_out = match_route(network, route_points(routes[off.actor.id])).left_out
        if off.place not in left_out:
            place = off.actor.places[off.place]
            notes.append(
                f"ego {off.actor.id!r}: waypoint {off.place} at ({place.x:.2f}, {place.y:.2f}) "
                f"lies {off.distance:.1f} m from the nearest lane and was snapped to it"
            )
    return notes


def _notes_of(network: RoadNetwork, name: str, route: Sequence[Waypoint]) -> list[str]:
    match = match_route(network, route_points(route))
    notes = []
    for leg in match.legs:
        missed = [number for number in match.left_out if leg.first < number < leg.last]
        if missed:
            notes.append(_left_out_note(name, route, missed))
        if _is_long(leg):
            notes.append(_long_leg_note(name, route, leg))
    lost = [number for number in match.left_out if number > match.legs[-1].last]
    if lost:
        notes.append(
            f"{_left_out_note(name, route, lost)}; the route ends at waypoint {match.legs[-1].last}"
        )
    return notes


def _is_long(leg: Leg) -> bool:
    return leg.length > max(LONG_LEG_FACTOR * leg.polyline, leg.polyline + LONG_LEG_LENGTH)


def _left_out_note(name: str, route: Sequence[Waypoint], numbers: Sequence[int]) -> str:
    places = ", ".join(_place(route, number) for number in numbers)
    verb = "is" if len(numbers) == 1 else "are"
    return (
        f"{name}: {'waypoint' if len(numbers) == 1 else 'waypoints'} {places} {verb} left out: "
        "the lanes lead there only by a detour much longer than the distance to the waypoints "
        "before and behind"
    )


def _long_leg_note(name: str, route: Sequence[Waypoint], leg: Leg) -> str:
    return (
        f"{name}: the way from waypoint {_place(route, leg.first)} to {_place(route, leg.last)} is "
        f"{leg.length:.0f} m long for a distance of {leg.polyline:.0f} m"
    )


def _place(route: Sequence[Waypoint], number: int) -> str:
    return f"{number} at ({route[number].x:.2f}, {route[number].y:.2f})"
