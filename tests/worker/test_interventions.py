"""Runs with an adversary: what the worker leaves is the scenario that was driven."""

from __future__ import annotations

import pkgutil
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.adversary import (
    DECISIONS,
    EXTENSION,
    OBSERVATION_SIZE,
    OBSERVATIONS,
    AdversarySource,
)
from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.model import Scenario
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.source import source_of
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.worker.candidate_preparing import prepare
from drivora_service.worker.channel import LONGEST_BODY
from drivora_service.worker.interventions import leave_scenario
from drivora_service.worker.loop import PREPARE, WorkerTask, _report
from drivora_service.worker.performing import perform
from drivora_service.worker.progress_board import BoardReader, ProgressBoard
from drivora_service.worker.setup import WorkerSetup
from drivora_service.worker.worker_messages import candidate_of
from tests.adversaries.games import alone

SETUP = WorkerSetup(shipped_networks=shipped_networks())
FEW = SpaceOptions(vehicles=1, walkers=0)
TASK = WorkerTask(
    perform="drivora_service.worker.performing:perform", warm_up="", setup=SETUP, prepare=PREPARE
)


def source_for(
    seed: int,
    what: Scenario | None = None,
    options: SpaceOptions = FEW,
) -> CandidateSource:
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    space = ScenarioSpace(what or alone(), network, options)
    values = tuple(space.genes.from_unit(np.full(len(space.genes), 0.1)).tolist())
    adversary = AdversarySource(policy="", exploration=1.0, seed=seed, interval=3.0)
    return CandidateSource(space=source_of(space), values=values, adversary=adversary)


def performed(source: CandidateSource) -> tuple[RunReport, Candidate | None]:
    """Performs a run as the loop of a worker does, and reads its board."""
    reader = BoardReader()
    spec = RunSpec(
        run_id="run", document="", candidate=source, feedback=FeedbackChoice(name="deepcollision")
    )
    do = pkgutil.resolve_name(TASK.perform)
    report = _report(spec, do, TASK, ProgressBoard(reader.fileno()))
    found = candidate_of(reader.note(LONGEST_BODY), source, "run")
    reader.close()
    return report, found


@pytest.mark.parametrize("seed", [1, 4])
def test_the_scenario_on_the_board_is_the_run_without_the_adversary(seed: int) -> None:
    report, candidate = performed(source_for(seed))
    assert report.status is RunStatus.FINISHED, report.failure
    assert candidate is not None
    scenario = from_canonical(candidate.document)
    assert scenario.extensions[EXTENSION]
    again = perform(RunSpec(run_id="again", document=candidate.document), SETUP)
    assert again.trace_sha256 == report.trace_sha256
    assert again.verdicts == report.verdicts


def test_what_was_decided_is_measured_beside_the_feedback() -> None:
    report, candidate = performed(source_for(1))
    assert report.measurement is not None
    assert candidate is not None
    assert list(report.measurement.objectives) == ["safety"]
    decisions = report.measurement.features[DECISIONS]
    views = np.array(report.measurement.features[OBSERVATIONS])
    assert views.shape == (len(decisions) + 1, OBSERVATION_SIZE)
    assert report.sim_time_s <= 3.0 * len(decisions) + 1e-6
    told = from_canonical(candidate.document).extensions[EXTENSION]
    assert len(told) <= len(decisions)


def test_the_same_adversary_does_the_same_in_every_worker() -> None:
    one, other = performed(source_for(2)), performed(source_for(2))
    assert one[0].trace_sha256 == other[0].trace_sha256
    assert one[1] is not None
    assert other[1] is not None
    assert one[1].document == other[1].document
    assert performed(source_for(3))[0].trace_sha256 != one[0].trace_sha256


def test_with_an_adversary_no_gene_is_without_effect() -> None:
    """What it does depends on all that it sees, and what it adds may meet any actor."""
    options = SpaceOptions(vehicles=2, walkers=1, patches=2, optional=True)
    source = source_for(2, options=options)
    report, candidate = performed(source)
    assert report.status is RunStatus.FINISHED, report.failure
    assert report.without_effect == ()
    assert candidate is not None
    assert from_canonical(candidate.document).extensions[EXTENSION]
    # Without one, the genes of absent actors and patches are.
    report, _ = performed(replace(source, adversary=None))
    assert report.status is RunStatus.FINISHED, report.failure
    assert len(report.without_effect) > 20


def test_the_scenario_so_far_is_left_for_runs_that_the_process_does_not_survive() -> None:
    source = source_for(4)
    reader = BoardReader()
    board = ProgressBoard(reader.fileno())
    prepared = prepare(source, SETUP)
    spec = RunSpec(run_id="run", document="", candidate=source, prepared=prepared)
    added = replace(from_canonical(prepared.document), seed=77)
    leave_scenario(board, spec, added)
    left = candidate_of(reader.note(LONGEST_BODY), source, "run")
    assert left == replace(prepared, document=canonical_json(added))
    # Without a board, and for runs of documents, there is nothing to leave.
    leave_scenario(None, spec, added)
    leave_scenario(board, RunSpec(run_id="other", document="{}"), added)
    assert candidate_of(reader.note(LONGEST_BODY), source, "run") == left
    reader.close()


def test_a_policy_that_cannot_be_read_fails_the_run() -> None:
    source = source_for(1)
    assert source.adversary is not None
    bad = replace(source, adversary=replace(source.adversary, policy="AAAA", exploration=0.0))
    report, _ = performed(bad)
    assert report.status is RunStatus.INVALID
    assert report.failure is not None
    assert "policy" in report.failure.message
