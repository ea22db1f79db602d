"""What every network in ``sumo_nets/`` promises."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra
from shapely import LineString, STRtree

from drivora_service.networks.network_loading import load_network
from drivora_service.networks.provenance import read_provenance
from drivora_service.networks.road_network import RoadNetwork

ROOT = Path(__file__).resolve().parents[2]
NETWORKS = sorted(path.name for path in (ROOT / "sumo_nets").iterdir() if path.is_dir())


@pytest.fixture(scope="module", params=NETWORKS)
def network(request: pytest.FixtureRequest) -> RoadNetwork:
    name: str = request.param
    return load_network(ROOT / "sumo_nets" / name / f"{name}.net.xml", name)


def lane_graph(network: RoadNetwork) -> tuple[csr_array, NDArray[np.int64]]:
    """Ways between drivable lanes, lane changes included, weighted by length; and the lanes."""
    rows, columns, weights = [], [], []
    for lane in network.lanes:
        if not lane.drivable:
            continue
        for connection in lane.connections:
            rows.append(lane.index)
            columns.append(connection.to_lane)
            weights.append(lane.length)
        if not lane.is_internal:
            for neighbour in (lane.left, lane.right):
                if neighbour >= 0:
                    rows.append(lane.index)
                    columns.append(neighbour)
                    weights.append(1.0)
    size = len(network.lanes)
    graph = csr_array((weights, (rows, columns)), shape=(size, size))
    return graph, np.array([lane.index for lane in network.lanes if lane.drivable])


def test_every_drivable_lane_can_be_reached_from_every_other(network: RoadNetwork) -> None:
    graph, drivable = lane_graph(network)
    _, labels = connected_components(graph, directed=True, connection="strong")
    counts = np.bincount(labels[drivable])
    largest = int(np.argmax(counts))
    outside = [network.lanes[i].id for i in drivable if labels[i] != largest]
    assert outside == []


def test_routes_of_a_kilometre_exist(network: RoadNetwork) -> None:
    graph, drivable = lane_graph(network)
    distances = dijkstra(graph, indices=drivable[::10])
    assert np.nanmax(np.where(np.isfinite(distances), distances, np.nan)) >= 1000.0


def test_no_road_crosses_another_outside_junctions(network: RoadNetwork) -> None:
    lanes = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    lines = np.array([LineString(lane.shape) for lane in lanes])
    first, second = STRtree(lines).query(lines, predicate="crosses")
    assert [(lanes[i].id, lanes[j].id) for i, j in zip(first, second, strict=True)] == []


def test_lanes_bear_their_speed_limit(network: RoadNetwork) -> None:
    """Sideways acceleration at the limit stays within what tyres hold on a wet road."""
    for lane in network.lanes:
        if not lane.drivable or lane.is_internal or len(lane.shape) < 3:
            continue
        steps = np.diff(lane.shape, axis=0)
        heading = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
        middle = 0.5 * (lane.arc[1:] + lane.arc[:-1])
        places = np.arange(middle[0], middle[-1] - 8.0, 2.0)
        bend = np.abs(np.interp(places + 8.0, middle, heading) - np.interp(places, middle, heading))
        assert (lane.speed_limit**2 * bend / 8.0).max(initial=0.0) < 4.5, lane.id


def test_lights_never_give_two_conflicting_movements_full_right_of_way(
    network: RoadNetwork,
) -> None:
    root = ElementTree.parse(network.path).getroot()
    foes = {
        junction.attrib["id"]: [
            request.attrib["foes"][::-1] for request in junction.iter("request")
        ]
        for junction in root.iter("junction")
    }
    for light, program in network.programs.items():
        for phase in program.phases:
            green = [i for i, signal in enumerate(phase.state) if signal == "G"]
            clashes = [(i, j) for i in green for j in green if foes[light][i][j] == "1"]
            assert clashes == [], (light, phase.state)


def test_lights_show_yellow_before_red_and_green_to_everyone(network: RoadNetwork) -> None:
    crossings = {
        (connection.traffic_light, connection.link_index)
        for lane in network.lanes
        for connection in lane.connections
        if not network.lanes[connection.to_lane].drivable
    }
    for light, program in network.programs.items():
        states = [phase.state for phase in program.phases]
        for link, signals in enumerate(zip(*states, strict=True)):
            assert set(signals) & {"G", "g"}, (light, link)
            if (light, link) in crossings:
                continue
            following = signals[1:] + signals[:1]
            for now, then in zip(signals, following, strict=True):
                assert not (now in "Gg" and then == "r"), (light, link)


def test_the_files_are_small_and_speak_of_no_machine(network: RoadNetwork) -> None:
    data = network.path.read_bytes()
    assert len(data) < 400_000
    assert b"generated on" not in data
    assert b"configuration" not in data


def test_provenance(network: RoadNetwork) -> None:
    provenance = read_provenance(network.path.parent)
    assert provenance.licence == "Apache-2.0"
    assert provenance.source == "made for Drivora"
    assert provenance.title
    assert provenance.description.endswith(".")


def test_the_table_of_networks_is_complete() -> None:
    table = (ROOT / "sumo_nets" / "README.md").read_text(encoding="utf-8")
    assert [name for name in NETWORKS if f"| `{name}` |" not in table] == []


def test_the_grid_has_sidewalks_and_signalised_crossings() -> None:
    name = "signal-grid"
    grid = load_network(ROOT / "sumo_nets" / name / f"{name}.net.xml", name)
    assert sum(lane.walkable and not lane.is_internal for lane in grid.lanes) > 50
    assert any(
        connection.traffic_light
        for lane in grid.lanes
        if lane.walkable
        for connection in lane.connections
    )
