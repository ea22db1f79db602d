"""The real simulator on the slots: judged runs, the same everywhere, beside runs that crash it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
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


@pytest.fixture(scope="module")
def documents() -> list[str]:
    """Six drives through tee-town."""
    networks = NetworkCatalogue(shipped_networks())
    seeds = generate_seeds(
        networks.get("tee-town"), count=6, min_length=50, max_length=120, seed=3, agent="idm"
    )
    return [canonical_json(validate_document(s, networks, ("idm",)).scenario) for s in seeds]


@contextlib.contextmanager
def executor(folder: Path, slots: int) -> Iterator[LocalExecutor]:
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with LocalExecutor(slots=slots, setup=setup, folder=folder / "workers") as started:
        yield started


def by_id(reports: Iterator[RunReport]) -> dict[str, RunReport]:
    return {report.run_id: report for report in reports}


@pytest.mark.slow
def test_results_do_not_depend_on_slots_or_order(documents: list[str], tmp_path: Path) -> None:
    specs = [
        RunSpec(run_id=str(n), document=text, trace_path=str(tmp_path / f"{n}.parquet"))
        for n, text in enumerate(documents)
    ]
    with executor(tmp_path, 1) as one:
        first = by_id(run_all(one, specs))
    with executor(tmp_path, 2) as two:
        second = by_id(run_all(two, reversed(specs)))
    assert {report.status for report in first.values()} == {RunStatus.FINISHED}
    assert all(report.verdicts for report in first.values())
    hashes = {run_id: report.trace_sha256 for run_id, report in first.items()}
    assert hashes == {run_id: report.trace_sha256 for run_id, report in second.items()}
    assert len(set(hashes.values())) == len(documents)
    assert all((tmp_path / f"{n}.parquet").stat().st_size for n in range(len(documents)))


@pytest.mark.slow
def test_a_missing_town_makes_the_run_invalid(documents: list[str], tmp_path: Path) -> None:
    moved = documents[0].replace("tee-town", "no-town")
    with executor(tmp_path, 1) as one:
        (report,) = run_all(one, [RunSpec(run_id="run", document=moved)])
    assert report.status is RunStatus.INVALID
    assert report.failure is not None
    assert "no-town" in report.failure.message
