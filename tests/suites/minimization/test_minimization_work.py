"""What a minimisation takes over from a process that has ended, and when it has ended itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.observations.trace_files.trace_file import write_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.scenario.documents import document_text, parse_document
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.minimizations.minimization_repository import ActiveMinimization
from drivora_service.suites.minimization.minimization_work import Work
from drivora_service.suites.minimization.minimizer import Purpose
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace
from tests.store.samples import finished, new_minimization
from tests.suites.minimization.synthetic import checker


def make_work(tmp_path: Path, original: RunReport | None = None) -> Work:
    """A minimisation of a scenario that no run of these tests lets fail."""
    active = ActiveMinimization(
        id="m" * 24,
        run_id="r" * 24,
        batch_id="b" * 24,
        failure=new_minimization().failure,
        budget=10,
        document=document_text(parse_document(SCENARIO)),
    )
    return Work(
        active, checker(), AgentCatalogue(), lambda run_id: tmp_path / run_id, original=original
    )


@pytest.fixture
def work(tmp_path: Path) -> Work:
    """A minimisation of a run of which nothing is known any more."""
    return make_work(tmp_path)


def cancelled(run_id: str) -> RunReport:
    return RunReport(run_id=run_id, status=RunStatus.CANCELLED)


def message(work: Work) -> str:
    """How it has ended, "" while it goes on."""
    return "" if work.end is None else f"{work.end.state}: {work.end.message}"


def test_runs_that_are_not_needed_any_more_count_before_the_end(work: Work) -> None:
    (wanted,) = work.choose_runs(2)
    assert wanted.run_id is not None
    work.resume([finished(wanted.run_id).report], ["ahead"])
    assert work.choose_runs(2) == ()
    assert message(work) == ""
    work.take(finished("ahead").report)
    assert message(work).startswith("failed: the scenario")
    assert "does not fail in the same way" in message(work)
    assert work.progress.simulations == 2


@pytest.mark.parametrize(
    ("now", "words"),
    [
        (
            {"versions": {"follow-driver": "0.2", "numpy": "2"}},
            "What has changed since: version of follow-driver: 0.1, now 0.2",
        ),
        (
            {"versions": {"numpy": "2"}},
            "What has changed since: version of follow-driver: 0.1, now none",
        ),
        (
            {"agents": {"ego": AgentChoice(name="idm", parameters={"headway": 2.0})}},
            'version of agent of ego: idm {"headway": 1.0}, now idm {"headway": 2.0}',
        ),
        ({}, "No software has changed since: the failure is flaky"),
        (
            {
                "status": RunStatus.PLUGIN_FAILED,
                "failure": RunFailure(cause="oracle_raised", message="oracle 'own' raised"),
            },
            "The run ended as plugin failed: oracle 'own' raised",
        ),
    ],
)
def test_why_a_failure_did_not_come_again_is_named(
    tmp_path: Path, now: dict[str, Any], words: str
) -> None:
    before = RunReport(
        run_id="r" * 24,
        status=RunStatus.FINISHED,
        versions={"follow-driver": "0.1", "numpy": "2"},
        agents={"ego": AgentChoice(name="idm", parameters={"headway": 1.0})},
    )
    work = make_work(tmp_path, before)
    (wanted,) = work.choose_runs(2)
    assert wanted.run_id is not None
    work.take(replace(before, run_id=wanted.run_id, **now))
    assert work.choose_runs(2) == ()
    assert message(work).endswith(words)


def test_runs_that_were_cancelled_with_their_process_are_made_again(work: Work) -> None:
    (wanted,) = work.choose_runs(2)
    assert wanted.run_id is not None
    work.resume([cancelled(f"{number}") for number in range(5)], [])
    assert [run.run_id for run in work.choose_runs(2)] == [wanted.run_id]
    assert message(work) == ""


def test_what_is_lost_and_not_needed_any_more_does_no_harm(work: Work) -> None:
    (wanted,) = work.choose_runs(2)
    assert wanted.run_id is not None
    work.resume([finished(wanted.run_id).report], [f"{number}" for number in range(3)])
    assert work.choose_runs(2) == ()
    for number in range(3):
        assert message(work) == ""
        work.take(cancelled(f"{number}"))
    assert "does not fail in the same way" in message(work)


def test_runs_that_are_lost_again_and_again_end_it(work: Work) -> None:
    for number in range(3):
        assert message(work) == ""
        work.take(cancelled(f"{number}"))
    assert work.choose_runs(2) == ()
    assert message(work) == "failed: run 2 could not be performed"


def test_only_the_recorded_trace_of_a_run_has_its_motions(work: Work, tmp_path: Path) -> None:
    run_id = f"{work.id}-0{Purpose.OBSERVE}"
    trace = make_trace([SyntheticEgo(motion=Motion.along([0.0, 1.0, 2.0, 3.0], 0.0))])
    other = make_trace([SyntheticEgo(motion=Motion.along([0.0, 1.5, 3.0, 4.5], 0.0))])
    report = RunReport(run_id=run_id, status=RunStatus.FINISHED, trace_sha256=trace_sha256(trace))
    assert work._read_recording(report) is None
    write_trace(trace, tmp_path / run_id)
    assert work._read_recording(report) is not None
    write_trace(other, tmp_path / run_id)
    assert work._read_recording(report) is None
