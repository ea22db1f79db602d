"""A batch of 25 over HTTP with three runs that take their worker down."""

from __future__ import annotations

import contextlib
import json
import shutil
import time
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from drivora_service.cli.application.service_process import run_service
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.importing.network_importing import import_network
from drivora_service.scenario.documents import ScenarioDocument, document_text
from drivora_service.scenario.seed_generation import generate_seeds

RUNS = 25
ROGUES = {5: "crasher", 11: "spinner", 18: "eater"}


def install_rogues(site: Path) -> None:
    """Makes the rogue agents a distribution that Python finds on its path."""
    shutil.copy(Path(__file__).with_name("rogue_agents.py"), site)
    info = site / "rogue_agents-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: rogue-agents\nVersion: 1.0\n")
    lines = [f"{name} = rogue_agents:{name}" for name in ROGUES.values()]
    (info / "entry_points.txt").write_text("\n".join(["[drivora_service.agents]", *lines, ""]))


def batch_lines(networks: NetworkCatalogue) -> list[str]:
    """Returns drives; three have rogue agents, the crasher where no walker can walk."""

    def seeds(town: str, count: int) -> list[ScenarioDocument]:
        found = generate_seeds(
            networks.get(town), count=count, min_length=60, max_length=150, seed=9, agent="idm"
        )
        return list(found)

    drives = seeds("tee-town", RUNS)
    crasher = next(number for number, name in ROGUES.items() if name == "crasher")
    drives[crasher] = seeds("Town01", 1)[0]
    lines = []
    for number, seed in enumerate(drives):
        document = json.loads(document_text(seed))
        document["ego_vehicles"][0]["agent"] = {"name": ROGUES.get(number, "idm")}
        lines.append(json.dumps(document))
    return lines


@pytest.mark.slow
def test_three_rogues_harm_no_other_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, shared_data: Path
) -> None:
    imported = tmp_path / "data" / "networks"
    import_network(shared_data / "maps" / "Town01.net.xml", "Town01", imported)
    networks = NetworkCatalogue(shipped_networks(), imported)
    install_rogues(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("DRIVORA_AGENT_DEADLINE_S", "5")
    monkeypatch.setenv("DRIVORA_MEMORY_LIMIT_MB", "700")
    with run_service(tmp_path / "data", workers=2) as url:
        with httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client:
            answer = client.post(
                "/batches",
                content="\n".join(batch_lines(networks)),
                headers={"Content-Type": "application/x-ndjson"},
            )
            submitted = answer.raise_for_status().json()
            assert submitted["accepted"] == RUNS, submitted
            jobs = [item["job_id"] for item in submitted["items"]]
            batch = submitted["batch"]["id"]
            deadline = time.monotonic() + 240.0
            while not client.get(f"/batches/{batch}").json()["done"]:
                assert time.monotonic() < deadline
                time.sleep(0.2)
            runs = [_run(client, job) for job in jobs]
        workers = [
            p for p in psutil.process_iter(["environ", "cmdline"]) if _is_worker(p, tmp_path)
        ]
    good = [run for number, run in enumerate(runs) if number not in ROGUES]
    assert [run["status"] for run in good] == ["finished"] * (RUNS - len(ROGUES))
    crashed, hung, grown = (runs[number] for number in ROGUES)
    assert (crashed["status"], crashed["error"]["cause"]) in {
        ("simulator_crashed", "signal"),
        ("agent_failed", "signal"),
    }
    assert "SIGSEGV" in crashed["error"]["message"]
    assert (hung["status"], hung["error"]["cause"]) == ("agent_failed", "agent_hung")
    assert grown["error"]["cause"] == "memory_limit"
    assert len(workers) >= 2


def _run(client: httpx.Client, job: str) -> dict[str, Any]:
    found: dict[str, Any] = client.get(f"/runs/{job}").raise_for_status().json()
    return found


def _is_worker(process: psutil.Process, site: Path) -> bool:
    environment = process.info["environ"] or {}
    if environment.get("PYTHONPATH") != str(site):
        return False
    # The server, the resource tracker and the fork server share the environment with the workers,
    # which the fork server has started.
    with contextlib.suppress(psutil.NoSuchProcess):
        parent = process.parent()
        return parent is not None and any("forkserver" in part for part in parent.cmdline())
    return False
