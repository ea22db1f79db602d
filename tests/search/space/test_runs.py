"""Decoded scenarios run to their end, as workers run them."""

from __future__ import annotations

from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.worker.performing import perform
from drivora_service.worker.setup import WorkerSetup
from tests.search.space.seeds import drawn, space_around

SETUP = WorkerSetup(shipped_networks=shipped_networks())


def reports(space: ScenarioSpace, count: int) -> list[RunReport]:
    documents = [canonical_json(space.scenario(drawn(space, number))) for number in range(count)]
    return [
        perform(RunSpec(run_id=f"run-{number}", document=document), SETUP)
        for number, document in enumerate(documents)
    ]


def test_samples_run_to_their_end() -> None:
    for town in ("tee-town", "signal-grid", "roundabout"):
        for report in reports(space_around(town), 4):
            assert report.status is RunStatus.FINISHED
            # No collision was unavoidable from the start.
            assert report.sim_time_s > 3.0


def test_several_egos_run_to_their_end() -> None:
    options = SpaceOptions(egos=3, vehicles=2, walkers=1, obstacles=1, lights=True)
    for report in reports(space_around("tee-town", options), 3):
        assert report.status is RunStatus.FINISHED
        assert {verdict.ego for verdict in report.verdicts} >= {"ego_0", "ego_1"}


def test_what_differs_in_its_genes_differs_in_what_happens() -> None:
    hashes = [report.trace_sha256 for report in reports(space_around("tee-town"), 4)]
    assert len(set(hashes)) == len(hashes)
    assert hashes == [report.trace_sha256 for report in reports(space_around("tee-town"), 4)]
