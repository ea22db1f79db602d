"""MetaDrive's expert: its network, what it is shown, how it drives."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drivora_service.agents.built_in_agents import FETCHED
from drivora_service.agents.interface import Agent
from drivora_service.agents.metadrive_ppo.agent import create
from drivora_service.agents.metadrive_ppo.checkpoints import find_checkpoints
from drivora_service.agents.metadrive_ppo.encoding import (
    RAYS,
    encode_checkpoint,
    encode_ego,
    encode_others,
)
from drivora_service.agents.metadrive_ppo.policy import OBSERVATION_SIZE, expert_action
from drivora_service.agents.metadrive_ppo.weights import FILE_NAME, load_weights
from drivora_service.agents.route_corridor import find_corridor
from drivora_service.errors import AgentError
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.driving import assert_stops_at_red, red_light_ahead
from tests.agents.fetched_weights import fetched_weights
from tests.simulation.episodes import network, run

Array = NDArray[np.float64]

OTHERS = slice(19, 35)
CLOUD = slice(35, OBSERVATION_SIZE)
STRAIGHT_PIECE = np.array([60.0, 0.0, 0.0, 0.0, 7.0])


@pytest.fixture(scope="session")
def weights(request: pytest.FixtureRequest) -> Path:
    return fetched_weights("metadrive-ppo", request.config)


@pytest.fixture(scope="module")
def reference() -> dict[str, Any]:
    """What MetaDrive itself showed its expert: see data/make_metadrive_reference.py."""
    with np.load(Path(__file__).parent / "data" / "metadrive_ppo.npz") as arrays:
        return dict(arrays)


def encode(
    ego: Array, speed: float, place: Array, last: Array, pieces: Array, objects: Array, sizes: Array
) -> Array:
    out = np.full(OBSERVATION_SIZE, np.nan)
    encode_ego(ego, speed, place, last, out)
    encode_checkpoint(ego, pieces[0], out[9:14])
    encode_checkpoint(ego, pieces[1], out[14:19])
    encode_others(ego, objects, sizes, np.zeros(len(objects), dtype=np.int64), out)
    return out


def test_its_actions_are_those_of_metadrives_own_code(
    weights: Path, reference: dict[str, Any]
) -> None:
    loaded = load_weights(weights)
    assert len(reference["observation"]) > 20
    for seen, wanted in zip(reference["observation"], reference["action"], strict=True):
        action = expert_action(loaded, seen)
        assert action.shape == (2,)
        assert np.abs(action - wanted).max() < 1e-5


def test_it_is_shown_what_metadrive_shows_it(reference: dict[str, Any]) -> None:
    """The same scenes, encoded by us.

    Release 0.4.3 shows traffic mirrored, which its expert was not trained with (the page of the
    agent says more): the mirrored numbers are turned back before they are compared.
    """
    for i, wanted in enumerate(reference["observation"].astype(np.float64)):
        count = reference["count"][i]
        seen = encode(
            reference["ego"][i],
            float(reference["speed"][i]),
            reference["place"][i],
            reference["last"][i].astype(np.float64),
            reference["pieces"][i],
            reference["objects"][i, :count],
            reference["sizes"][i, :count],
        )
        others = wanted[OTHERS].reshape(4, 4)
        present = others.any(axis=1)
        others[present, 1::2] = 1.0 - others[present, 1::2]
        wanted[36:] = wanted[36:][::-1].copy()
        assert seen[: CLOUD.start] == pytest.approx(wanted[: CLOUD.start], abs=1e-3)
        # A ray that grazes a corner may hit or miss it.
        assert (np.abs(seen - wanted)[CLOUD] > 0.01).sum() <= 6


scenes = st.integers(min_value=0, max_value=2**32 - 1)


@given(scenes, st.floats(-math.pi, math.pi), st.floats(-500, 500), st.floats(-500, 500))
def test_where_the_scene_lies_and_how_it_is_turned_changes_nothing(
    seed: int, turn: float, east: float, north: float
) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(0, 12))
    ego = np.array([*rng.normal(0, 3, 2), 0.1, 8.0, 1.0, 0.0, 0.0, 0.05, 0.0])
    road = np.array([0.0, 0.0, 0.05, 7.0, 2.0])
    pieces = np.array([[40.0, 3.0, 0.0, 0.0, 7.0], [60.0, 20.0, 25.0, 0.9, 7.0]])
    objects = np.zeros((count, 9))
    objects[:, :2] = rng.uniform(-60, 60, (count, 2))
    objects[:, 2] = rng.uniform(-3, 3, count)
    objects[:, 3:5] = rng.normal(0, 6, (count, 2))
    sizes = rng.uniform((3.0, 1.5), (9.0, 2.5), (count, 2))
    last = rng.uniform(-1, 1, 2)

    def moved(rows: Array, points: int, vectors: int | None = None) -> Array:
        cos, sin = math.cos(turn), math.sin(turn)
        rotation = np.array([[cos, sin], [-sin, cos]])
        rows = rows.copy()
        rows[..., points : points + 2] = rows[..., points : points + 2] @ rotation + [east, north]
        if vectors is not None:
            rows[..., 2] += turn
            rows[..., vectors : vectors + 2] = rows[..., vectors : vectors + 2] @ rotation
        return rows

    here = encode(ego, 8.0, road, last, pieces, objects, sizes)
    there_road = moved(road, 0)
    there_road[2] += turn
    there = encode(
        moved(ego, 0, 3), 8.0, there_road, last, moved(pieces, 0), moved(objects, 0, 3), sizes
    )
    assert there[: CLOUD.start] == pytest.approx(here[: CLOUD.start], abs=1e-6)
    # A ray that just touches a corner may miss it after the turn.
    assert (np.abs(there - here)[CLOUD] > 1e-4).sum() <= 2


def test_a_straight_road_with_a_leader() -> None:
    """In the right lane of two, 1 m right of its middle, 20 m behind a car that drives 5 m/s."""
    ego = np.array([0.0, -2.75, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    leader = np.array([[20.0, -1.75, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    road = np.array([0.0, 0.0, 0.0, 7.0, 2.0])
    pieces = np.array([STRAIGHT_PIECE, STRAIGHT_PIECE])
    seen = encode(ego, 10.0, road, np.array([0.0, 0.5]), pieces, leader, np.array([[4.0, 2.0]]))
    assert seen[:9] == pytest.approx(
        [6.25 / 18, 0.75 / 18, 0.5, 37 / 81, 0.5, 0.5, 0.75, 0.0, 0.5 + 1.0 / 4.5]
    )
    distance = math.hypot(60.0, 2.75)
    ahead, left = 0.5 + 30.0 / distance, 0.5 - 0.5 * 2.75 / distance
    assert seen[9:14] == pytest.approx([0.5 + 0.5 * 60.0 / distance, left, 0.0, 0.5, 0.5])
    assert ahead == pytest.approx(seen[14])
    assert seen[19:23] == pytest.approx([0.7, 0.49, 0.5 - 18 / 160, 0.5])
    assert not seen[23:35].any()
    assert seen[35] == pytest.approx(18.0 / 50.0)
    # 2 m of width, from 2 m to the left to level with us, 18 m ahead: rays 1.5 degrees apart.
    assert np.flatnonzero(seen[CLOUD] < 1.0).tolist() == [0, *range(RAYS - 4, RAYS)]


def test_a_left_turn_lies_ahead_and_to_the_left() -> None:
    grid = network("signal-grid")
    turn = next(
        (lane.index, link.to_lane)
        for lane in grid.lanes
        for link in lane.connections
        if link.direction == "l" and not lane.is_internal and lane.arc[-1] > 60
    )
    after = turn[1]
    while grid.lanes[after].is_internal:
        after = grid.lanes[after].connections[0].to_lane
    before = grid.lanes[turn[0]]
    points = [before.position_at(before.arc[-1] - 55.0), grid.lanes[after].position_at(50.0)]
    route = plan_route(grid, [RoutePoint(x=x, y=y, yaw=yaw) for x, y, yaw in points])
    corridor = find_corridor(grid, route)
    pieces = find_checkpoints(corridor)
    assert [bool(radius) for radius in pieces.pieces[:, 2]] == [False, True, False]
    assert pieces.pieces[1, 3] == pytest.approx(math.pi / 2, abs=0.1)
    assert 5.0 < pieces.pieces[1, 2] < 30.0
    assert 40.0 < pieces.ends[0] < 60.0
    x, y, yaw = points[0]
    ego = np.array([x, y, yaw, 0, 0, 0, 0, 0, 0], dtype=np.float64)
    first, second = np.zeros(5), np.zeros(5)
    encode_checkpoint(ego, pieces.pieces[0], first)
    encode_checkpoint(ego, pieces.pieces[1], second)
    assert first[0] > 0.9
    assert first[1] == pytest.approx(0.5, abs=0.05)
    assert first[2:].tolist() == [0.0, 0.5, 0.5]
    assert second[1] < 0.45
    assert second[3] == 0.0
    assert second[4] == pytest.approx(0.5 + 0.5 * 90 / 135, abs=0.05)


def test_the_road_it_is_shown_is_the_lanes_that_lead_on() -> None:
    grid = network("signal-grid")
    lane = next(lane for lane in grid.lanes if lane.left >= 0 and not lane.is_internal)
    begin, end = lane.position_at(5.0), lane.position_at(0.5 * lane.arc[-1])
    route = plan_route(grid, [RoutePoint(x=x, y=y, yaw=yaw) for x, y, yaw in (begin, end)])
    corridor = find_corridor(grid, route)
    siblings = [grid.lanes[i] for i in grid.edge_lanes[lane.edge_id] if grid.lanes[i].drivable]
    assert set(corridor.lanes) == {len(siblings)}
    assert corridor.width == pytest.approx(sum(sibling.width for sibling in siblings))
    centre = np.mean([sibling.position_at(5.0)[:2] for sibling in siblings], axis=0)
    assert corridor.middle[0] == pytest.approx(centre, abs=0.3)


def test_files_that_are_not_its_weights_are_refused(tmp_path: Path) -> None:
    with pytest.raises(AgentError, match="drivora agents install metadrive-ppo --again"):
        load_weights(tmp_path / "nowhere")
    (tmp_path / FILE_NAME).write_bytes(b"PK broken")
    with pytest.raises(AgentError, match="cannot be used"):
        load_weights(tmp_path)
    other = tmp_path / "other"
    other.mkdir()
    layers = ("fc_1", "fc_2", "fc_out")
    arrays: dict[str, Any] = {
        f"default_policy/{n}/{k}": np.zeros(3) for n in layers for k in ("kernel", "bias")
    }
    np.savez(other / FILE_NAME, **arrays)
    with pytest.raises(AgentError, match="shape"):
        load_weights(other)


def test_it_takes_no_parameters(tmp_path: Path) -> None:
    with pytest.raises(AgentError, match="it takes none") as failure:
        create({"speed": 3}, tmp_path)
    assert failure.value.cause == "agent_parameters"


def test_its_entry_says_what_it_does_not_know() -> None:
    entry = next(plugin.entry for plugin in FETCHED if plugin.name == "metadrive-ppo")
    assert "lights" in entry.description
    assert entry.licence == "Apache-2.0"


def test_its_adapter_stops_it_at_red(weights: Path) -> None:
    trace = run(red_light_ahead(), create({}, weights))
    assert_stops_at_red(trace)


class TestMetaDrivePpo(AgentContract):
    @pytest.fixture(autouse=True)
    def _fetch(self, weights: Path) -> None:
        self.folder = weights

    def make_agent(self) -> Agent:
        return create({}, self.folder)
