from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.validation import validate_data


def placed(result: Any) -> list[str]:
    """The notes that begin with a place."""
    return [note for note in result.notes if note.startswith("/")]


def walker(start_time: float) -> dict[str, Any]:
    route = [{"x": 40.0, "y": 160.0}, {"x": 40.0, "y": 145.0}]
    return {
        "id": "walker",
        "model": "walker.pedestrian.0001",
        "route": route,
        "start_time": start_time,
    }


def test_a_start_after_the_end_is_noted(good: dict[str, Any], valid: Any) -> None:
    good |= {"max_sim_time": 30.0, "npc_walkers": [walker(3000.0)]}
    (note,) = placed(valid(good))
    assert note == (
        "/npc_walkers/0/start_time: 3000 s (50 min); the run ends at 30 s: it never appears; times "
        "are in seconds"
    )
    good["npc_walkers"] = [walker(29.0)]
    assert not placed(valid(good))


def test_without_a_time_limit_only_a_start_that_cannot_happen_is_noted(
    good: dict[str, Any], valid: Any
) -> None:
    good["npc_walkers"] = [walker(3000.0)]
    (note,) = placed(valid(good))
    assert "the run has ended before 670 s" in note
    good["npc_walkers"] = [walker(300.0)]
    assert not placed(valid(good))


def test_every_kind_of_late_time_has_its_place(good: dict[str, Any], valid: Any) -> None:
    good["ego_vehicles"][0]["start_time"] = 40.0
    good |= {
        "max_sim_time": 30.0,
        "npc_vehicles": [
            {
                "id": "npc",
                "model": "vehicle.audi.tt",
                "route": [
                    {"x": 30.0, "y": 153.2},
                    {"x": 20.0, "y": 153.2, "wait": 500.0},
                    {"x": 10.0, "y": 153.2},
                ],
                "behavior": "replay",
            }
        ],
        "npc_obstacles": [
            {
                "id": "cone",
                "model": "static.prop.trafficcone01",
                "location": {"x": 60.0, "y": 158.0},
                "start_time": 31.0,
            }
        ],
        "weather_changes": [{"time": 2000.0, "weather": {"wetness": 50.0}}],
        "background_traffic": {"count": 2, "start_time": 30.0},
    }
    places = [note.partition(":")[0] for note in placed(valid(good))]
    assert places == [
        "/ego_vehicles/0/start_time",
        "/npc_obstacles/0/start_time",
        "/npc_vehicles/0/route/1/wait",
        "/weather_changes/0/time",
        "/background_traffic/start_time",
    ]


@pytest.mark.parametrize(("limit", "is_noted"), [(6000.0, True), (1800.0, False), (60.0, False)])
def test_a_time_limit_far_beyond_what_the_routes_need_is_noted(
    good: dict[str, Any], valid: Any, limit: float, is_noted: bool
) -> None:
    good["max_sim_time"] = limit
    notes = placed(valid(good))
    assert bool(notes) is is_noted
    assert all(note.startswith("/max_sim_time: 6000 s (100 min); the routes") for note in notes)


def test_light_times_in_milliseconds_are_noted(
    repository: Path, networks: NetworkCatalogue
) -> None:
    file = repository / "openscenario_schemas" / "examples" / "signalised-grid.json"
    document = json.loads(file.read_text("utf-8"))
    (junction, *_) = networks.get("signal-grid").programs

    def notes_on(lights: dict[str, Any]) -> list[str]:
        return placed(validate_data(document | {"traffic_lights": lights}, networks, None))

    (note,) = notes_on({"green_time": 3000.0, "yellow_time": 4.0})
    assert note.startswith("/traffic_lights/green_time: 3000 s (50 min); signals rarely show it")
    (note,) = notes_on({"junctions": {junction: {"yellow_time": 30.0, "red_time": 90.0}}})
    assert note.startswith(
        f"/traffic_lights/junctions/{junction}/yellow_time: 30 s; signals rarely"
    )
