"""Agents that turn against the service, over HTTP: each costs its own run and no other."""

from __future__ import annotations

import json
import shutil
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from drivora_service.cli.application.service_process import run_service
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds

EXPECTED = {
    "commander": ("agent_failed", "worker_protocol"),
    "promiser": ("agent_failed", "worker_protocol"),
    "spawner": ("agent_failed", "agent_hung"),
    "killer": ("infrastructure_failed", "worker_lost"),
    "daemonizer": ("finished", ""),
}


def install_agents(site: Path) -> None:
    """Makes the agents a distribution that Python finds on its path."""
    site.mkdir()
    shutil.copy(Path(__file__).with_name("hostile_agents.py"), site)
    info = site / "hostile_agents-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: hostile-agents\nVersion: 1.0\n")
    lines = [f"{name} = hostile_agents:{name}" for name in EXPECTED]
    (info / "entry_points.txt").write_text("\n".join(["[drivora_service.agents]", *lines, ""]))


def drives() -> list[tuple[str, str]]:
    """Returns documents with their agents: an honest one beside each of the others."""
    (seed,) = generate_seeds(
        NetworkCatalogue(shipped_networks()).get("tee-town"),
        count=1, min_length=60, max_length=100, seed=9, agent="idm",
    )  # fmt: skip
    found = []
    for name in [each for pair in EXPECTED for each in (pair, "idm")]:
        document = json.loads(document_text(seed))
        document["ego_vehicles"][0]["agent"] = {"name": name}
        document["max_sim_time"] = 5.0
        found.append((name, json.dumps(document)))
    return found


def result_of(client: httpx.Client, job: str) -> dict[str, Any]:
    deadline = time.monotonic() + 240.0
    while time.monotonic() < deadline:
        run: dict[str, Any] = client.get(f"/runs/{job}").raise_for_status().json()
        if run["status"] not in ("queued", "running"):
            return run
        time.sleep(0.2)
    raise AssertionError("the run did not end")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_agents_that_turn_against_the_service_cost_their_own_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_agents(tmp_path / "site")
    notes = tmp_path / "notes"
    notes.mkdir()
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"))
    monkeypatch.setenv("HOSTILE_NOTES", str(notes))
    monkeypatch.setenv("DRIVORA_AGENT_DEADLINE_S", "5")
    documents = drives()
    with run_service(tmp_path / "data", workers=2) as url:
        with httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client:
            answer = client.post(
                "/batches",
                content="\n".join(document for _, document in documents),
                headers={"Content-Type": "application/x-ndjson"},
            )
            submitted = answer.raise_for_status().json()
            jobs = [item["job_id"] for item in submitted["items"]]
            runs = [result_of(client, job) for job in jobs]
        assert httpx.get(f"{url}/readyz", timeout=60.0).status_code == 200
        daemon = int((notes / "daemon").read_text())
        deadline = time.monotonic() + 20.0
        while psutil.pid_exists(daemon) and time.monotonic() < deadline:
            time.sleep(0.1)
        assert not psutil.pid_exists(daemon)
    found = {
        name: (run["status"], (run.get("error") or {}).get("cause", ""))
        for (name, _), run in zip(documents, runs, strict=True)
    }
    assert found == {**EXPECTED, "idm": ("finished", "")}
    honest = {
        run["status"] for (name, _), run in zip(documents, runs, strict=True) if name == "idm"
    }
    assert honest == {"finished"}
    assert not (notes / "commanded").exists()
