"""PufferLib's driving policy: its network, what it is shown, how it drives."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.special import softmax

from drivora_service.agents.built_in_agents import FETCHED
from drivora_service.agents.interface import Agent
from drivora_service.agents.puffer_drive.agent import create
from drivora_service.agents.puffer_drive.encoding import encode
from drivora_service.agents.puffer_drive.policy import (
    ACCELERATIONS,
    OBSERVATION_SIZE,
    ROAD_PIECES,
    VEHICLES,
    DrivePolicy,
)
from drivora_service.agents.puffer_drive.road import EDGE, LANE, LINE, pieces_along, road_pieces
from drivora_service.agents.puffer_drive.weights import FILE_NAME, load_weights
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import Float32Array
from drivora_service.networks.drivable_area import outside_distance
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.driving import assert_stops_at_red, red_light_ahead
from tests.agents.fetched_weights import fetched_weights
from tests.simulation.episodes import network, place, run

Array = NDArray[np.float64]

NO_ROAD = np.zeros((0, 6))
SIZE = np.array([4.9, 2.1])


@pytest.fixture(scope="session")
def weights(request: pytest.FixtureRequest) -> Path:
    return fetched_weights("puffer-drive", request.config)


@pytest.fixture(scope="module")
def reference() -> dict[str, Any]:
    """What PufferLib's own code showed and answered: see data/make_puffer_reference.py."""
    with np.load(Path(__file__).parent / "data" / "puffer_drive.npz") as arrays:
        return dict(arrays)


def seen_by(
    ego: Array,
    speed: float,
    goal: Array,
    objects: Array,
    sizes: Array,
    road: Array = NO_ROAD,
    size: Array = SIZE,
) -> tuple[Float32Array, Float32Array, Float32Array]:
    """The ego's part, the vehicles', and the road's."""
    out = np.full(OBSERVATION_SIZE, np.nan, dtype=np.float32)
    encode(ego, speed, size, goal, objects, sizes, road, out)
    return out[:6], out[6:447].reshape(VEHICLES, 7), out[447:].reshape(ROAD_PIECES, 7)


def test_its_actions_are_those_of_pufferlibs_own_network(
    weights: Path, reference: dict[str, Any]
) -> None:
    loaded = load_weights(weights)
    for vehicle, wanted in zip(reference["observation"], reference["logits"], strict=True):
        policy = DrivePolicy(loaded)
        for seen, logits in zip(vehicle, wanted, strict=True):
            answer = policy.logits(seen)
            assert answer.shape == logits.shape == (20,)
            for part in (slice(0, ACCELERATIONS), slice(ACCELERATIONS, 20)):
                assert answer[part].argmax() == logits[part].argmax()
                assert np.abs(softmax(answer[part]) - softmax(logits[part])).max() < 1e-5


def test_its_memory_counts_and_can_be_emptied(weights: Path, reference: dict[str, Any]) -> None:
    policy = DrivePolicy(load_weights(weights))
    first, second = (policy.logits(seen).copy() for seen in reference["observation"][0][:2])
    assert (
        np.abs(
            DrivePolicy(load_weights(weights)).logits(reference["observation"][0][1]) - second
        ).max()
        > 1e-3
    )
    policy.forget()
    assert np.array_equal(policy.logits(reference["observation"][0][0]), first)


def test_it_is_shown_what_pufferlib_shows_it(reference: dict[str, Any]) -> None:
    """Ego and vehicles of the same scene; the road is another one and comes otherwise about."""
    states, sizes = reference["states"], reference["sizes"]
    for row, goal in enumerate(reference["goals"]):
        others = np.arange(len(states)) != row
        ego, vehicles, _ = seen_by(
            states[row],
            float(np.hypot(*states[row, 3:5])),
            goal,
            states[others],
            sizes[others],
            size=sizes[row],
        )
        wanted = reference["observation"][row][0]
        assert ego == pytest.approx(wanted[:6], abs=1e-6)
        theirs = wanted[6:447].reshape(VEHICLES, 7)
        assert _sorted(vehicles) == pytest.approx(_sorted(theirs), abs=1e-6)


