"""Perception by the service equals what the agent got in the same run, step by step."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pyarrow as pa
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.validation import validate_data
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.api.conftest import wait_until_final
from tests.simulation.perception.test_perceived_again import Witness

ARROW = {"Accept": "application/vnd.apache.arrow.stream"}
COLUMNS = ("x", "y", "yaw", "vx", "vy")


def run_of(http: httpx.Client, document: dict[str, Any]) -> dict[str, Any]:
    posted = http.post("/api/v1/jobs", json=document)
    assert posted.status_code == 202, posted.text
    job = wait_until_final(http, posted.json()["id"])
    assert job["status"] == "finished", job
    run: dict[str, Any] = http.get(job["run_url"]).json()
    return run


@pytest.fixture
def foggy(repository: Path) -> dict[str, Any]:
    example = repository / "openscenario_schemas" / "examples" / "roundabout-in-fog.json"
    document: dict[str, Any] = json.loads(example.read_text())
    document["ego_vehicles"][0].pop("config_path")
    document["ego_vehicles"][0]["agent"] = {"name": "idm"}
    document["max_sim_time"] = 20.0
    return document


def test_the_service_computes_what_the_agent_got(http: httpx.Client, foggy: dict[str, Any]) -> None:
    run = run_of(http, foggy)
    networks = NetworkCatalogue(shipped_networks())
    scenario = validate_data(foggy, networks, None).scenario
    agent = AgentCatalogue().create("idm", scenario.ego_vehicles[0].agent.parameters)
    witness = Witness(agent)  # type: ignore[arg-type]  # idm is not one of SUMO's
    episode = Episode(plan_episode(scenario, networks.get("roundabout")), [witness])
    while not episode.done:
        episode.step()
    # The same run, bit for bit: so the agent got the same in the service's worker.
    assert trace_sha256(episode.finish()) == run["trace_sha256"]
    url = f"/api/v1/runs/{run['id']}/perception"
    table = pa.ipc.open_stream(http.get(url, headers=ARROW).content).read_all()
    head = json.loads(table.schema.metadata[b"drivora_perception"])
    rows = table.to_pandas()
    perceived = rows[rows["sight"] == head["sights"].index("perceived")]
    assert len(perceived) > 200
    for step, (actors, states) in witness.got.items():
        here = perceived[perceived["step"] == step]
        assert here["actor"].tolist() == actors.tolist()
        np.testing.assert_array_equal(here[list(COLUMNS)].to_numpy(), states[:, :5])
    missed = rows[rows["sight"] != head["sights"].index("perceived")]
    assert missed[list(COLUMNS)].isna().all().all()

    numbers = http.get(url).json()
    assert numbers["sensor"]["range"] < 150.0
    assert numbers["sensor"]["latency_steps"] > 0
    assert {key: numbers[key] for key in head} == head
    counts = [len(states) for _, states in witness.got.values()]
    # An actor that has left the world may still be perceived, as perception is late.
    assert np.abs(np.array(numbers["counts"]["perceived"]) - counts).max() <= 1
    total = np.sum(list(numbers["counts"].values()), axis=0)
    assert total.tolist() == numbers["present"]


def test_an_ego_that_sumo_drives_has_no_perception(
    http: httpx.Client, scenario: dict[str, Any]
) -> None:
    scenario["ego_vehicles"][0]["agent"] = {"name": "sumo-krauss"}
    run = run_of(http, scenario)
    for headers in ({}, ARROW):
        answer = http.get(f"/api/v1/runs/{run['id']}/perception", headers=headers)
        assert answer.status_code == 409
        assert "SUMO drives the ego 'ego'" in answer.json()["detail"]
