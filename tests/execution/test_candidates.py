"""What a worker makes of genes reaches its slot, whatever happens to the worker afterwards."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.candidate import CandidateSource
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.search.space.space_candidates import ScenarioCandidates
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.simulation.followers.free_motion import plan_motions
from drivora_service.worker.setup import WorkerSetup
from tests.search.space.seeds import NETWORKS, drawn, space_around

SPACE = space_around("tee-town", SpaceOptions(vehicles=1, walkers=0))
CANDIDATES = ScenarioCandidates(
    space=SPACE, networks=NETWORKS, agents=frozenset({"idm"}), motions=plan_motions
)
LIMITS = Limits(agent_deadline_s=2.0, wall_time_s=60.0)


@pytest.fixture(scope="module")
def executor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LocalExecutor]:
    with LocalExecutor(
        slots=1,
        setup=WorkerSetup(shipped_networks=shipped_networks()),
        folder=tmp_path_factory.mktemp("workers"),
        limits=LIMITS,
        perform="tests.execution.worker_tasks:perform_candidate",
        warm_up="",
    ) as started:
        yield started


def source(number: int) -> CandidateSource:
    return CandidateSource(space=CANDIDATES.source, values=tuple(drawn(SPACE, number).tolist()))


def end_of(executor: LocalExecutor, run_id: str, number: int) -> AttemptEnd:
    executor.submit(RunSpec(run_id=run_id, document="", candidate=source(number)))
    limit = time.monotonic() + 100.0
    while time.monotonic() < limit:
        for end in executor.wait(0.5):
            return end
    raise AssertionError("no end came")


@pytest.mark.parametrize(
    ("run_id", "status"),
    [
        ("returns 1", RunStatus.FINISHED),
        ("segfault 2", RunStatus.SIMULATOR_CRASHED),
        ("agent-hangs 3", RunStatus.AGENT_FAILED),
    ],
)
def test_the_scenario_is_known(executor: LocalExecutor, run_id: str, status: RunStatus) -> None:
    number = int(run_id.rpartition(" ")[2])
    end = end_of(executor, run_id, number)
    assert end.report.status is status
    assert end.candidate is not None
    expected = CANDIDATES.prepare(drawn(SPACE, number))
    assert replace(end.candidate, prepare_s=0.0) == replace(expected, prepare_s=0.0)
    assert json.loads(end.candidate.document)["ego_vehicles"]


def test_a_forged_scenario_ends_the_worker(executor: LocalExecutor) -> None:
    end = end_of(executor, "forges 1", 1)
    assert end.report.failure is not None
    assert end.report.failure.cause == "worker_protocol"
    assert end.candidate is None


def test_a_run_without_genes_has_none(executor: LocalExecutor) -> None:
    assert end_of(executor, "returns 1", 1).candidate is not None
    executor.submit(RunSpec(run_id="returns 1", document="returns"))
    (end,) = executor.wait(100.0)
    assert end.report.status is RunStatus.FINISHED
    assert end.candidate is None
