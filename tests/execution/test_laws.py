"""Laws in the workers: they judge every run, and a file that cannot be used stops judging."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.laws.library import LawLibrary
from drivora_service.oracles.laws.sources import LawSource, read_law_sources
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.settings import Settings
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker_settings import worker_setup
from tests.oracles.laws.laws import source_of


@pytest.fixture(scope="module")
def spec() -> RunSpec:
    """A drive of ten seconds."""
    networks = NetworkCatalogue(shipped_networks())
    (seed,) = generate_seeds(
        networks.get("tee-town"), count=1, min_length=50, max_length=80, seed=3, agent="idm"
    )
    drive = validate_document(seed, networks, ("idm",)).scenario
    return RunSpec(run_id="law", document=canonical_json(replace(drive, max_sim_time=10.0)))


def setup_with(*laws: LawSource) -> WorkerSetup:
    return WorkerSetup(shipped_networks=shipped_networks(), laws=laws)


def test_laws_judge_every_run_and_a_users_file_is_in_its_versions(spec: RunSpec) -> None:
    plain = perform(spec, setup_with())
    judged = perform(spec, setup_with(source_of("speed < 2")))
    shipped = set(LawLibrary().names())
    assert shipped <= {verdict.oracle for verdict in plain.verdicts}
    assert judged.verdicts[:-1] == plain.verdicts
    own = judged.verdicts[-1]
    assert (own.oracle, own.outcome) == ("own_law", Outcome.VIOLATED)
    assert "laws/own.yaml" in judged.versions
    assert "laws/own.yaml" not in plain.versions
    assert judged.metrics == plain.metrics


def test_a_file_that_cannot_be_used_ends_runs_before_they_are_simulated(spec: RunSpec) -> None:
    report = perform(spec, setup_with(source_of("sped < 2")))
    assert report.status is RunStatus.PLUGIN_FAILED
    assert report.failure is not None
    assert report.failure.cause == "law_file"
    assert "own.yaml:7:22: unknown name 'sped'" in report.failure.message
    assert report.steps == 0


def test_the_folder_of_laws_is_a_setting(tmp_path: Path) -> None:
    (tmp_path / "laws").mkdir()
    (tmp_path / "laws" / "own.yaml").write_bytes(source_of("speed < 2").data)
    assert worker_setup(Settings(data_dir=tmp_path)).laws == read_law_sources(tmp_path / "laws")
    elsewhere = Settings(data_dir=tmp_path / "data", laws_dir=tmp_path / "laws")
    assert [source.file for source in worker_setup(elsewhere).laws] == ["own.yaml"]
    assert worker_setup(Settings(data_dir=tmp_path / "none")).laws == ()


@pytest.mark.slow
def test_worker_processes_judge_by_the_users_laws(spec: RunSpec, tmp_path: Path) -> None:
    reports: list[RunReport] = []
    for slots in (1, 2):
        setup = setup_with(source_of("speed < 2"))
        with LocalExecutor(slots=slots, setup=setup, folder=tmp_path / f"{slots}") as executor:
            specs = [replace(spec, run_id=f"law-{k}") for k in range(2)]
            reports += list(run_all(executor, specs))
    assert len({report.trace_sha256 for report in reports}) == 1
    assert len({str(report.verdicts) for report in reports}) == 1
    assert reports[0].verdicts[-1].oracle == "own_law"
