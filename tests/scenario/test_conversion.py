"""From documents to scenarios: frames, units, names, defaults."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario import model
from drivora_service.scenario.conversion import drivable_kilometres, to_scenario
from drivora_service.scenario.documents import parse_document


def convert(
    networks: NetworkCatalogue,
    content: dict[str, Any],
    offset: tuple[float, float] = (0.0, 0.0),
) -> model.Scenario:
    network = replace(networks.get("tee-town"), net_offset=offset)
    return to_scenario(parse_document(content), network)


def test_degrees_become_radians(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["route"][0].update(yaw=450.0, z=1.5, speed=3)
    place = convert(networks, good).ego_vehicles[0].route[0]
    assert place.yaw == pytest.approx(math.pi / 2)
    assert place == model.Waypoint(x=100.0, y=152.1, z=1.5, yaw=place.yaw, speed=3)


def test_carla_is_mirrored_and_moved(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["frame"] = "carla"
    good["ego_vehicles"][0]["route"][0].update(x=10.0, y=20.0, yaw=90.0)
    good["map_region"]["region_segment"] = {"min_x": 0, "max_x": 50, "min_y": -10, "max_y": 30}
    scenario = convert(networks, good, (100.0, 200.0))
    place = scenario.ego_vehicles[0].route[0]
    assert (place.x, place.y, place.yaw) == pytest.approx((110.0, 180.0, -math.pi / 2))
    assert scenario.map_region.region_segment == model.Region(
        min_x=100.0, max_x=150.0, min_y=170.0, max_y=210.0
    )


def test_patches_are_mirrored_and_moved(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["frame"] = "carla"
    good["friction_patches"] = [
        {"id": "ice", "location": {"x": 10.0, "y": 20.0, "yaw": 30.0, "z": 4.0},
         "length": 12, "width": 3, "friction": 0.2}
    ]  # fmt: skip
    (patch,) = convert(networks, good, (100.0, 200.0)).friction_patches
    place = patch.location
    assert (place.x, place.y, place.yaw) == pytest.approx((110.0, 180.0, -math.pi / 6))
    assert (patch.length, patch.width, patch.friction, place.z) == (12.0, 3.0, 0.2, 4.0)


def test_full_model_names(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["model"] = "lincoln.mkz2017"
    good["npc_obstacles"] = [{"id": "cone", "model": "trafficcone01", "location": {"x": 1, "y": 2}}]
    scenario = convert(networks, good)
    assert scenario.ego_vehicles[0].model == "vehicle.lincoln.mkz_2017"
    assert scenario.npc_obstacles[0].model == "static.prop.trafficcone01"


def test_junctions_inherit_light_times(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["traffic_lights"] = {"green_time": 20, "junctions": {"a": {"yellow_time": 4}}}
    lights = convert(networks, good).traffic_lights
    assert lights.times == model.LightTimes(green=20.0)
    assert lights.junctions["a"] == model.LightTimes(green=20.0, yellow=4.0)


def test_density_becomes_a_count(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["background_traffic"] = {"density": 10.0, "start_time": 5.0}
    background = convert(networks, good).background_traffic
    kilometres = drivable_kilometres(networks.get("tee-town"))
    assert 1.0 < kilometres < 50.0
    assert background == model.BackgroundTraffic(count=round(10 * kilometres), start_time=5.0)


def test_egos_without_an_agent_get_the_default(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    del good["ego_vehicles"][0]["agent"]
    assert convert(networks, good).ego_vehicles[0].agent == model.AgentChoice(name="idm")


def test_agent_parameters_are_carried(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["agent"]["parameters"] = {"headway": 1.5}
    assert convert(networks, good).ego_vehicles[0].agent.parameters == {"headway": 1.5}
