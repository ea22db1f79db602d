"""Files of the original tool."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.importers.original_tool import import_original
from drivora_service.scenario.importers.reading import FileFormat, detect_format, read_scenarios
from drivora_service.scenario.model import NpcBehavior
from drivora_service.scenario.validation import validate_document


def waypoint(x: float, y: float, **more: Any) -> dict[str, Any]:
    return {
        "x": x,
        "y": y,
        "z": 0.2,
        "pitch": 0.0,
        "yaw": 180.0,
        "roll": 0.0,
        "speed": 8.0,
        "road_option": "LANEFOLLOW",
        "lane_id": 1,
        **more,
    }


def original_file() -> dict[str, Any]:
    """A file of the original tool on tee-town, whose network lies at its origin."""
    return {
        "id": "tee #1",
        "scenario_type": "open_scenario",
        "ego_vehicles": [
            {
                "id": "ego_0",
                "model": None,
                "rolename": "hero",
                "color": None,
                "category": "car",
                "route": [waypoint(100.0, -152.1), waypoint(60.0, -152.7), waypoint(30.0, -153.2)],
                "trigger_time": 0.0,
                "route_func_coverage": ["lane_type_straight"],
                "route_esitmated_length": 70.0,
                "entry_point": "some_package.some_agent:Agent",
                "config_path": "some/where/config.json",
            }
        ],
        "npc_vehicles": [
            {
                "id": "npc_0",
                "model": "vehicle.tesla.model3",
                "rolename": "npc",
                "trigger_time": 2.5,
                "ignore_traffic_lights": True,
                "route": [waypoint(80.0, -152.4), waypoint(40.0, -153.1)],
            }
        ],
        "npc_walkers": [
            {
                "id": "walker_0",
                "model": "walker.pedestrian.0001",
                "rolename": "npc",
                "trigger_time": 1.0,
                "route": [waypoint(50.0, -160.0, speed=0.0), waypoint(50.0, -145.0, speed=1.2)],
            }
        ],
        "npc_statics": [
            {
                "id": "static_0",
                "model": "vehicle.audi.tt",
                "rolename": "npc",
                "category": "obstacle",
                "location": waypoint(20.0, -157.0, yaw=0.0, speed=0.0),
            }
        ],
        "weather": {"pattern": "wet", "precipitation": 30.0, "fog_density": 0.0, "wetness": 40.0},
        "traffic_light": {
            "pattern": "rule",
            "yellow_time": 3.0,
            "red_time": 10.0,
            "green_time": 20.0,
        },
        "map_region": {"town": "tee-town", "region": [10.0, 120.0, -155.0, -150.0]},
    }


@pytest.fixture
def original() -> dict[str, Any]:
    return original_file()


def test_it_runs_unchanged(original: dict[str, Any], networks: NetworkCatalogue) -> None:
    (imported,) = read_scenarios(json.dumps(original), name="file")
    assert imported.name == "tee_1"
    result = validate_document(imported.document, networks, ("idm",))
    scenario = result.scenario
    ego = scenario.ego_vehicles[0]
    assert (ego.id, ego.model, ego.agent.name) == ("ego_0", "vehicle.lincoln.mkz_2017", "idm")
    assert (ego.route[0].x, ego.route[0].y, ego.route[0].speed) == (100.0, 152.1, 8.0)
    assert scenario.npc_vehicles[0].start_time == 2.5
    assert scenario.npc_vehicles[0].behavior is NpcBehavior.REACTIVE
    assert [place.speed for place in scenario.npc_walkers[0].route] == [None, 1.2]
    assert scenario.npc_obstacles[0].model == "vehicle.audi.tt"
    assert scenario.weather.wetness == 40.0
    assert scenario.traffic_lights.times.green == 20.0
    assert scenario.extensions == {"original_tool:id": "tee #1"}


def test_what_is_dropped_is_noted(original: dict[str, Any]) -> None:
    notes = "\n".join(import_original(original).notes)
    for key in (
        "entry_point",
        "config_path",
        "route_esitmated_length",
        "route_func_coverage",
        "road_option",
        "ignore_traffic_lights",
        "lane_id",
    ):
        assert f"'{key}'" in notes
    assert "has no model" in notes
    assert "pattern 'rule'" in notes
    assert "'pitch'" not in notes


def test_the_region_is_grown_to_hold_every_position(original: dict[str, Any]) -> None:
    imported = import_original(original)
    segment = imported.document.map_region.region_segment
    assert segment is not None
    assert (segment.min_x, segment.max_x, segment.min_y, segment.max_y) == (10, 120, -160, -145)
    assert any("region was grown" in note for note in imported.notes)
    original["map_region"]["region"] = [0.0, 200.0, -200.0, -100.0]
    assert not any("region was grown" in note for note in import_original(original).notes)


def test_problems_point_into_the_original_file(original: dict[str, Any]) -> None:
    original["npc_statics"][0]["location"]["x"] = "20"
    original["npc_walkers"][0]["trigger_time"] = -1
    original["traffic_light"]["green_time"] = 0
    with pytest.raises(InvalidDocument) as caught:
        import_original(original)
    assert {problem.pointer for problem in caught.value.problems} == {
        "/npc_walkers/0/trigger_time",
        "/npc_statics/0/location/x",
        "/traffic_light/green_time",
    }


@pytest.mark.parametrize("region", [[1, 2, 3], "all", [1, 2, 3, None]])
def test_a_broken_region_is_a_problem(original: dict[str, Any], region: Any) -> None:
    original["map_region"]["region"] = region
    with pytest.raises(InvalidDocument) as caught:
        import_original(original)
    assert [problem.pointer for problem in caught.value.problems] == ["/map_region/region"]


@pytest.mark.parametrize("key", ["ego_vehicles", "npc_vehicles", "weather", "map_region"])
@pytest.mark.parametrize("junk", [3, "text", [1], {"a": 1}, [{"route": 3}]])
def test_junk_is_refused(original: dict[str, Any], key: str, junk: Any) -> None:
    original[key] = junk
    if key == "weather" and isinstance(junk, dict):
        assert "'a' of weather" in " ".join(import_original(original).notes)
        return
    with pytest.raises(InvalidDocument):
        import_original(original)


def test_formats_are_told_apart(original: dict[str, Any], good: dict[str, Any]) -> None:
    assert detect_format(json.dumps(original)) is FileFormat.ORIGINAL_TOOL
    assert detect_format(json.dumps(good)) is FileFormat.JSON
    assert detect_format("map_region:\n  town: x\n") is FileFormat.YAML
    assert detect_format(b"<?xml version='1.0'?><routes/>") is FileFormat.LEADERBOARD
    with pytest.raises(InvalidDocument):
        detect_format("{")


def test_documents_are_read_too(good: dict[str, Any], repository: Path) -> None:
    (read,) = read_scenarios(json.dumps(good), name="my file.v2")
    assert read.name == "my_file_v2"
    assert read.document.map_region.town == "tee-town"
    assert read.notes == ()
