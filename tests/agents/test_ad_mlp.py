"""ad-mlp: its network and its inputs, which contain no other actors."""

from __future__ import annotations

import hashlib
import io
import zipfile
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.ad_mlp.network import AdMlpNetwork, AdMlpWeights
from drivora_service.agents.ad_mlp.view import FRAME_SIZE, FRAMES, show_past
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.imitation.weights import FILE_NAME, load_weights, save_weights
from drivora_service.agents.interface import Agent
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError
from drivora_service.observations.trace import TerminalEvent
from drivora_service.testing.agent_contract import AgentContract
from tests.simulation.episodes import contacts, ego, obstacle, place, run, scenario


def made() -> Agent:
    agent = AgentCatalogue().create("ad-mlp", {})
    assert not isinstance(agent, SumoDriver)
    return agent


def members(file: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(file)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_its_weights_are_those_that_its_page_speaks_of() -> None:
    file = resources.files("drivora_service.agents.ad_mlp").joinpath(FILE_NAME).read_bytes()
    assert len(file) < 400_000
    assert (
        hashlib.sha256(file).hexdigest()
        == "7e87fbfdcbc2bdb7248587ca2bfd66c85f064a153b594768fe8d2d7f03121736"
    )


def test_weights_are_written_as_they_are_read_under_the_name_that_was_asked_for(
    tmp_path: Path,
) -> None:
    save_weights(load_weights(AdMlpWeights), tmp_path / "trained")
    file = resources.files("drivora_service.agents.ad_mlp").joinpath(FILE_NAME).read_bytes()
    # How a member is packed differs between versions of Python, what is in it does not.
    assert members((tmp_path / "trained").read_bytes()) == members(file)


def test_its_waypoints_are_those_of_pytorch() -> None:
    with np.load(Path(__file__).parent / "data" / "ad_mlp.npz") as arrays:
        reference: dict[str, Any] = dict(arrays)
    network = AdMlpNetwork(load_weights(AdMlpWeights))
    assert len(reference["seen"]) > 20
    for seen, wanted in zip(reference["seen"], reference["waypoints"], strict=True):
        assert np.abs(network.waypoints(seen) - wanted).max() < 1e-5


def test_it_is_shown_where_it_came_from() -> None:
    """Straight to the east at 8 m/s, a state a second in the ring, the newest in its middle."""
    past = np.zeros((5, 4))
    for age in range(5):
        past[(2 - age) % 5] = -8.0 * age, 0.0, 0.0, 8.0 - age
    out = np.full((FRAMES, FRAME_SIZE), np.nan, dtype=np.float32)
    show_past(np.zeros(9), past, 2, 1, out)
    assert out[:, 0] == pytest.approx([-0.2, -0.4, -0.6, -0.8])
    assert out[:, 1:3] == pytest.approx(0.0)
    assert out[:, 3] == pytest.approx(np.array([7.0, 6.0, 5.0, 4.0]) / 15.0)


def test_it_sees_no_other_actor() -> None:
    way = (place("harbour_0_0", 60), place("harbour_0_0", 140))
    box = obstacle(place("harbour_0_0", 110))
    what = scenario(ego(*way, initial_speed=8.0), npc_obstacles=(box,), seconds=20.0)
    trace = run(what, made())
    assert contacts(trace) == [("ego", "box")]
    assert trace.ego_ends == (TerminalEvent.COLLISION,)


def test_it_takes_no_parameters() -> None:
    with pytest.raises(AgentError, match="takes none") as failure:
        AgentCatalogue().create("ad-mlp", {"speed": 3})
    assert failure.value.cause == "agent_parameters"


def test_its_entry_says_that_it_sees_no_other_actor() -> None:
    assert "perceives no actors" in AgentCatalogue().entry("ad-mlp").description


class TestAdMlp(AgentContract):
    def make_agent(self) -> Agent:
        return made()
