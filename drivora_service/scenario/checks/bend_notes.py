"""Notes on replayed vehicles that are slower than asked where their waypoints turn."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, Scenario
from drivora_service.scenario.slow_corners import SlowCorner, find_slow_corners
from drivora_service.scenario.waypoint_speeds import most_lateral, waypoint_speeds
from drivora_service.scenario.weather import weather_effects

NOTED_SHARE = 0.9
"""Share of the asked speed below which a vehicle is noted as slow."""


def bend_notes(scenario: Scenario, network: RoadNetwork) -> list[str]:
    """Returns a note for each replayed vehicle that is slower than its waypoints ask in a bend.

    In the weather of the beginning. Only speeds that are written down are asked.
    """
    friction = weather_effects(scenario.weather).friction
    return [
        note
        for npc in scenario.npc_vehicles
        if npc.behavior is NpcBehavior.REPLAY and len(npc.route) > 2
        if (note := _note_of(npc, network, most_lateral(npc.lateral_acceleration, friction)))
    ]


def _note_of(npc: NpcVehicle, network: RoadNetwork, side: float) -> str:
    points = np.array([(point.x, point.y) for point in npc.route])
    waits = np.array([bool(point.wait) for point in npc.route])
    corners = find_slow_corners(points, waypoint_speeds(npc.route, network, None), waits, side)
    slow = [
        corner
        for corner in corners
        if corner.speed < NOTED_SHARE * corner.asked and _is_written(npc, corner)
    ]
    if not slow:
        return ""
    worst = min(slow, key=lambda corner: corner.speed / corner.asked)
    place = npc.route[worst.number]
    others = len(slow) - 1
    more = f", and at {others} more of its waypoints" if others else ""
    return (
        f"NPC {npc.id!r}: slows down from {worst.asked:.1f} m/s to {worst.speed:.1f} m/s at "
        f"waypoint {worst.number} at ({place.x:.2f}, {place.y:.2f}){more}: its way turns there by "
        f"{math.degrees(worst.turn):.0f}° with at most {side:.1f} m/s² to the side; many "
        "waypoints, a metre or two apart, make the bend wide enough; a greater "
        "lateral_acceleration or a lower speed may be enough, too"
    )


def _is_written(npc: NpcVehicle, corner: SlowCorner) -> bool:
    """Returns whether the document asks for the speed at a corner."""
    written = [npc.route[corner.number].speed, npc.route[corner.number + 1].speed]
    return corner.asked in written
