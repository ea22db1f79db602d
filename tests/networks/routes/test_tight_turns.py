"""Turns that no car can drive, on a network with dead ends as converters write them."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.errors import NoRoute
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.importing.netconvert import convert
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.networks.routes.tight_turns import tight_turns, uses_tight_turn
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.search.space.lane_walks import walks_from
from drivora_service.simulation.traffic.background import Wanderers
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup

NODES = """<nodes>
  <node id="middle" x="0" y="0"/> <node id="east" x="140" y="0"/>
  <node id="west" x="-140" y="0"/>
  <node id="north" x="0" y="140"/> <node id="south" x="0" y="-140"/>
</nodes>"""
PAIRS = (("middle", "east"), ("middle", "west"), ("middle", "north"), ("middle", "south"))


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory: pytest.TempPathFactory) -> NetworkCatalogue:
    """A crossing whose arms end, each with the turnaround that netconvert adds."""
    folder = tmp_path_factory.mktemp("networks")
    edges = [
        f'<edge id="{a}_{b}" from="{a}" to="{b}" numLanes="1" speed="13.9"/>'
        for pair in PAIRS
        for a, b in (pair, pair[::-1])
    ]
    (folder / "nodes.xml").write_text(NODES, encoding="utf-8")
    (folder / "edges.xml").write_text(f"<edges>{''.join(edges)}</edges>", encoding="utf-8")
    network = convert(
        ["-n", str(folder / "nodes.xml"), "-e", str(folder / "edges.xml"), "--tls.guess", "false"]
    )
    (folder / "arms.net.xml").write_bytes(network)
    return NetworkCatalogue(folder)


@pytest.fixture(scope="module")
def arms(catalogue: NetworkCatalogue) -> RoadNetwork:
    return catalogue.get("arms")


def on(network: RoadNetwork, edge: str, s: float) -> RoutePoint:
    x, y, yaw = network.lane(f"{edge}_0").position_at(s)
    return RoutePoint(x=x, y=y, yaw=yaw)


def test_turnarounds_are_tight_and_turns_are_not(arms: RoadNetwork) -> None:
    directions = {
        (lane.index, link.to_lane): link.direction
        for lane in arms.lanes
        if lane.drivable and not lane.is_internal
        for link in lane.connections
    }
    around = {turn for turn, direction in directions.items() if direction == "t"}
    assert len(around) >= 3
    assert tight_turns(arms) == around


def test_shipped_networks_have_no_tight_turn(shipped_network: RoadNetwork) -> None:
    assert tight_turns(shipped_network) == frozenset()


def test_towns_have_no_tight_turn(town: RoadNetwork) -> None:
    assert tight_turns(town) == frozenset()


def test_a_destination_is_not_reached_by_turning_round(arms: RoadNetwork) -> None:
    with pytest.raises(NoRoute, match="tighter than a car can drive"):
        plan_route(arms, [on(arms, "middle_north", 80.0), on(arms, "middle_east", 80.0)])


def test_waypoints_before_and_behind_a_turn_ask_for_it(arms: RoadNetwork) -> None:
    points = [
        on(arms, "middle_north", 80.0),
        on(arms, "middle_north", 110.0),
        on(arms, "north_middle", 30.0),
        on(arms, "middle_east", 80.0),
    ]
    route = plan_route(arms, points)
    assert uses_tight_turn(arms, route)
    assert route.edges == ("middle_north", "north_middle", "middle_east")


def test_ways_of_a_search_end_where_the_road_ends(arms: RoadNetwork) -> None:
    lanes = [lane for lane in arms.lanes if lane.drivable and not lane.is_internal]
    walks = [walk for lane in lanes for walk in walks_from(arms, lane.index, 5.0, 400.0)]
    steps = {step for walk in walks for step in zip(walk.lanes, walk.lanes[1:], strict=False)}
    assert len(walks) > 10
    assert not steps & tight_turns(arms)


def test_background_traffic_leaves_where_the_road_ends(arms: RoadNetwork) -> None:
    wanderers = Wanderers(arms, None, np.random.default_rng(1))
    assert wanderers.draw_route("middle_north") == ["middle_north"]
    for _ in range(20):
        route = wanderers.draw_route("west_middle")
        assert route[-1] in ("middle_north", "middle_south", "middle_east")


def test_seeds_do_not_turn_round_and_idm_stays_on_the_road(catalogue: NetworkCatalogue) -> None:
    arms = catalogue.get("arms")
    documents = list(
        generate_seeds(arms, count=6, min_length=120.0, max_length=260.0, seed=3, agent="idm")
    )
    setup = WorkerSetup(shipped_networks=arms.path.parent)
    for number, document in enumerate(documents):
        valid = validate_document(document, catalogue, ("idm",))
        ends = valid.scenario.ego_vehicles[0].route
        points = [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in ends]
        assert not uses_tight_turn(arms, plan_route(arms, points))
        report = perform(
            RunSpec(run_id=f"seed-{number}", document=canonical_json(valid.scenario)), setup
        )
        assert report.status is RunStatus.FINISHED
        broken = {v.oracle for v in report.verdicts if v.outcome is Outcome.VIOLATED}
        assert not broken & {"off_road", "lane_keeping", "wrong_way", "destination"}
