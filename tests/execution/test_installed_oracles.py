"""Oracles of packages in the workers: they judge, and their errors affect only their runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.worker.setup import WorkerSetup
from tests.oracles.installing import install_oracles


@pytest.fixture(scope="module")
def document() -> str:
    """A drive of ten seconds."""
    networks = NetworkCatalogue(shipped_networks())
    (seed,) = generate_seeds(
        networks.get("tee-town"), count=1, min_length=50, max_length=80, seed=3, agent="idm"
    )
    drive = validate_document(seed, networks, ("idm",)).scenario
    return canonical_json(replace(drive, max_sim_time=10.0))


def reports(folder: Path, *specs: RunSpec) -> tuple[list[RunReport], int]:
    """Runs on one worker; returns the reports in order and the number of replacements."""
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with LocalExecutor(slots=1, setup=setup, folder=folder / "workers") as executor:
        found = {report.run_id: report for report in run_all(executor, specs)}
        (slot,) = executor.slots()
    return [found[spec.run_id] for spec in specs], slot.restarts


@pytest.mark.slow
def test_a_broken_oracle_fails_its_run_and_no_other(
    document: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = RunSpec(run_id="plain", document=document)
    (expected,), _ = reports(tmp_path, plain)
    install_oracles(tmp_path / "site", monkeypatch, "moody")
    specs = [
        RunSpec(
            run_id=name,
            document=document.replace('"ego_0"', f'"{name}"'),
            trace_path=str(tmp_path / f"{name}.parquet"),
        )
        for name in ("raises", "leaves", "nothing", "code", "writes")
    ]
    (raised, left, empty, odd, wrote, fine), restarts = reports(
        tmp_path, *specs, replace(plain, run_id="fine")
    )
    # A failed run may have changed the worker's state, and the next run gets a new worker.
    assert restarts == 4

    assert fine.status is RunStatus.FINISHED
    assert fine.verdicts[:-1] == expected.verdicts
    assert (fine.verdicts[-1].oracle, fine.verdicts[-1].ego) == ("moody", "ego_0")
    assert type(fine.verdicts[-1].evidence["top"]) is float
    assert (fine.metrics, fine.scores) == (expected.metrics, expected.scores)
    assert fine.trace_sha256 == expected.trace_sha256

    for report, cause, said in (
        (raised, "oracle_raised", "raised ZeroDivisionError: in a bad mood"),
        (left, "oracle_raised", "raised SystemExit: 3"),
        (empty, "oracle_invalid_verdict", "answered a NoneType"),
        (odd, "oracle_invalid_verdict", "a report cannot hold a function"),
    ):
        assert report.status is RunStatus.PLUGIN_FAILED
        assert report.failure is not None
        assert report.failure.cause == cause
        assert "oracle 'moody' of the package 'foreign-oracles'" in report.failure.message
        assert said in report.failure.message
        assert not report.verdicts
        assert not report.metrics
        # The recording is kept for inspection.
        assert report.trace_sha256
        assert report.steps == expected.steps
        assert (tmp_path / f"{report.run_id}.parquet").is_file()
    assert raised.failure is not None
    assert "foreign_oracles.py" in raised.failure.log

    # An oracle that writes into the trace does not affect the input of the others.
    assert wrote.status is RunStatus.FINISHED
    assert wrote.metrics == expected.metrics
    assert wrote.verdicts[:-1] == tuple(
        replace(verdict, ego="writes") for verdict in expected.verdicts
    )


@pytest.mark.slow
def test_an_oracle_that_cannot_be_loaded_fails_runs_before_they_are_simulated(
    document: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path / "site", monkeypatch, "gone = oracles_that_are_gone:plugin")
    specs = [RunSpec(run_id=name, document=document) for name in ("one", "two")]
    found, _ = reports(tmp_path, *specs)
    for report in found:
        assert report.status is RunStatus.PLUGIN_FAILED
        assert report.failure is not None
        assert report.failure.cause == "oracle_plugin"
        assert "oracle 'gone' of the package 'foreign-oracles'" in report.failure.message
        assert "No module named 'oracles_that_are_gone'" in report.failure.message
        assert report.steps == 0
