"""What an editor is shown of a document, valid or not."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
import shapely

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.scenario.inspection import InspectedActor, Inspection, inspect_data
from tests.scenario.places import on_lane

AGENTS = ("idm",)
LANE = "high_1_0"


@pytest.fixture
def network(networks: NetworkCatalogue) -> RoadNetwork:
    return networks.get("tee-town")


def inspected(document: Any, networks: NetworkCatalogue) -> Inspection:
    return inspect_data(json.dumps(document), networks, AGENTS)


def actors_of(inspection: Inspection) -> dict[str, InspectedActor]:
    return {actor.id: actor for actor in inspection.actors}


def test_a_valid_document_has_its_actors_and_their_ways(
    good: dict[str, Any], networks: NetworkCatalogue, network: RoadNetwork
) -> None:
    ends = [on_lane(network, LANE, 20.0), on_lane(network, LANE, 50.0)]
    car = {"model": "vehicle.audi.a2", "route": ends, "start_time": 5.0}
    good["npc_vehicles"] = [
        {"id": "lanes", "behavior": "sumo", **car},
        {"id": "joined", "behavior": "reactive", **car, "start_time": 15.0},
        {"id": "straight", "behavior": "replay", **car, "start_time": 25.0},
    ]
    good["npc_walkers"] = [
        {"id": "w", "model": "walker.pedestrian.0001", "route": [{"x": 60, "y": 160}]}
    ]
    found = inspected(good, networks)
    assert (found.problems, found.town) == ((), "tee-town")
    actors = actors_of(found)
    ego = actors[good["ego_vehicles"][0]["id"]]
    assert (ego.pointer, str(ego.kind)) == ("/ego_vehicles/0", "vehicle")
    # It drives from about (100, 152) to (30, 153) along a straight road.
    assert np.hypot(*(ego.path[-1] - (30.0, 153.2))) < 2.0
    assert ego.path_length == pytest.approx(70.0, abs=2.0)
    assert math.cos(ego.yaw) == pytest.approx(-1.0, abs=0.1)
    planned = plan_route(network, [RoutePoint(x=place["x"], y=place["y"]) for place in ends]).line
    shown = shapely.LineString(actors["lanes"].path)
    assert max(shown.distance(shapely.Point(point)) for point in planned) < 0.03
    np.testing.assert_allclose(actors["joined"].path, actors["lanes"].path)
    start, end = ends
    assert actors["straight"].path.tolist() == [
        [start["x"], start["y"]], [end["x"], end["y"]],
    ]  # fmt: skip
    assert actors["straight"].path_length == pytest.approx(30.0, abs=0.1)
    assert (len(actors["w"].path), actors["w"].path_length) == (0, 0.0)
    assert (actors["w"].x, actors["w"].y) == (60.0, 160.0)


def test_actors_without_mistakes_are_shown_beside_others(
    good: dict[str, Any], networks: NetworkCatalogue
) -> None:
    good["npc_vehicles"] = [
        {"id": "lost", "model": "vehicle.audi.a2", "route": [{"x": 5e5, "y": 0}]},
        {"id": "late", "model": "vehicle.audi.a2", "start_time": -1.0, "speed": 3.0, "route": [
            {"x": 60.0, "y": 152.6}]},
        {"id": "nobody", "model": "vehicle.none", "route": [{"x": 60.0, "y": 152.6}]},
        {"id": "shapeless", "model": "vehicle.audi.a2", "route": [{"x": "60", "y": 152.6}]},
    ]  # fmt: skip
    found = inspected(good, networks)
    assert [(problem.pointer, problem.code) for problem in found.problems] == [
        ("/npc_vehicles/0/route/0", "off_network"),
        ("/npc_vehicles/1/start_time", "greater_than_equal"),
        ("/npc_vehicles/1/speed", "extra_forbidden"),
        ("/npc_vehicles/2/model", "unknown_model"),
        ("/npc_vehicles/3/route/0/x", "float_type"),
    ]
    actors = actors_of(found)
    assert set(actors) == {good["ego_vehicles"][0]["id"], "lost", "late"}
    assert len(actors[good["ego_vehicles"][0]["id"]].path) > 0
    assert (actors["lost"].x, len(actors["lost"].path)) == (5e5, 0)
    assert found.notes == ()


def test_the_way_around_is_shown_where_the_destination_lies_behind(
    good: dict[str, Any], networks: NetworkCatalogue
) -> None:
    good["ego_vehicles"][0]["route"].reverse()
    found = inspected(good, networks)
    (ego,) = found.actors
    assert (found.problems, ego.path_length > 200.0) == ((), True)


def test_an_ego_without_a_way_to_go_has_none(
    good: dict[str, Any], networks: NetworkCatalogue
) -> None:
    start = good["ego_vehicles"][0]["route"][0]
    good["ego_vehicles"][0]["route"][1] = {**start, "x": start["x"] - 1.0}
    found = inspected(good, networks)
    assert [problem.code for problem in found.problems] == ["no_way_to_go"]
    assert found.actors[0].path_length < 2.0


def test_where_the_road_network_is_unknown_nothing_is_placed(
    good: dict[str, Any], networks: NetworkCatalogue
) -> None:
    good["map_region"]["town"] = "Town12"
    found = inspected(good, networks)
    assert [problem.code for problem in found.problems] == ["unknown_town"]
    assert (found.town, found.actors) == ("", ())


def test_places_are_in_the_plane_of_the_network(
    good: dict[str, Any], networks: NetworkCatalogue, network: RoadNetwork
) -> None:
    before = inspected(good, networks).actors[0]
    east, north = network.net_offset
    for place in good["ego_vehicles"][0]["route"]:
        place |= {"x": place["x"] - east, "y": north - place["y"]}
    good["frame"] = "carla"
    after = inspected(good, networks).actors[0]
    assert (after.x, after.y, after.yaw) == pytest.approx((before.x, before.y, before.yaw))
    np.testing.assert_allclose(after.path, before.path, atol=1e-6)


def test_what_is_no_document_is_refused(networks: NetworkCatalogue) -> None:
    with pytest.raises(InvalidDocument):
        inspect_data("{", networks, AGENTS)
    found = inspect_data("{}", networks, AGENTS)
    assert [problem.pointer for problem in found.problems] == ["/ego_vehicles", "/map_region"]
    assert found.actors == ()
