"""The geometry of networks, compared with what SUMO's own library reads."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sumolib

from drivora_service.api.answers.geometry_json import geometry_of
from drivora_service.api.schemas.network_geometry import LaneKind, NetworkGeometry
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.line_controls import LineControl
from drivora_service.networks.markings import Marking
from drivora_service.networks.network_loading import load_network
from tests.api.conftest import Offline

NAMES = NetworkCatalogue(shipped_networks()).names()


@pytest.fixture(scope="module", params=NAMES)
def both(request: pytest.FixtureRequest) -> tuple[NetworkGeometry, Any]:
    """A network's geometry, and the network as SUMO's library has it."""
    networks = NetworkCatalogue(shipped_networks())
    path = networks.path(request.param)
    net = sumolib.net.readNet(
        str(path), withInternal=True, withPedestrianConnections=True, withPrograms=True
    )
    return geometry_of(networks.get(request.param)), net


def test_lanes_have_the_edge_number_and_limit_of_sumo(both: tuple[NetworkGeometry, Any]) -> None:
    geometry, net = both
    kinds = {
        "internal": LaneKind.JUNCTION,
        "crossing": LaneKind.CROSSING,
        "walkingarea": LaneKind.WALKING_AREA,
    }
    for lane in geometry.lanes:
        found = net.getLane(lane.id)
        assert (lane.edge, lane.index) == (found.getEdge().getID(), found.getIndex())
        assert lane.speed_limit == found.getSpeed()
        assert lane.street == found.getEdge().getName()
        function = found.getEdge().getFunction()
        assert lane.kind is kinds.get(function, lane.kind)
        if not function:
            sidewalk = not found.allows("passenger") and found.allows("pedestrian")
            assert lane.kind is (LaneKind.SIDEWALK if sidewalk else LaneKind.ROAD)


def test_junctions_and_crossings_are_those_of_sumo(both: tuple[NetworkGeometry, Any]) -> None:
    geometry, net = both
    assert geometry.junction_types == {
        node.getID(): node.getType() for node in net.getNodes() if node.getType() != "internal"
    }
    found = {c.id: c for c in geometry.crossings}
    expected = [e for e in net.getEdges() if e.getFunction() == "crossing"]
    assert set(found) == {f"{edge.getID()}_0" for edge in expected}
    for crossing in geometry.crossings:
        assert crossing.junction in geometry.junction_types
        assert all(net.hasEdge(edge) for edge in crossing.edges)
        # The area by the shoelace formula.
        x, y = np.array(crossing.outline).T
        area = 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))
        length = sum(
            math.dist(*pair) for pair in zip(crossing.shape, crossing.shape[1:], strict=False)
        )
        assert area == pytest.approx(crossing.width * length, rel=0.02)


def test_lights_have_a_signal_for_every_letter_of_their_states(
    both: tuple[NetworkGeometry, Any],
) -> None:
    geometry, net = both
    lights = {light.id: light for light in geometry.traffic_lights}
    assert set(lights) == {light.getID() for light in net.getTrafficLights()}
    for light in net.getTrafficLights():
        shown = lights[light.getID()]
        program = light.getPrograms()[shown.program]
        assert [(p.duration, p.state) for p in shown.phases] == [
            (p.duration, p.state) for p in program.getPhases()
        ]
        assert {link.index for link in shown.links} == set(range(len(shown.phases[0].state)))
        by_sumo = {(a.getID(), i) for a, _, i in light.getConnections()}
        assert by_sumo <= {(link.lane, link.index) for link in shown.links}
        for link in shown.links:
            assert (link.stop_line is None) is (not net.getLane(link.lane).allows("passenger"))


def test_stop_lines_lie_across_the_ends_of_their_lanes(both: tuple[NetworkGeometry, Any]) -> None:
    geometry, net = both
    assert geometry.stop_lines
    for line in geometry.stop_lines:
        lane = net.getLane(line.lane)
        left, right = np.array(line.points)
        (x0, y0), (x1, y1) = lane.getShape()[-2:]
        assert (left + right) / 2.0 == pytest.approx((x1, y1), abs=0.02)
        assert math.dist(left, right) == pytest.approx(lane.getWidth(), abs=0.03)
        # Left of the way is a positive cross product.
        assert (x1 - x0) * (left[1] - y1) - (y1 - y0) * (left[0] - x1) > 0.0
        assert line.junction == lane.getEdge().getToNode().getID()


def test_regulation_follows_from_the_type_of_the_junction(
    both: tuple[NetworkGeometry, Any],
) -> None:
    geometry, _ = both
    allowed = {
        "traffic_light": {LineControl.SIGNAL},
        "allway_stop": {LineControl.ALL_WAY_STOP},
        "right_before_left": {LineControl.RIGHT_BEFORE_LEFT},
        "priority_stop": {LineControl.STOP, LineControl.NONE},
        "priority": {LineControl.YIELD, LineControl.NONE},
    }
    for line in geometry.stop_lines:
        assert line.control in allowed[geometry.junction_types[line.junction]]
        assert bool(line.light) is (line.control is LineControl.SIGNAL)
    stops = {line.junction for line in geometry.stop_lines if line.control is LineControl.STOP}
    assert stops == {
        name for name, kind in geometry.junction_types.items() if kind == "priority_stop"
    }
    for sign in geometry.signs:
        (line,) = (line for line in geometry.stop_lines if line.lane == sign.lane)
        left, right = line.points
        assert math.dist(sign.position, right) < math.dist(sign.position, left)
        assert line.control is sign.kind


def test_lines_between_lanes_are_the_same_from_both_sides(
    both: tuple[NetworkGeometry, Any],
) -> None:
    geometry, net = both
    lanes = {lane.id: lane for lane in geometry.lanes}
    for lane in geometry.lanes:
        if lane.kind is not LaneKind.ROAD:
            assert {lane.left_marking, lane.right_marking} == {Marking.NONE}
            continue
        beside = lanes.get(f"{lane.edge}_{lane.index + 1}")
        if beside is not None and beside.drivable:
            assert (lane.left_marking, beside.right_marking) == (Marking.BROKEN, Marking.BROKEN)
            continue
        edge = net.getEdge(lane.edge)
        opposite = [
            e for e in edge.getToNode().getOutgoing() if e.getToNode() is edge.getFromNode()
        ]
        if not opposite:
            assert lane.left_marking is Marking.EDGE


def test_directions_are_parted_by_a_centre_line_where_they_share_a_border() -> None:
    networks = NetworkCatalogue(shipped_networks())
    for name, edge, left in (
        ("signal-grid", "-bridge_1", Marking.CENTRE),
        ("highway", "eb_1", Marking.EDGE),
        ("highway", "-chapel", Marking.CENTRE),
        # Its two directions differ in length, as they bend.
        ("old-town", "-south_street", Marking.CENTRE),
        ("old-town", "castle_lane", Marking.EDGE),
    ):
        lanes = [lane for lane in geometry_of(networks.get(name)).lanes if lane.edge == edge]
        assert max(lanes, key=lambda lane: lane.index).left_marking is left


def test_a_forbidden_change_is_a_solid_line_on_its_side(tmp_path: Path) -> None:
    networks = NetworkCatalogue(shipped_networks())
    text = networks.path("signal-grid").read_text()
    lane = '<lane id="-bridge_1_1" index="1"'
    assert lane in text
    path = tmp_path / "grid.net.xml"
    path.write_text(text.replace(lane, f'{lane} changeLeft="bus emergency"'))
    lanes = {one.id: one for one in geometry_of(load_network(path, "grid")).lanes}
    assert lanes["-bridge_1_1"].left_marking is Marking.SOLID
    assert lanes["-bridge_1_2"].right_marking is Marking.BROKEN


def test_geometry_is_sent_compressed_and_once(offline: Offline) -> None:
    url = "/api/v1/networks/signal-grid/geometry"
    plain = offline.client.get(url, headers={"Accept-Encoding": "identity"})
    with offline.client.stream("GET", url, headers={"Accept-Encoding": "gzip"}) as answer:
        sent = b"".join(answer.iter_raw())
    assert answer.headers["Content-Encoding"] == "gzip"
    assert len(sent) < 0.3 * len(plain.content)
    assert offline.client.get(url, headers={"Accept-Encoding": "gzip"}).json() == plain.json()
    known = {"If-None-Match": answer.headers["ETag"], "Accept-Encoding": "gzip"}
    assert offline.client.get(url, headers=known).status_code == 304
    assert offline.client.get(url, headers={**known, "Accept-Encoding": "br"}).status_code == 200