def _sorted(rows: Float32Array) -> Float32Array:
    """Rows in an order of their own: the network keeps the largest response, whatever the order."""
    return rows[np.lexsort(np.round(rows.T, 4))]


scenes = st.integers(min_value=0, max_value=2**32 - 1)


@given(scenes, st.floats(-math.pi, math.pi), st.floats(-500, 500), st.floats(-500, 500))
def test_where_the_scene_lies_and_how_it_is_turned_changes_nothing(
    seed: int, turn: float, east: float, north: float
) -> None:
    rng = np.random.default_rng(seed)
    count, pieces = int(rng.integers(0, 80)), int(rng.integers(0, 300))
    ego = np.array([1.0, 2.0, 0.3, 8.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    objects = np.zeros((count, 9))
    objects[:, :2] = rng.uniform(-60, 60, (count, 2))
    objects[:, 2] = rng.uniform(-3, 3, count)
    objects[:, 3:5] = rng.normal(0, 6, (count, 2))
    sizes = rng.uniform((3.0, 1.5), (9.0, 2.5), (count, 2))
    road = np.zeros((pieces, 6))
    road[:, :2] = rng.uniform(-60, 60, (pieces, 2))
    angles = rng.uniform(-3, 3, pieces)
    road[:, 2], road[:, 3] = np.cos(angles), np.sin(angles)
    road[:, 4:] = rng.uniform(1, 4, pieces)[:, None] * [1.0, 0.0]
    road[:, 5] = rng.integers(0, 3, pieces)
    goal = np.array([20.0, 5.0])

    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    shift = np.array([east, north])
    ego2, objects2, road2 = ego.copy(), objects.copy(), road.copy()
    ego2[:2], objects2[:, :2] = ego[:2] @ rotation + shift, objects[:, :2] @ rotation + shift
    road2[:, :2], road2[:, 2:4] = road[:, :2] @ rotation + shift, road[:, 2:4] @ rotation
    ego2[2] += turn
    objects2[:, 2] += turn
    objects2[:, 3:5] = objects[:, 3:5] @ rotation

    here = seen_by(ego, 8.0, goal, objects, sizes, road)
    there = seen_by(ego2, 8.0, goal @ rotation + shift, objects2, sizes, road2)
    for one, two in zip(here, there, strict=True):
        assert two == pytest.approx(one, abs=1e-5)


def test_a_straight_road_with_a_leader() -> None:
    """Heading north at 10 m/s, 20 m behind a car that drives 5 m/s, the goal 30 m ahead."""
    ego = np.array([5.0, 5.0, math.pi / 2, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0])
    leader = np.array([[5.0, 25.0, math.pi / 2, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0]])
    lane = np.array([[3.0, 15.0, 0.0, 1.0, 4.0, LANE]])
    own, vehicles, road = seen_by(
        ego, 10.0, np.array([5.0, 35.0]), leader, np.array([[4.0, 2.0]]), lane
    )
    assert own == pytest.approx([0.3, 0.0, 0.1, 0.7 * 2.1 / 15, 0.7 * 4.9 / 30, 0.0], abs=1e-6)
    assert vehicles[0] == pytest.approx(
        [0.2, 0.0, 1.4 / 15, 2.8 / 30, math.pi / 2, 0.0, 0.05], abs=1e-6
    )
    assert road[0] == pytest.approx([0.1, 0.02, 0.04, 0.001, math.pi / 2, 0.0, LANE], abs=1e-6)
    assert not vehicles[1:].any()
    assert not road[1:].any()


def test_a_left_turn_and_a_car_that_comes_from_the_right() -> None:
    ego = np.array([0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    crossing = np.array([[10.0, -15.0, math.pi / 2, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0]])
    own, vehicles, _ = seen_by(ego, 5.0, np.array([12.0, 9.0]), crossing, np.array([[4.0, 2.0]]))
    assert own[:2] == pytest.approx([0.12, 0.09])
    assert vehicles[0, :2] == pytest.approx([0.1, -0.15])
    assert vehicles[0, 4:] == pytest.approx([0.0, math.pi / 2, 0.08], abs=1e-6)


def test_the_nearest_are_shown_where_there_are_too_many() -> None:
    ego = np.zeros(9)
    objects = np.zeros((90, 9))
    objects[:, 0] = np.linspace(45.0, 1.0, 90)
    road = np.zeros((400, 6))
    road[:, 0], road[:, 2] = np.linspace(-60.0, 50.0, 400), 1.0
    _, vehicles, pieces = seen_by(ego, 0.0, np.zeros(2), objects, np.full((90, 2), 2.0), road)
    assert vehicles[:, 0] == pytest.approx(np.sort(objects[:, 0])[:VEHICLES] / 100.0)
    assert np.abs(pieces[:, 0]).max() < 0.3


def test_the_road_is_made_of_lanes_lines_and_edges() -> None:
    town = network("tee-town")
    pieces = road_pieces(town)
    assert set(pieces[:, 5]) == {LANE, LINE, EDGE}
    assert pieces[:, 4].max() <= 4.0 + 1e-6
    assert np.hypot(pieces[:, 2], pieces[:, 3]) == pytest.approx(1.0)
    lanes = sum(float(lane.arc[-1]) for lane in town.lanes if lane.drivable)
    assert 2.0 * pieces[pieces[:, 5] == LANE, 4].sum() == pytest.approx(lanes, rel=0.02)
    # Beside an edge is one side on the road and one off it.
    edges = pieces[(pieces[:, 5] == EDGE) & (pieces[:, 4] > 1.0)]
    normal = np.column_stack((-edges[:, 3], edges[:, 2]))
    sides = [outside_distance(town, edges[:, :2] + k * normal) > 0.0 for k in (-0.5, 0.5)]
    assert (sides[0] != sides[1]).mean() > 0.95


def test_only_the_road_near_the_route_is_kept() -> None:
    town = network("tee-town")
    ends = [place("harbour_1_0", 20), place("harbour_1_0", 120)]
    route = plan_route(town, [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in ends])
    near = pieces_along(town, route)
    assert 0 < len(near) < len(road_pieces(town))
    gaps = np.hypot(*(near[:, None, :2] - route.line[None]).transpose(2, 0, 1)).min(axis=1)
    assert gaps.max() <= 120.5


def test_files_that_are_not_its_weights_are_refused(tmp_path: Path) -> None:
    with pytest.raises(AgentError, match="drivora agents install puffer-drive --again"):
        load_weights(tmp_path / "nowhere")
    (tmp_path / FILE_NAME).write_bytes(bytes(400))
    with pytest.raises(AgentError, match="100 numbers"):
        load_weights(tmp_path)


@pytest.mark.parametrize(
    "parameters",
    [{"speed": 3}, {"goal_distance": "far"}, {"goal_distance": 1}, {"goal_distance": True}],
)
def test_parameters_that_it_does_not_take_are_refused(
    parameters: dict[str, object], tmp_path: Path
) -> None:
    with pytest.raises(AgentError, match="goal_distance") as failure:
        create(parameters, tmp_path)
    assert failure.value.cause == "agent_parameters"


def test_its_entry_says_what_it_does_not_know() -> None:
    entry = next(plugin.entry for plugin in FETCHED if plugin.name == "puffer-drive")
    assert "lights" in entry.description
    assert entry.licence == "MIT"


def test_its_adapter_stops_it_at_red(weights: Path) -> None:
    trace = run(red_light_ahead(), create({}, weights))
    assert_stops_at_red(trace)


class TestPufferDrive(AgentContract):
    @pytest.fixture(autouse=True)
    def _fetch(self, weights: Path) -> None:
        self.folder = weights

    def make_agent(self) -> Agent:
        return create({}, self.folder)
