"""An agent that changes the judging code loses its own run, and no other run of the worker."""

from __future__ import annotations

import importlib
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.worker.setup import WorkerSetup


def install(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes the agent a distribution that workers find on their path."""
    info = site / "meddling_agents-1.0.dist-info"
    info.mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("meddling_agents.py"), site)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: meddling-agents\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[drivora_service.agents]\nmeddler = meddling_agents:meddler\n"
    )
    monkeypatch.syspath_prepend(str(site))
    importlib.invalidate_caches()


@pytest.mark.slow
def test_the_worker_is_replaced_and_the_next_run_is_judged_as_ever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    networks = NetworkCatalogue(shipped_networks())
    (seed,) = generate_seeds(
        networks.get("tee-town"), count=1, min_length=50, max_length=80, seed=3, agent="idm"
    )
    drive = validate_document(seed, networks, ("idm",)).scenario
    plain = RunSpec(run_id="before", document=canonical_json(replace(drive, max_sim_time=5.0)))
    install(tmp_path / "site", monkeypatch)
    specs = (plain, replace(plain, run_id="odd", agent="meddler"), replace(plain, run_id="after"))
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with LocalExecutor(slots=1, setup=setup, folder=tmp_path / "workers") as executor:
        found = {report.run_id: report for report in run_all(executor, specs)}
        (slot,) = executor.slots()
    before, odd, after = (found[spec.run_id] for spec in specs)
    assert odd.status is RunStatus.AGENT_FAILED
    assert odd.failure is not None
    assert odd.failure.cause == "agent_changed_service"
    assert "oracles.destination.Destination.judge" in odd.failure.message
    assert slot.restarts == 1
    assert after.status is RunStatus.FINISHED
    assert after.verdicts == before.verdicts
    assert after.trace_sha256 == before.trace_sha256
