"""The share of the road network that scenarios use."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.scenario.model import (
    EgoVehicle,
    MapRegion,
    NpcBehavior,
    NpcObstacle,
    NpcVehicle,
    NpcWalker,
    Scenario,
    Waypoint,
)
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_data, validate_document
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.simulation.plans.planning_npcs import plan_npc
from drivora_service.studies.coverage.road_coverage import CELL, RoadCoverage


@pytest.fixture(scope="module")
def network(catalogues: Catalogues) -> RoadNetwork:
    return catalogues.networks.get("tee-town")


@pytest.fixture(scope="module")
def lane(network: RoadNetwork) -> Lane:
    """A long lane outside junctions."""
    return max(
        (lane for lane in network.lanes if lane.drivable and not lane.is_internal),
        key=lambda lane: float(lane.arc[-1]),
    )


def scenario(
    *vehicles: NpcVehicle,
    walkers: tuple[NpcWalker, ...] = (),
    obstacles: tuple[NpcObstacle, ...] = (),
    egos: tuple[EgoVehicle, ...] = (),
) -> Scenario:
    return Scenario(
        ego_vehicles=egos,
        map_region=MapRegion(town="tee-town"),
        npc_vehicles=vehicles,
        npc_walkers=walkers,
        npc_obstacles=obstacles,
    )


def at(lane: Lane, s: float) -> Waypoint:
    x, y, yaw = lane.position_at(s)
    return Waypoint(x=x, y=y, yaw=yaw)


def vehicle(*route: Waypoint, behavior: NpcBehavior = NpcBehavior.REACTIVE) -> NpcVehicle:
    return NpcVehicle(id="npc", model="vehicle.nissan.micra", route=route, behavior=behavior)


def metres(network: RoadNetwork, coverage: RoadCoverage) -> float:
    whole = sum(float(lane.arc[-1]) for lane in network.lanes if lane.drivable)
    return coverage.share * whole


def test_nothing_is_covered_at_first(network: RoadNetwork) -> None:
    coverage = RoadCoverage(network)
    coverage.add([])
    assert coverage.share == 0.0


@pytest.mark.parametrize("behavior", [NpcBehavior.REACTIVE, NpcBehavior.REPLAY])
def test_a_way_along_a_lane_covers_its_length_once(
    network: RoadNetwork, lane: Lane, behavior: NpcBehavior
) -> None:
    coverage = RoadCoverage(network)
    way = scenario(vehicle(at(lane, 12.0), at(lane, 42.0), behavior=behavior))
    coverage.add([way])
    covered = metres(network, coverage)
    assert 30.0 <= covered <= 30.0 + 2.0 * CELL
    coverage.add([way, way])
    assert metres(network, coverage) == covered


def test_what_stands_covers_its_place(network: RoadNetwork, lane: Lane) -> None:
    coverage = RoadCoverage(network)
    stone = NpcObstacle(id="stone", model="static.prop.box01", location=at(lane, 30.0))
    coverage.add([scenario(obstacles=(stone,))])
    assert 0.0 < metres(network, coverage) <= CELL


def test_a_walker_covers_the_lanes_that_it_crosses(network: RoadNetwork, lane: Lane) -> None:
    x, y, yaw = lane.position_at(30.0)
    aside = np.array([-np.sin(yaw), np.cos(yaw)]) * 30.0
    route = tuple(Waypoint(x=x + side * aside[0], y=y + side * aside[1]) for side in (-1.0, 1.0))
    coverage = RoadCoverage(network)
    coverage.add([scenario(walkers=(NpcWalker(id="w", model="walker", route=route),))])
    beside = len(network.edge_lanes[lane.edge_id])
    assert metres(network, coverage) >= 0.5 * CELL * beside


def test_places_off_the_road_cover_nothing(network: RoadNetwork) -> None:
    far = (Waypoint(x=-9000.0, y=0.0), Waypoint(x=-9000.0, y=9.0))
    coverage = RoadCoverage(network)
    coverage.add([scenario(vehicle(*far), vehicle(*far, behavior=NpcBehavior.REPLAY))])
    assert coverage.share == 0.0


def test_an_ego_covers_its_route(network: RoadNetwork, catalogues: Catalogues) -> None:
    valid = validate_data(SCENARIO, catalogues.networks, ["idm"]).scenario
    coverage = RoadCoverage(network)
    coverage.add([scenario(egos=valid.ego_vehicles)])
    assert 80.0 < metres(network, coverage) < 120.0


@pytest.mark.parametrize("town", ["tee-town", "signal-grid"])
def test_ways_are_those_that_vehicles_are_driven_along(catalogues: Catalogues, town: str) -> None:
    """Each path is planned lane by lane and must agree with the exact plan."""
    network = catalogues.networks.get(town)
    (document,) = generate_seeds(
        network, count=1, min_length=120, max_length=250, seed=1, agent="idm"
    )
    seed = validate_document(document, catalogues.networks, ["idm"]).scenario
    space = ScenarioSpace(seed, network, SpaceOptions(vehicles=2, walkers=0, weather=False))
    random = np.random.default_rng(5)
    both = only_ours = only_theirs = 0
    for values in space.genes.sample(random, 15):
        for npc in space.scenario(space.repair(values)).npc_vehicles:
            ours = RoadCoverage(network)
            ours.add([scenario(npc)])
            path = plan_npc(npc, network, 1.0).path
            steps = [Waypoint(x=x, y=y) for x, y in path.line]
            theirs = RoadCoverage(network)
            theirs.add([scenario(vehicle(*steps, behavior=NpcBehavior.REPLAY))])
            both += int((ours.covered & theirs.covered).sum())
            only_ours += int((ours.covered & ~theirs.covered).sum())
            only_theirs += int((theirs.covered & ~ours.covered).sum())
    assert both > 500
    assert only_ours < 0.03 * both
    assert only_theirs < 0.03 * both


def test_every_lane_can_be_covered(network: RoadNetwork) -> None:
    coverage = RoadCoverage(network)
    for lane in network.lanes:
        if lane.drivable:
            length = float(lane.arc[-1])
            coverage.add([scenario(vehicle(at(lane, 0.0), at(lane, length)))])
    assert coverage.share > 0.9


def test_a_way_counts_once_wherever_its_waypoints_are(network: RoadNetwork, lane: Lane) -> None:
    """Also with several waypoints in one cell, at both ends and between."""
    coverage = RoadCoverage(network)
    places = (2.0, 2.5, 31.0, 31.5, 32.0, 57.0)
    vehicle = NpcVehicle(
        id="a",
        model="vehicle.audi.tt",
        route=tuple(at(lane, s) for s in places),
        behavior=NpcBehavior.SUMO,
    )
    coverage.add([scenario(vehicle)])
    counts = coverage.counts_by_lane()[lane.index]
    size = float(lane.arc[-1]) / len(counts)
    assert counts[: int(57.0 / size) + 1].tolist() == [1] * (int(57.0 / size) + 1)
    assert counts[int(57.0 / size) + 1 :].tolist() == [0] * (len(counts) - int(57.0 / size) - 1)
