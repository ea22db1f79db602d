"""Runs of genes in the queue: the worker's scenario becomes that of the run when it ends."""

from __future__ import annotations

import contextlib
import hashlib
import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.campaigns.evaluation.queue_evaluator import QueueEvaluator
from drivora_service.errors import Conflict
from drivora_service.runs.adversary import AdversarySource
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.candidate import Candidate, CandidateSource, SpaceSource
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import RunSummary
from drivora_service.store.traces.trace_places import TracePlaces
from tests.campaigns.evaluation.test_queue_evaluator import again, campaign
from tests.store.samples import crashed, ended, finish, finished, lost, no_trace, register

SOURCE = CandidateSource(
    space=SpaceSource(seed='{"seed":1}', options='{"vehicles":3}'), values=(0.1, 1 / 3, -2e-9)
)
SPEC = RunSpec(run_id="campaign-0", document="", candidate=SOURCE)
DECODED = Candidate(values=(0.1, 0.5, 0.0), document='{"decoded":1}', prepare_s=0.02)


@pytest.fixture
def evaluate(database: Database, tmp_path: Path) -> QueueEvaluator:
    return QueueEvaluator(database, campaign(database), TracePlaces.below(tmp_path))


def claimed(database: Database, owner: str) -> tuple[RunSpec, ...]:
    with database.write() as transaction:
        return transaction.queue.claim(owner, 5, trace_path=no_trace)


def job(database: Database) -> tuple[RunSummary, str]:
    with database.read() as transaction:
        return transaction.jobs.get("campaign-0"), transaction.jobs.document("campaign-0")


def with_candidate(end: AttemptEnd, candidate: Candidate = DECODED) -> AttemptEnd:
    return replace(end, candidate=candidate)


def test_genes_reach_the_worker_and_the_scenario_comes_back(
    database: Database, evaluate: QueueEvaluator
) -> None:
    evaluate.submit([(0, SPEC)])
    assert job(database)[1] == SOURCE.space.seed
    owner = register(database)
    assert claimed(database, owner) == (SPEC,)
    finish(database, owner, with_candidate(finished("campaign-0", "collision")))
    (answer,) = evaluate.wait(60.0)
    assert answer.candidate == DECODED
    assert answer.report.status is RunStatus.FINISHED
    summary, document = job(database)
    assert document == DECODED.document
    assert summary.scenario_sha256 == hashlib.sha256(document.encode()).hexdigest()


def test_an_invalid_candidate_keeps_the_seed_scenario(
    database: Database, evaluate: QueueEvaluator
) -> None:
    invalid = Candidate(values=DECODED.values, problem="/ego: too near", prepare_s=0.01)
    failure = RunFailure(cause="invalid_document", message=invalid.problem)
    evaluate.submit([(0, SPEC)])
    owner = register(database)
    claimed(database, owner)
    report = RunReport(run_id="campaign-0", status=RunStatus.INVALID, failure=failure)
    finish(database, owner, with_candidate(ended(report), invalid))
    (answer,) = evaluate.wait(60.0)
    assert answer.candidate == invalid
    assert job(database)[1] == SOURCE.space.seed


def test_a_crash_is_tried_again_with_the_genes_and_its_scenario_is_quarantined(
    database: Database, evaluate: QueueEvaluator
) -> None:
    evaluate.submit([(0, SPEC)])
    owner = register(database)
    for attempt in (1, 2):
        assert claimed(database, owner) == (replace(SPEC, attempt=attempt),)
        finish(database, owner, with_candidate(crashed("campaign-0")))
    (answer,) = evaluate.wait(60.0)
    assert answer.report.status is RunStatus.SIMULATOR_CRASHED
    assert answer.candidate == DECODED
    with database.read() as transaction:
        (record,) = transaction.quarantine.newest()
    assert record.scenario_sha256 == job(database)[0].scenario_sha256


def test_a_run_that_was_lost_is_repeated_with_its_genes(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    evaluate.submit([(0, SPEC)])
    owner = register(database)
    for _ in range(3):
        claimed(database, owner)
        finish(database, owner, with_candidate(lost("campaign-0")))
    successor = again(database, tmp_path)
    successor.submit([(0, SPEC)])
    assert job(database)[1] == SOURCE.space.seed
    assert claimed(database, owner) == (replace(SPEC, attempt=4),)


def test_a_run_that_has_ended_is_known_by_its_genes(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    evaluate.submit([(0, SPEC)])
    owner = register(database)
    claimed(database, owner)
    finish(database, owner, with_candidate(finished("campaign-0")))
    successor = again(database, tmp_path)
    successor.submit([(0, SPEC)])
    (answer,) = successor.wait(60.0)
    assert answer.candidate == DECODED


def test_a_run_of_other_genes_is_no_answer(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    evaluate.submit([(0, SPEC)])
    owner = register(database)
    claimed(database, owner)
    others = (
        replace(SOURCE, values=(0.1, 1 / 3, 0.0)),
        replace(SOURCE, space=replace(SOURCE.space, seed='{"seed":2}')),
        replace(SOURCE, space=replace(SOURCE.space, options="{}")),
    )
    for other in others:
        with pytest.raises(Conflict, match="is running with another scenario"):
            again(database, tmp_path).submit([(0, replace(SPEC, candidate=other))])
    finish(database, owner, with_candidate(finished("campaign-0")))
    for other in others:
        successor = again(database, tmp_path)
        successor.submit([(0, replace(SPEC, candidate=other))])
        assert successor.wait(0.0) == ()
        (spec,) = claimed(database, owner)
        assert spec.candidate == other
        finish(database, owner, with_candidate(finished("campaign-0")))


ADVERSARY = AdversarySource(policy="A" * 4000, exploration=0.25, seed=7, interval=6.0)
PLAYED = replace(SPEC, candidate=replace(SOURCE, adversary=ADVERSARY))


def stored_candidate(tmp_path: Path) -> str:
    with contextlib.closing(sqlite3.connect(tmp_path / "drivora.sqlite3")) as connection:
        ((text,),) = connection.execute("SELECT candidate FROM runs")
    return str(text)


def test_an_adversary_reaches_the_worker_and_its_policy_is_not_kept(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    evaluate.submit([(0, PLAYED)])
    owner = register(database)
    assert claimed(database, owner) == (PLAYED,)
    assert ADVERSARY.policy in stored_candidate(tmp_path)
    finish(database, owner, with_candidate(finished("campaign-0", "collision")))
    (answer,) = evaluate.wait(60.0)
    assert answer.candidate == DECODED
    assert ADVERSARY.policy not in stored_candidate(tmp_path)
    assert hashlib.sha256(ADVERSARY.policy.encode()).hexdigest() in stored_candidate(tmp_path)


def test_a_resumed_campaign_finds_the_run_of_its_adversary(
    database: Database, evaluate: QueueEvaluator, tmp_path: Path
) -> None:
    evaluate.submit([(0, PLAYED)])
    owner = register(database)
    claimed(database, owner)
    finish(database, owner, with_candidate(finished("campaign-0", "collision")))
    assert evaluate.wait(60.0)
    resumed = again(database, tmp_path)
    resumed.submit([(0, PLAYED)])
    assert claimed(database, owner) == ()
    (answer,) = resumed.wait(60.0)
    assert answer.candidate == DECODED
    # Another policy is another run.
    other = replace(ADVERSARY, policy="B" * 4000)
    changed = again(database, tmp_path)
    changed.submit([(0, replace(PLAYED, candidate=replace(SOURCE, adversary=other)))])
    (spec,) = claimed(database, owner)
    assert spec.candidate is not None
    assert spec.candidate.adversary == other
