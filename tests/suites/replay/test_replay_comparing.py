from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from drivora_service.observations.trace import Col, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.run_report import RunFailure, RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.runs.run_records import RunRecord
from drivora_service.suites.replay.replay_comparing import (
    Original,
    Recording,
    compare,
    explain_not_replayable,
    make_not_replayed,
)
from drivora_service.suites.replay.replay_records import ReplayOutcome
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace

STEPS = 40
TRACE = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=4.0))])
HASH = trace_sha256(TRACE)
NOTHING = Recording(lack="the run has no recording")


def run_of(run_id: str = "a", **changes: Any) -> RunRecord:
    """A run that has finished."""
    values: dict[str, Any] = {
        "id": run_id,
        "status": RunStatus.FINISHED,
        "cause": "",
        "label": "",
        "batch_id": "b",
        "item": 0,
        "town": "tee-town",
        "agent": "idm",
        "configuration": "idm",
        "configuration_id": "",
        "seed": None,
        "scenario_sha256": "",
        "created_at": datetime.now(UTC),
        "started_at": None,
        "ended_at": None,
        "cancel_requested": False,
        "attempts": 1,
        "violations": 0,
        "at_fault_violations": 0,
        "observations": 0,
        "failures": 0,
        "accountability": None,
        "steps": STEPS,
        "sim_time_s": 2.0,
        "wall_time_s": 0.1,
        "trace_sha256": HASH,
        "revision": 1,
        "simulation_sha256": HASH,
        "versions": {"drivora": "0.1.0", "libsumo": "1.20.0"},
    }
    return RunRecord(**{**values, **changes})


def moved(step: int) -> Trace:
    states = TRACE.states.copy()
    states[step:, 0, Col.X] += 1e-9
    return replace(TRACE, states=states)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, ""),
        ({"status": RunStatus.AGENT_FAILED, "simulation_sha256": "", "trace_sha256": ""}, ""),
        ({"trace_sha256": ""}, ""),
        ({"simulation_sha256": ""}, ""),
        ({"trace_sha256": "", "simulation_sha256": ""}, "the hash of its trace is not stored"),
        ({"status": RunStatus.RUNNING}, "it has not ended: it is running"),
        (
            {"status": RunStatus.INFRASTRUCTURE_FAILED, "cause": "worker_lost"},
            "it has no result to compare with, infrastructure failed (worker_lost)",
        ),
        (
            {"status": RunStatus.SIMULATOR_CRASHED, "cause": "quarantined"},
            "it has no result to compare with, simulator crashed (quarantined)",
        ),
        ({"status": RunStatus.SIMULATOR_CRASHED, "cause": "signal"}, ""),
    ],
)
def test_runs_without_a_result_are_not_replayed(changes: dict[str, Any], reason: str) -> None:
    original = Original(run=run_of(**changes))
    assert explain_not_replayable(original) == reason
    assert make_not_replayed(original, reason).outcome is ReplayOutcome.NOT_REPLAYED


def test_a_divergence_names_its_first_frame_and_what_explains_it() -> None:
    after = replace(moved(17), network_sha256="f" * 64)
    idm = {"ego": AgentChoice(name="idm", parameters={"speed_factor": 1.0})}
    slow = {"ego": AgentChoice(name="idm", parameters={"speed_factor": 0.9})}
    verdict = Verdict(oracle="speeding", ego="ego", outcome=Outcome.PASSED, message="")
    original = Original(run=run_of(agents=idm, verdicts=(verdict,)))
    again = run_of(
        "again",
        agents=slow,
        versions={"drivora": "0.1.0", "libsumo": "1.21.0", "numba": "0.60"},
        simulation_sha256=trace_sha256(after),
        verdicts=(replace(verdict, outcome=Outcome.VIOLATED),),
    )
    replay = compare(original, again, Recording(trace=TRACE), Recording(trace=after))
    assert replay.outcome is ReplayOutcome.DIVERGED
    assert replay.divergence is not None
    assert (replay.divergence.step, replay.divergence.actor) == (17, "ego")
    assert (replay.divergence.signal, replay.divergence.time) == ("x", TRACE.times[17])
    assert replay.divergence.original == TRACE.states[17, 0, Col.X]
    assert [fact.fact for fact in replay.facts] == ["network_sha256"]
    assert [(one.name, one.original, one.replayed) for one in replay.versions] == [
        ("libsumo", "1.20.0", "1.21.0"),
        ("agent of ego", 'idm {"speed_factor": 1.0}', 'idm {"speed_factor": 0.9}'),
        ("network tee-town", "0" * 64, "f" * 64),
        ("numba", "", "0.60"),
    ]
    (change,) = replay.verdicts
    assert (change.oracle, change.before, change.after) == ("speeding", "passed", "violated")


