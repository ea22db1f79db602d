"""Validation against a road network: every reason to refuse, and what is let through."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.validation import validate_document
from tests.scenario.places import beside_lane, on_lane

AGENTS = ("idm", "sumo-krauss")
LANE = "high_1_0"


@pytest.fixture
def network(networks: NetworkCatalogue) -> RoadNetwork:
    return networks.get("tee-town")


def places_of(problems: tuple[Problem, ...]) -> list[tuple[str, str]]:
    return [(problem.pointer, problem.code) for problem in problems]


def test_a_good_document_passes(valid: Any, good: dict[str, Any], network: RoadNetwork) -> None:
    result = valid(good)
    assert result.network is network
    assert result.notes == ()
    assert [(w.x, w.y) for w in result.scenario.ego_vehicles[0].route] == [
        (100.0, 152.1),
        (30.0, 153.2),
    ]


def test_changes_of_the_weather_come_in_the_order_of_their_times(
    valid: Any, refused: Any, good: dict[str, Any]
) -> None:
    rain: dict[str, Any] = {"weather": {"precipitation": 50.0}}
    good["weather_changes"] = [{"time": 1.0, **rain}, {"time": 2.5, **rain}]
    first, last = valid(good).scenario.weather_changes
    assert (first.time, last.time, last.weather.precipitation) == (1.0, 2.5, 50.0)
    good["weather_changes"] += [{"time": 2.5, **rain}, {"time": 0.0, **rain}]
    problems = refused(good)
    assert places_of(problems) == [
        ("/weather_changes/2/time", "wrong_order"),
        ("/weather_changes/3/time", "wrong_order"),
    ]
    good["weather_changes"] = [{"time": -1.0, **rain}, {"time": 1.0}]
    assert [problem.pointer for problem in refused(good)] == [
        "/weather_changes/0/time", "/weather_changes/1/weather",
    ]  # fmt: skip


def test_unknown_town_says_how_to_import_it(refused: Any, good: dict[str, Any]) -> None:
    good["map_region"]["town"] = "Town12"
    good["ego_vehicles"][0]["model"] = "vehicle.none"
    good["ego_vehicles"][0]["route"][0]["x"] = 5e5
    problems = refused(good)
    assert places_of(problems) == [
        ("/ego_vehicles/0/model", "unknown_model"),
        ("/map_region/town", "unknown_town"),
    ]
    assert "`drivora networks import FILE --name Town12`" in problems[1].message
    assert "tee-town" in problems[1].message


def test_unknown_and_wrong_models(refused: Any, good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["model"] = "walker.pedestrian.0001"
    good["npc_walkers"] = [
        {"id": "w", "model": "walker.pedestrian.9999", "route": [{"x": 100, "y": 170}]}
    ]
    good["npc_obstacles"] = [
        {"id": "o", "model": "walker.pedestrian.0001", "location": {"x": 100, "y": 175}}
    ]
    assert places_of(refused(good)) == [
        ("/ego_vehicles/0/model", "wrong_kind"),
        ("/npc_walkers/0/model", "unknown_model"),
        ("/npc_obstacles/0/model", "wrong_kind"),
    ]


def test_points_off_the_network(refused: Any, good: dict[str, Any], network: RoadNetwork) -> None:
    good["ego_vehicles"][0]["route"][1] = {"x": 5000.0, "y": 0.0}
    good["npc_vehicles"] = [
        {
            "id": "far",
            "model": "audi.tt",
            "route": [on_lane(network, "market_1_0", 10), {"x": 60.0, "y": 220.0}],
        }
    ]
    good["npc_walkers"] = [
        {"id": "walker", "model": "0001", "route": [{"x": 0, "y": 0}, {"x": -500, "y": 0}]}
    ]
    good["npc_obstacles"] = [
        {"id": "cone", "model": "trafficcone01", "location": {"x": 0, "y": 5e4}}
    ]
    problems = refused(good)
    assert places_of(problems) == [
        ("/ego_vehicles/0/route/1", "off_network"),
        ("/npc_vehicles/0/route/1", "off_network"),
        ("/npc_walkers/0/route/1", "off_network"),
        ("/npc_obstacles/0/location", "off_network"),
    ]
    assert "`frame: carla`" in problems[0].message
    assert "m from the nearest drivable lane" in problems[1].message


def test_a_place_within_tolerance_is_snapped(
    valid: Any, refused: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    route = good["ego_vehicles"][0]["route"]
    route[0] = beside_lane(network, LANE, 20.0, right=9.0)
    result = valid(good)
    start = result.scenario.ego_vehicles[0].route[0]
    x, y, _ = network.lane(LANE).position_at(20.0)
    assert (start.x, start.y) == pytest.approx((x, y), abs=0.3)
    (note,) = result.notes
    assert "waypoint 0" in note
    assert "9.0 m" in note
    route[0] = beside_lane(network, LANE, 20.0, right=13.0)
    assert places_of(refused(good)) == [("/ego_vehicles/0/route/0", "off_network")]


def test_points_outside_the_region(
    valid: Any, refused: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    good["npc_walkers"] = [
        {"id": "walker", "model": "0001", "route": [{"x": 50, "y": 160}, {"x": 50, "y": 145}]}
    ]
    region = {"min_x": 20, "max_x": 120, "min_y": 150, "max_y": 170}
    good["map_region"]["region_segment"] = region
    assert places_of(refused(good)) == [("/npc_walkers/0/route/1", "outside_region")]
    region["min_y"] = 140
    assert valid(good).scenario.map_region.region_segment.min_y == 140


def test_routes_that_cannot_be_driven(good: dict[str, Any], network: RoadNetwork) -> None:
    # In the shipped networks every lane can be reached; so one road loses its ends.
    lanes = list(network.lanes)
    for lane in network.lanes:
        if "market_2" in lane.edge_id:
            lanes[lane.index] = replace(lane, connections=())
    cut = replace(network, lanes=tuple(lanes))
    catalogue = OneNetwork(cut)
    start, beyond = on_lane(cut, "market_2_0", 20.0), on_lane(cut, "market_4_0", 20.0)
    ahead = on_lane(cut, "market_2_0", 60.0)
    good["ego_vehicles"][0]["route"] = [start, ahead, beyond, beyond]
    good["npc_vehicles"] = [
        {"id": "a", "model": "audi.tt", "route": [ahead, beyond], "start_time": 5},
        {
            "id": "b",
            "model": "audi.tt",
            "route": [start, beyond],
            "start_time": 6,
            "behavior": "sumo",
        },
        {
            "id": "c",
            "model": "audi.tt",
            "route": [start, beyond],
            "start_time": 7,
            "behavior": "replay",
        },
    ]
    with pytest.raises(InvalidDocument) as caught:
        validate_document(parse_document(good), catalogue, AGENTS)
    assert places_of(caught.value.problems) == [
        ("/ego_vehicles/0/route/2", "no_route"),
        ("/npc_vehicles/0/route/1", "no_route"),
        ("/npc_vehicles/1/route/1", "no_route"),
    ]


class OneNetwork:
    """A catalogue of one network."""

    def __init__(self, network: RoadNetwork) -> None:
        self._network = network

    def get(self, name: str) -> RoadNetwork:
        return self._network


def test_start_is_destination(refused: Any, good: dict[str, Any]) -> None:
    route = good["ego_vehicles"][0]["route"]
    route[1] = {"x": route[0]["x"] - 0.5, "y": route[0]["y"]}
    assert places_of(refused(good)) == [("/ego_vehicles/0/route/1", "no_way_to_go")]


def test_sumo_needs_a_way(refused: Any, good: dict[str, Any], network: RoadNetwork) -> None:
    good["npc_vehicles"] = [
        {
            "id": "npc",
            "model": "audi.tt",
            "behavior": "sumo",
            "route": [on_lane(network, "market_1_0", 10)],
        }
    ]
    assert places_of(refused(good)) == [("/npc_vehicles/0/route", "too_short")]


def test_overlapping_starts(refused: Any, good: dict[str, Any], network: RoadNetwork) -> None:
    ego = good["ego_vehicles"][0]["route"][0]
    good["npc_vehicles"] = [
        {
            "id": "npc",
            "model": "audi.tt",
            "route": [{"x": ego["x"] - 3, "y": ego["y"]}, on_lane(network, LANE, 90)],
        }
    ]
    good["npc_walkers"] = [{"id": "walker", "model": "0001", "route": [{"x": 300, "y": 300}]}]
    good["npc_obstacles"] = [
        {"id": "cone", "model": "trafficcone01", "location": {"x": 300.2, "y": 300}}
    ]
    problems = refused(good)
    assert places_of(problems) == [
        ("/npc_vehicles/0/route/0", "overlapping_start"),
        ("/npc_obstacles/0/location", "overlapping_start"),
    ]
    assert "'npc'" in problems[0].message
    assert "/ego_vehicles/0" in problems[0].message


def test_who_has_left_is_not_in_the_way(
    valid: Any, refused: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    here, there = on_lane(network, "market_2_0", 20), on_lane(network, "market_2_0", 80)
    first = {"id": "first", "model": "audi.tt", "route": [here, there]}
    second = {"id": "second", "model": "audi.tt", "route": [here, there], "start_time": 10.0}
    good["npc_vehicles"] = [first, second]
    valid(good)
    second["start_time"] = 0.0
    assert places_of(refused(good)) == [("/npc_vehicles/1/route/0", "overlapping_start")]
    # A parked vehicle never leaves, and an ego stands at its start until its start time.
    second["start_time"] = 10.0
    first["route"] = [here]
    assert places_of(refused(good)) == [("/npc_vehicles/1/route/0", "overlapping_start")]
    good["npc_vehicles"] = [second]
    good["ego_vehicles"][0]["route"] = [here, there]
    valid(good)
    good["ego_vehicles"][0]["start_time"] = 20.0
    assert places_of(refused(good)) == [("/npc_vehicles/0/route/0", "overlapping_start")]


def test_vehicles_in_neighbouring_lanes_do_not_overlap(
    valid: Any, good: dict[str, Any], networks: NetworkCatalogue
) -> None:
    highway = networks.get("highway")
    wide = next(lane for lane in highway.lanes if lane.left >= 0 and lane.length > 100)
    left = highway.lanes[wide.left]
    good["map_region"]["town"] = "highway"
    good["ego_vehicles"][0]["route"] = [
        on_lane(highway, wide.id, 20.0),
        on_lane(highway, wide.id, 90.0),
    ]
    good["npc_vehicles"] = [
        {
            "id": "npc",
            "model": "audi.tt",
            "route": [on_lane(highway, left.id, 20.0), on_lane(highway, left.id, 90.0)],
        }
    ]
    valid(good)


def test_unknown_traffic_lights(
    valid: Any, refused: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    known = next(iter(network.programs))
    good["traffic_lights"] = {"junctions": {known: {"green_time": 20}, "none/such": {}}}
    (problem,) = refused(good)
    assert problem.pointer == "/traffic_lights/junctions/none~1such"
    assert known in problem.message
    del good["traffic_lights"]["junctions"]["none/such"]
    assert valid(good).scenario.traffic_lights.junctions[known].green == 20.0


def test_density_that_is_too_high(
    valid: Any, refused: Any, good: dict[str, Any], networks: NetworkCatalogue
) -> None:
    highway = networks.get("highway")
    lane = next(lane for lane in highway.lanes if lane.drivable and lane.length > 500)
    good["map_region"]["town"] = "highway"
    good["ego_vehicles"][0]["route"] = [
        on_lane(highway, lane.id, 10),
        on_lane(highway, lane.id, 400),
    ]
    good["background_traffic"] = {"density": 200.0}
    assert places_of(refused(good)) == [("/background_traffic/density", "too_many")]
    good["background_traffic"] = {"density": 1.0}
    assert valid(good).scenario.background_traffic.count > 1


def test_speed_beyond_the_model(refused: Any, good: dict[str, Any]) -> None:
    good["ego_vehicles"][0].update(model="bh.crossbike", initial_speed=30.0)
    assert places_of(refused(good)) == [("/ego_vehicles/0/initial_speed", "too_fast")]


def test_a_loop_back_to_the_start_is_a_route(
    valid: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    here = on_lane(network, "market_2_0", 40)
    away = on_lane(network, "north_2_0", 40)
    good["ego_vehicles"][0]["route"] = [here, away, here]
    valid(good)


def test_as_many_npcs_as_are_allowed(
    valid: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    lanes = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    npcs = []
    for index in range(500):
        start, end = lanes[index % len(lanes)], lanes[(7 * index + 3) % len(lanes)]
        npcs.append(
            {
                "id": f"npc_{index}",
                "model": "audi.tt",
                "start_time": float(index),
                "route": [
                    on_lane(network, start.id, 0.3 * start.length),
                    on_lane(network, end.id, 0.7 * end.length),
                ],
            }
        )
    good["npc_vehicles"] = npcs
    assert len(valid(good).scenario.npc_vehicles) == 500


def test_levels_of_a_bridge_do_not_meet(good: dict[str, Any], network: RoadNetwork) -> None:
    raised = replace(
        network,
        lanes=tuple(replace(lane, heights=np.full(len(lane.arc), 6.0)) for lane in network.lanes),
    )
    here = on_lane(raised, "market_2_0", 40)
    good["ego_vehicles"][0]["route"] = [here, on_lane(raised, "market_2_0", 80)]
    cone: dict[str, Any] = {"id": "cone", "model": "trafficcone01", "location": {**here, "z": 0.0}}
    good["npc_obstacles"] = [cone]
    validate_document(parse_document(good), OneNetwork(raised), AGENTS)
    cone["location"]["z"] = 5.0
    with pytest.raises(InvalidDocument) as caught:
        validate_document(parse_document(good), OneNetwork(raised), AGENTS)
    assert places_of(caught.value.problems) == [("/npc_obstacles/0/location", "overlapping_start")]
