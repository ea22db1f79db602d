"""plant-lite: its network, what it is shown, how it drives."""

from __future__ import annotations

import hashlib
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.imitation.weights import FILE_NAME, load_weights
from drivora_service.agents.interface import Agent
from drivora_service.agents.plant_lite.network import PlantNetwork, PlantWeights
from drivora_service.agents.plant_lite.view import OBJECT_SIZE, OBJECTS, OBJECTS_AT, show_others
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.driving import assert_stops_at_red, car_ahead, red_light_ahead
from tests.simulation.episodes import closest, run

STRAIGHT = np.column_stack([np.arange(-60.0, 200.0), np.zeros(260), np.arange(260.0), np.ones(260)])
"""A way along the x axis; the ego is at its 60th metre."""


@pytest.fixture(scope="module")
def reference() -> dict[str, Any]:
    """What PyTorch answers with the same weights: see data/make_imitation_reference.py."""
    with np.load(Path(__file__).parent / "data" / "plant_lite.npz") as arrays:
        return dict(arrays)


def made() -> Agent:
    agent = AgentCatalogue().create("plant-lite", {})
    assert not isinstance(agent, SumoDriver)
    return agent


def shown(objects: FloatArray) -> NDArray[np.float32]:
    out = np.full((OBJECTS, OBJECT_SIZE), np.nan, dtype=np.float32)
    kinds, sizes = np.arange(len(objects)) % 3, np.full((len(objects), 2), (4.0, 2.0))
    show_others(np.zeros(9), objects, sizes, kinds, STRAIGHT, 60, 60.0, out)
    return out


def test_its_weights_are_those_that_its_page_speaks_of() -> None:
    file = resources.files("drivora_service.agents.plant_lite").joinpath(FILE_NAME).read_bytes()
    assert len(file) < 400_000
    assert (
        hashlib.sha256(file).hexdigest()
        == "64007759722a67cbd30db35488962364979a9d41137a77a6d1a38a6276c85e27"
    )


def test_its_waypoints_are_those_of_pytorch(reference: dict[str, Any]) -> None:
    network = PlantNetwork(load_weights(PlantWeights))
    counts = reference["seen"][:, OBJECTS_AT:].reshape(-1, OBJECTS, OBJECT_SIZE)[:, :, 0].sum(1)
    assert len(set(counts)) > 4
    for seen, wanted in zip(reference["seen"], reference["waypoints"], strict=True):
        assert np.abs(network.waypoints(seen) - wanted).max() < 1e-5


def test_the_order_of_the_others_does_not_count(reference: dict[str, Any]) -> None:
    network = PlantNetwork(load_weights(PlantWeights))
    others = reference["seen"][:, OBJECTS_AT:].reshape(-1, OBJECTS, OBJECT_SIZE)
    row = int(others[:, :, 0].sum(axis=1).argmax())
    count = int(others[row, :, 0].sum())
    assert count > 2
    first = network.waypoints(reference["seen"][row]).copy()
    turned = reference["seen"][row].copy()
    turned[OBJECTS_AT:].reshape(OBJECTS, OBJECT_SIZE)[:count] = others[row, :count][::-1]
    assert np.abs(network.waypoints(turned) - first).max() < 1e-4


@given(st.integers(0, 2**32 - 1), st.integers(0, 30))
def test_the_nearest_are_shown_first(seed: int, count: int) -> None:
    objects = np.zeros((count, 9))
    objects[:, :2] = np.random.default_rng(seed).uniform(-80.0, 80.0, (count, 2))
    near = np.sort(np.hypot(objects[:, 0], objects[:, 1]))
    near = near[near <= 60.0][:OBJECTS]
    others = shown(objects)
    assert others[:, 0].tolist() == [1.0] * len(near) + [0.0] * (OBJECTS - len(near))
    assert 40.0 * np.hypot(others[: len(near), 1], others[: len(near), 2]) == pytest.approx(near)
    assert not others[len(near) :].any()


def test_what_is_shown_of_a_car_that_crosses() -> None:
    """20 m ahead and 5 m to the right, driving to the left at 7.5 m/s."""
    other = np.array([[20.0, -5.0, np.pi / 2, 0.0, 7.5, 0.0, 0.0, 0.0, 0.0]])
    row = shown(other)[0]
    assert row == pytest.approx(
        [1, 0.5, -0.125, 0, 1, 0.5, 0.4, 0.5, 0, 0, 0.5, -0.5, 0, 0.5], abs=1e-6
    )


def test_it_takes_no_parameters() -> None:
    with pytest.raises(AgentError, match="takes none") as failure:
        AgentCatalogue().create("plant-lite", {"speed": 3})
    assert failure.value.cause == "agent_parameters"


def test_it_stops_at_red_and_goes_on() -> None:
    trace = run(red_light_ahead(), made())
    assert_stops_at_red(trace, before_line=6.0)


@pytest.mark.parametrize("speed", [0.0, 2.0, 5.0])
def test_it_stays_behind_a_car_that_stands_or_is_slow(speed: float) -> None:
    trace = run(car_ahead(speed), made())
    assert not trace.contacts
    gap = closest(trace, "ego", "npc")
    assert gap < 25.0, "it never came near"


class TestPlantLite(AgentContract):
    def make_agent(self) -> Agent:
        return made()
