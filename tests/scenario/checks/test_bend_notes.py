from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.checks.bend_notes import bend_notes
from drivora_service.scenario.exporting import document_content
from drivora_service.scenario.model import NpcVehicle, Waypoint, Weather
from drivora_service.scenario.validation import validate_data
from tests.simulation.episodes import ROAD, car, ego, network, place, run, scenario, speeds


def turning(degrees: float, *, speed: float | None = 26.0, **more: Any) -> NpcVehicle:
    """A vehicle on two lines of 60 m, beside the lanes of ``highway``."""
    start = place("eb_1_1", 60, on="highway")
    turn = math.radians(degrees)
    ways = (0.0, 0.0), (60.0, 0.0), (60.0 * (1.0 + math.cos(turn)), 60.0 * math.sin(turn))
    route = (Waypoint(x=start.x + x, y=start.y + y, speed=speed) for x, y in ways)
    return replace(car(*route, behavior="replay"), **more)


def notes(npc: NpcVehicle, **more: Any) -> list[str]:
    what = scenario(
        ego(place("eb_1_0", 10, on="highway"), place("eb_1_0", 300, on="highway")),
        on="highway",
        npc_vehicles=(npc,),
    )
    return bend_notes(replace(what, **more), network("highway"))


def test_a_sharp_corner_is_noted_with_what_to_do() -> None:
    (note,) = notes(turning(45.0))
    assert note.startswith("NPC 'npc': slows down from 26.0 m/s to 3.9 m/s at waypoint 1 at (")
    assert "turns there by 45° with at most 5.9 m/s² to the side" in note
    assert "a greater lateral_acceleration" in note


def test_a_gentle_bend_of_coarse_waypoints_is_noted() -> None:
    (note,) = notes(turning(10.0))
    assert note.startswith("NPC 'npc': slows down from 26.0 m/s to 8.2 m/s at waypoint 1 at (")
    assert "many waypoints" in note


def test_a_bend_that_is_driven_as_asked_is_not_noted() -> None:
    assert not notes(turning(0.5))
    assert not notes(turning(45.0, speed=3.5))


def test_the_grip_and_the_lateral_acceleration_count() -> None:
    (note,) = notes(turning(45.0, speed=3.5, lateral_acceleration=1.0))
    assert "at most 1.0 m/s²" in note
    wet = Weather(precipitation=100.0, precipitation_deposits=100.0)
    assert notes(turning(45.0, speed=3.5), weather=wet)


def test_a_speed_that_is_not_written_down_is_not_asked() -> None:
    assert not notes(turning(45.0, speed=None))


def test_validation_notes_it_and_the_vehicle_is_that_slow() -> None:
    corner = (
        place(ROAD, 20, speed=9.0),
        place(ROAD, 50, speed=9.0),
        place(ROAD, 70, right=-18.0, speed=9.0),
    )
    what = scenario(
        ego(place("-north_2_0", 10), place("-north_2_0", 130)),
        npc_vehicles=(car(*corner, behavior="replay"),),
        seconds=8.0,
    )
    valid = validate_data(document_content(what), NetworkCatalogue(shipped_networks()), None)
    (note,) = (note for note in valid.notes if "slows down" in note)
    told = float(note.split(" to ")[1].split(" m/s")[0])
    assert abs(min(speeds(run(what), "npc")[1:-1]) - told) < 0.3
