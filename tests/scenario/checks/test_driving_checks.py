"""What an NPC vehicle is told about its driving: bounds, meaning, and the identity of scenarios."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from drivora_service.errors import Problem
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import RouteEnd
from drivora_service.scenario.validation import scenario_problems
from tests.scenario.places import on_lane


@pytest.fixture(scope="module")
def network(networks: NetworkCatalogue) -> RoadNetwork:
    return networks.get("tee-town")


def places_of(problems: Sequence[Problem]) -> list[tuple[str, str]]:
    return [(problem.pointer, problem.code) for problem in problems]


def vehicle(network: RoadNetwork, *waits: float | None, **more: Any) -> dict[str, Any]:
    """A vehicle with a waypoint every 40 m."""
    route = []
    for number, wait in enumerate(waits):
        route.append(on_lane(network, "market_1_0", 10 + 40 * number))
        if wait is not None:
            route[-1]["wait"] = wait
    return {"id": "npc", "model": "vehicle.audi.tt", "route": route, **more}


def test_it_is_read_and_written_back(
    valid: Any, good: dict[str, Any], network: RoadNetwork, networks: Any
) -> None:
    told = {"at_end": "stay", "deceleration": 7.5, "lateral_acceleration": 4.0}
    good["npc_vehicles"] = [vehicle(network, None, 3.0, **told)]
    scenario = valid(good).scenario
    (npc,) = scenario.npc_vehicles
    assert (npc.at_end, npc.deceleration, npc.lateral_acceleration) == (RouteEnd.STAY, 7.5, 4.0)
    assert [place.wait for place in npc.route] == [None, 3.0]
    assert from_canonical(canonical_json(scenario)) == scenario
    assert valid(to_document(scenario).model_dump(mode="json")).scenario == scenario
    assert not scenario_problems(scenario, networks, ["idm"])


def test_what_is_not_told_leaves_the_identity_as_it_was(
    valid: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    good["npc_vehicles"] = [vehicle(network, None, None, at_end="leave", deceleration=None)]
    text = canonical_json(valid(good).scenario)
    for name in ("wait", "at_end", "deceleration", "lateral_acceleration"):
        assert f'"{name}"' not in text


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("deceleration", 0.4),
        ("deceleration", 12.1),
        ("lateral_acceleration", 0.0),
        ("lateral_acceleration", "4"),
        ("at_end", "vanish"),
    ],
)
def test_bounds(
    refused: Any, good: dict[str, Any], network: RoadNetwork, name: str, value: object
) -> None:
    good["npc_vehicles"] = [vehicle(network, None, None, **{name: value})]
    (problem,) = refused(good)
    assert problem.pointer == f"/npc_vehicles/0/{name}"


@pytest.mark.parametrize("wait", [-0.1, 7200.5, True])
def test_bounds_of_waits(
    refused: Any, good: dict[str, Any], network: RoadNetwork, wait: object
) -> None:
    good["npc_vehicles"] = [vehicle(network, None, wait)]  # type: ignore[arg-type]  # to be refused
    (problem,) = refused(good)
    assert problem.pointer == "/npc_vehicles/0/route/1/wait"


def test_egos_do_not_wait(refused: Any, good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["route"][1]["wait"] = 2.0
    assert places_of(refused(good)) == [("/ego_vehicles/0/route/1/wait", "extra_forbidden")]


def test_sumo_cannot_be_told(refused: Any, good: dict[str, Any], network: RoadNetwork) -> None:
    told = {"at_end": "stay", "deceleration": 7.5, "lateral_acceleration": 4.0}
    good["npc_vehicles"] = [vehicle(network, None, 3.0, behavior="sumo", **told)]
    problems = refused(good)
    assert set(places_of(problems)) == {
        ("/npc_vehicles/0/at_end", "not_for_sumo"),
        ("/npc_vehicles/0/deceleration", "not_for_sumo"),
        ("/npc_vehicles/0/lateral_acceleration", "not_for_sumo"),
        ("/npc_vehicles/0/route/1/wait", "not_for_sumo"),
    }
    assert "use behavior reactive or replay" in problems[0].message


def test_a_parked_vehicle_does_not_wait(
    refused: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    good["npc_vehicles"] = [vehicle(network, 3.0, at_end="stay")]
    (problem,) = refused(good)
    assert (problem.pointer, problem.code) == ("/npc_vehicles/0/route/0/wait", "parked_waits")


def test_a_vehicle_that_waits_at_its_start_is_in_the_way_until_then(
    valid: Any, refused: Any, good: dict[str, Any], network: RoadNetwork
) -> None:
    later = {**vehicle(network, None, None), "id": "later", "start_time": 5.0}
    good["npc_vehicles"] = [vehicle(network, None, None), later]
    assert valid(good)
    good["npc_vehicles"][0] = vehicle(network, 6.0, None)
    assert places_of(refused(good)) == [("/npc_vehicles/1/route/0", "overlapping_start")]
