from __future__ import annotations

import hashlib
import re
from pathlib import Path

import numpy as np
import pytest

from drivora_service.errors import NetworkError
from drivora_service.networks.network_loading import load_network
from drivora_service.networks.road_network import RoadNetwork


def assert_usable(network: RoadNetwork) -> None:
    """Every lane has a shape to project on and links that lead somewhere."""
    for index, lane in enumerate(network.lanes):
        assert lane.index == index
        assert network.lane_by_id[lane.id] == index
        assert len(lane.shape) == len(lane.arc) >= 2
        assert lane.arc[0] == 0.0
        assert (np.diff(lane.arc) > 0.0).all()
        assert np.isfinite(lane.shape).all()
        assert lane.width > 0.0
        assert lane.speed_limit > 0.0
        for link in lane.connections:
            following = network.lanes[link.to_lane]
            if lane.drivable and following.drivable:
                gap = np.hypot(*(following.shape[0] - lane.shape[-1]))
                assert gap < 0.5, (lane.id, following.id)
                turn = following.position_at(0.0)[2] - lane.position_at(lane.length)[2]
                assert np.cos(turn) > 0.7, (lane.id, following.id)
            if link.traffic_light:
                program = network.programs[link.traffic_light]
                assert 0 <= link.link_index < len(program.phases[0].state)
        for side in (lane.left, lane.right):
            assert side < 0 or network.lanes[side].edge_id == lane.edge_id


def test_real_towns_are_usable(town: RoadNetwork) -> None:
    assert_usable(town)
    assert not any(lane.walkable for lane in town.lanes)


def test_shipped_networks_are_usable(shipped_network: RoadNetwork) -> None:
    assert_usable(shipped_network)


def test_what_stands_in_the_file(loop: RoadNetwork, loop_file: Path) -> None:
    assert loop.name == "loop"
    assert loop.path == loop_file
    assert loop.sha256 == hashlib.sha256(loop_file.read_bytes()).hexdigest()
    assert loop.net_offset == (5.0, -7.5)
    assert loop.bounds == (-20.0, 0.0, 260.0, 60.0)
    lane = loop.lane("a_1")
    assert (lane.width, lane.speed_limit, lane.length, lane.lane_number) == (3.2, 15.0, 100.0, 1)
    assert lane.to_junction == "n1"
    assert loop.edge_lanes["a"] == tuple(loop.lane_by_id[f"a_{n}"] for n in range(3))
    assert loop.junction_shapes["n1"].shape == (4, 2)
    assert "n4" not in loop.junction_shapes


def test_who_may_use_a_lane(loop: RoadNetwork) -> None:
    use = {lane.id: (lane.drivable, lane.walkable) for lane in loop.lanes}
    assert use["a_0"] == (False, True)
    assert use["a_1"] == (True, False)
    assert use["b_0"] == (True, True)
    assert use[":n1_c0_0"] == (False, True)
    assert use[":n1_w0_0"] == (False, True)


def test_neighbours_are_drivable(loop: RoadNetwork) -> None:
    right, left = loop.lane("a_1"), loop.lane("a_2")
    assert (right.left, right.right) == (left.index, -1)
    assert (left.left, left.right) == (-1, right.index)


def test_connections_lead_through_internal_lanes(loop: RoadNetwork) -> None:
    (link,) = loop.lane("a_2").connections
    assert loop.lanes[link.to_lane].id == ":n1_1_0"
    assert (link.traffic_light, link.link_index, link.direction) == ("n1", 1, "s")
    (inside,) = loop.lane(":n1_1_0").connections
    assert loop.lanes[inside.to_lane].id == ":n1_2_0"
    assert (inside.traffic_light, inside.link_index) == ("", -1)
    (behind,) = loop.lane(":n1_2_0").connections
    assert loop.lanes[behind.to_lane].id == "b_1"
    assert loop.lane("b_1").connections == ()
    assert loop.lane(":n1_0_0").is_internal
    assert loop.lane(":n1_0_0").to_junction == ""


def test_collapsed_lane_gets_its_neighbours_direction(loop: RoadNetwork) -> None:
    lane = loop.lane(":n2_0_0")
    assert lane.position_at(0.0) == pytest.approx((200.0, 0.0, 0.0), abs=0.01)
    assert lane.arc[-1] == pytest.approx(0.01)


def test_last_program_is_the_one_that_runs(loop: RoadNetwork) -> None:
    program = loop.programs["n1"]
    assert (program.program_id, program.offset) == ("evening", 4.0)
    assert [(p.duration, p.state) for p in program.phases] == [
        (30.0, "Gr"),
        (3.0, "yr"),
        (20.5, "rG"),
    ]


def test_arrays_cannot_be_changed(loop: RoadNetwork) -> None:
    with pytest.raises(ValueError, match="read-only"):
        loop.lanes[0].shape[0, 0] = 1.0


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not well-formed XML"),
        ("<net", "not well-formed XML"),
        ("<OpenDRIVE/>", "not a SUMO network"),
        ('<net version="1.20"/>', "not a SUMO network|no lane"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, text: str, reason: str) -> None:
    path = tmp_path / "bad.net.xml"
    path.write_text(text)
    with pytest.raises(NetworkError, match=reason):
        load_network(path, "bad")


def test_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NetworkError, match="'gone' cannot be read"):
        load_network(tmp_path / "gone.net.xml", "gone")


def test_network_without_roads_is_refused(tmp_path: Path, loop_file: Path) -> None:
    path = tmp_path / "rails.net.xml"
    open_to_all = re.sub(r'(dis)?allow="[^"]*" ', "", loop_file.read_text())
    path.write_text(open_to_all.replace("speed=", 'allow="tram" speed='))
    with pytest.raises(NetworkError, match="no lane that is open to passenger cars"):
        load_network(path, "rails")
