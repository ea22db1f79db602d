"""Checks that what an NPC vehicle is told about its driving has a meaning for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivora_service.errors import Problem
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import NpcVehicleDocument, NpcWaypointDocument
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, RouteEnd, Scenario, Waypoint
from drivora_service.scenario.plain_data import pointer


def check_driving(content: ScenarioDocument | Scenario) -> Iterator[Problem]:
    """Yields a problem for each part that a vehicle could not follow.

    SUMO drives vehicles of behavior ``sumo`` by its own models and removes them at their
    destinations; a parked vehicle stands anyway, and never drives on.
    """
    vehicles: Sequence[NpcVehicleDocument | NpcVehicle] = content.npc_vehicles
    for index, npc in enumerate(vehicles):
        place = ("npc_vehicles", index)
        if npc.behavior is NpcBehavior.SUMO:
            if npc.at_end is not RouteEnd.LEAVE:
                yield _not_for_sumo((*place, "at_end"), f"at_end {npc.at_end.value!r}")
            for name in ("deceleration", "lateral_acceleration"):
                value = getattr(npc, name)
                if value is not None:
                    yield _not_for_sumo((*place, name), f"{name} {value:g} m/s²")
        waypoints: Sequence[NpcWaypointDocument | Waypoint] = npc.route
        for number, waypoint in enumerate(waypoints):
            if waypoint.wait is None:
                continue
            at = (*place, "route", number, "wait")
            if npc.behavior is NpcBehavior.SUMO:
                yield _not_for_sumo(at, f"wait {waypoint.wait:g} s")
            elif len(npc.route) == 1:
                message = (
                    f"found wait {waypoint.wait:g} s at the only waypoint; such a vehicle is "
                    "parked and stays: leave `wait` out, or add the waypoint to which it drives on"
                )
                yield Problem(pointer=pointer(at), code="parked_waits", message=message)


def _not_for_sumo(place: tuple[str | int, ...], found: str) -> Problem:
    message = (
        f"found {found}, but SUMO drives a vehicle of behavior sumo by its own models and removes "
        "it at its destination; use behavior reactive or replay, or leave it out"
    )
    return Problem(pointer=pointer(place), code="not_for_sumo", message=message)