def test_the_network_of_a_campaign_stands_in_for_that_of_a_recording() -> None:
    original = Original(run=run_of(trace_sha256=""), network_sha256="e" * 64)
    replay = compare(original, run_of("again"), NOTHING, Recording(trace=TRACE))
    assert replay.outcome is ReplayOutcome.IDENTICAL
    assert [one.name for one in replay.versions] == ["network tee-town"]


def test_hashes_decide_where_frames_cannot_be_compared() -> None:
    original = Original(run=run_of(trace_sha256=""))
    same = compare(original, run_of("again"), NOTHING, Recording(trace=TRACE))
    assert same.outcome is ReplayOutcome.IDENTICAL
    assert "not the frames: the run has no recording" in same.reason
    again = run_of("again", simulation_sha256=trace_sha256(moved(3)))
    other = compare(original, again, NOTHING, Recording(trace=moved(3)))
    assert other.outcome is ReplayOutcome.DIVERGED
    assert other.divergence is None
    assert other.reason == (
        "the hashes of the traces differ; no frame and actor can be named: the run has no recording"
    )


def test_a_recording_that_is_not_the_one_of_the_hash_is_told() -> None:
    changed = Recording(lack="the file has another hash", is_damaged=True)
    replay = compare(Original(run=run_of()), run_of("again"), changed, Recording(trace=TRACE))
    assert replay.outcome is ReplayOutcome.DIVERGED
    # What is stored says nothing of the run, so no frame of it is named.
    assert replay.divergence is None
    assert replay.reason == (
        "the file has another hash; the hash of the replay is the one that was recorded"
    )
    wrong_hash = Original(run=run_of(simulation_sha256="e" * 64))
    replay = compare(wrong_hash, run_of("again"), Recording(trace=TRACE), Recording(trace=TRACE))
    assert replay.outcome is ReplayOutcome.DIVERGED
    assert replay.divergence is None
    assert replay.reason == "the hashes of the traces differ"


def test_a_replay_without_a_result_is_no_divergence() -> None:
    for status, cause in (
        (RunStatus.INFRASTRUCTURE_FAILED, "worker_lost"),
        (RunStatus.CANCELLED, ""),
        (RunStatus.SIMULATOR_CRASHED, "quarantined"),
    ):
        error = RunFailure(cause=cause, message="as it is") if cause else None
        again = run_of("again", status=status, cause=cause, error=error, simulation_sha256="")
        replay = compare(Original(run=run_of()), again, Recording(trace=TRACE), NOTHING)
        assert replay.outcome is ReplayOutcome.NOT_REPLAYED
        assert replay.replay is not None
        assert replay.reason.startswith("its replay has no result, ")
        assert replay.verdicts == ()


def test_failed_runs_are_the_same_by_status_and_cause() -> None:
    failed = {"status": RunStatus.AGENT_FAILED, "simulation_sha256": "", "trace_sha256": ""}
    raised = run_of(cause="agent_raised", **failed)
    replay = compare(Original(run=raised), replace(raised, id="again"), NOTHING, NOTHING)
    assert replay.outcome is ReplayOutcome.IDENTICAL
    hung = replace(raised, id="again", cause="agent_hung")
    replay = compare(Original(run=raised), hung, NOTHING, NOTHING)
    assert replay.outcome is ReplayOutcome.DIVERGED
    assert replay.reason.startswith(
        "it ended as agent failed (agent_raised), its replay as agent failed (agent_hung)"
    )


def test_not_finite_values_do_not_hide_a_divergence() -> None:
    values = TRACE.ego_values.copy()
    values[9, 0, 0] = np.nan
    after = replace(TRACE, ego_values=values)
    again = run_of("again", simulation_sha256=trace_sha256(after))
    replay = compare(Original(run=run_of()), again, Recording(trace=TRACE), Recording(trace=after))
    assert replay.divergence is not None
    assert (replay.divergence.original, replay.divergence.replayed) == (0.0, None)
