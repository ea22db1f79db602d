"""Reports go through the channel whole, or as a failure that says why."""

from __future__ import annotations

import math
import socket
import time
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.feedback.measurement import Measurement
from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.runs.candidate import Candidate, CandidateSource, SpaceSource
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.worker import channel
from drivora_service.worker.channel import (
    Channel,
    ChannelClosedError,
    Frame,
    Kind,
    ProtocolError,
    receive,
    send,
)
from drivora_service.worker.worker_messages import (
    Ended,
    Leftovers,
    NotReady,
    Started,
    candidate_of,
    frame_of,
    frame_of_report,
    is_of_finished_run,
    message_of,
    note_of_candidate,
    report_of,
)

REPORT = RunReport(
    run_id="run",
    status=RunStatus.FINISHED,
    verdicts=(
        Verdict(
            oracle="collision",
            ego="ego",
            outcome=Outcome.VIOLATED,
            message="hit a wall — “hard”",
            severity=Severity.CRITICAL,
            at_fault=True,
            avoidable=Answer.NOT_MEASURABLE,
            time=1.1,
            step=22,
            location=(0.1 + 0.2, -1e-300),
            counterpart="npc",
            evidence={"speed": 1 / 3, "cycle": ["a", "b"], "deep": {"none": None}},
        ),
    ),
    metrics={"driving_score": 2 / 3, "unknown": None},
    scores={"distance": 5e-324},
    measurement=Measurement(
        objectives={"gap": None, "ttc": 0.1}, features={"path": ((0.1, 2.0), (1e22, -0.0))}
    ),
    trace_sha256="0" * 64,
    steps=23,
    sim_time_s=1.1,
    wall_time_s=0.5,
    agent_cost_us={"ego": 3.25},
    privileged=("ego",),
    agents={"ego": AgentChoice(name="idm", parameters={"headway": 1.5, "modes": ["a"]})},
    versions={"drivora": "0.1.0"},
)


def through(report: RunReport) -> RunReport:
    return report_of(frame_of_report(report), report.run_id)


def test_a_report_comes_back_as_it_was() -> None:
    assert through(REPORT) == REPORT


def test_what_json_has_not_becomes_plain() -> None:
    evidence = {"tuple": (1, 2), "nan": math.nan, "array": np.array([0.5, 1.5])}
    verdict = replace(REPORT.verdicts[0], evidence=evidence)
    (found,) = through(replace(REPORT, verdicts=(verdict,))).verdicts
    assert found.evidence == {"tuple": [1, 2], "nan": None, "array": [0.5, 1.5]}


def test_a_message_that_is_no_text_costs_no_failure_its_cause() -> None:
    failure = RunFailure(cause="agent_raised", message="no file \udcff", log="\ud800")
    report = RunReport(run_id="run", status=RunStatus.AGENT_FAILED, failure=failure)
    found = through(report)
    assert found.status is RunStatus.AGENT_FAILED
    assert found.failure == RunFailure(cause="agent_raised", message="no file ?", log="?")


def test_a_report_that_cannot_be_sent_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    verdict = replace(REPORT.verdicts[0], evidence={"what": object()})
    found = through(replace(REPORT, verdicts=(verdict,)))
    assert found.failure is not None
    assert (found.status, found.failure.cause) == (
        RunStatus.INFRASTRUCTURE_FAILED,
        "unwritable_report",
    )
    assert "object" in found.failure.message
    monkeypatch.setattr("drivora_service.worker.worker_messages.LONGEST_BODY", 500)
    found = through(REPORT)
    assert found.failure is not None
    assert "bytes; allowed: 500" in found.failure.message


@pytest.mark.parametrize(
    ("report", "problem"),
    [
        (replace(REPORT, status=RunStatus.CANCELLED), "no worker reports"),
        (replace(REPORT, status=RunStatus.AGENT_FAILED), "and no failure"),
        (replace(REPORT, steps=-1), "-1 steps"),
        (replace(REPORT, trace_sha256="../../etc"), "the hash"),
        (
            replace(
                REPORT,
                status=RunStatus.INVALID,
                failure=RunFailure(cause="c" * 41, message=""),
            ),
            "the cause",
        ),
        (
            replace(REPORT, verdicts=(replace(REPORT.verdicts[0], step=2**40),)),
            "a verdict at step",
        ),
    ],
)
def test_reports_that_no_worker_sends_are_refused(report: RunReport, problem: str) -> None:
    with pytest.raises(ProtocolError, match=problem):
        through(report)


def test_infinite_numbers_are_refused() -> None:
    body = frame_of_report(REPORT).body.replace(b'"sim_time_s":1.1', b'"sim_time_s":Infinity')
    with pytest.raises(ProtocolError, match="sim_time_s"):
        report_of(Frame(Kind.REPORT, body), "run")


@pytest.mark.parametrize(
    "message",
    [
        NotReady(reason="no library"),
        Started(pid=12),
        Ended(exit_code=-11),
        Leftovers(names=("sleep (3)",)),
    ],
)
def test_other_messages_come_back(message: NotReady | Started | Ended | Leftovers) -> None:
    assert message_of(frame_of(message)) == message


def test_other_messages_are_checked() -> None:
    with pytest.raises(ProtocolError, match="not as agreed"):
        message_of(Frame(Kind.STARTED, b'{"pid": "none"}'))
    with pytest.raises(ProtocolError, match="was not expected"):
        message_of(Frame(Kind.RUN, b"{}"))


def test_messages_come_in_any_pieces() -> None:
    ours, theirs = socket.socketpair()
    reading = Channel(ours)
    other, copy = socket.socketpair()
    send(other, Frame(Kind.REPORT, b"first"))
    send(other, Frame(Kind.READY))
    for byte in copy.recv(1000):
        assert reading.read() is None
        theirs.sendall(bytes([byte]))
        frame = reading.read()
        if frame is not None:
            break
    assert frame == Frame(Kind.REPORT, b"first")
    for end in (reading, theirs, other, copy):
        end.close()


def test_messages_that_came_together_are_told_of() -> None:
    ours, theirs = socket.socketpair()
    reading = Channel(ours)
    send(theirs, Frame(Kind.REPORT, b"first"))
    send(theirs, Frame(Kind.READY))
    told = [reading.has_message]
    assert reading.read() == Frame(Kind.REPORT, b"first")
    # The socket itself has nothing more to read: a wait for it would be in vain.
    told.append(reading.has_message)
    assert reading.read() == Frame(Kind.READY, b"")
    assert [*told, reading.has_message] == [False, True, False]
    reading.close()
    theirs.close()


def test_nothing_is_waited_for() -> None:
    ours, theirs = socket.socketpair()
    writing = Channel(ours)
    begun = time.monotonic()
    length = 8 << 20
    writing.put(Frame(Kind.RUN, b"x" * length))
    assert time.monotonic() - begun < 5.0
    theirs.setblocking(False)
    got = 0
    while got < length:
        got += len(theirs.recv(1 << 20))
        writing.flush()
    assert not writing.has_more_to_send
    theirs.close()
    with pytest.raises(ChannelClosedError):
        writing.read()
    writing.close()


def test_a_message_that_does_not_end_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel, "_WHOLE_WITHIN_S", 0.05)
    ours, theirs = socket.socketpair()
    reading = Channel(ours)
    theirs.sendall(b"drvr")
    assert reading.read() is None
    time.sleep(0.1)
    with pytest.raises(ProtocolError, match="did not end within"):
        reading.read()
    theirs.close()
    reading.close()


def test_the_worker_is_told_of_the_end_of_its_slot() -> None:
    ours, theirs = socket.socketpair()
    ours.close()
    with pytest.raises(ChannelClosedError):
        receive(theirs)
    theirs.close()


SOURCE = CandidateSource(space=SpaceSource(seed="{}", options="{}"), values=(0.1, 2.0))
CANDIDATE = Candidate(values=(1 / 3, -5e-324), document='{"a": "hard"}', prepare_s=0.1)


def test_a_candidate_arrives_as_it_was_left() -> None:
    for left in (CANDIDATE, replace(CANDIDATE, document="", problem="/ego: too near")):
        assert candidate_of(note_of_candidate(left, "run-1"), SOURCE, "run-1") == left


def test_a_candidate_of_another_run_is_not_taken() -> None:
    for note in (b"", note_of_candidate(CANDIDATE, "run-10"), note_of_candidate(CANDIDATE, "")):
        assert candidate_of(note, SOURCE, "run-1") is None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"values": (1.0,)}, "1 genes; asked were 2"),
        ({"values": (1.0, math.inf)}, "an invalid candidate"),
        ({"prepare_s": math.nan}, "an invalid candidate"),
        ({"problem": "both"}, "both or neither"),
        ({"document": ""}, "both or neither"),
    ],
)
def test_a_candidate_that_no_worker_leaves_is_refused(
    changes: dict[str, object], said: str
) -> None:
    changed = replace(CANDIDATE, **changes)  # type: ignore[arg-type]  # by name
    with pytest.raises(ProtocolError, match=said):
        candidate_of(note_of_candidate(changed, "run"), SOURCE, "run")


def test_a_candidate_that_is_no_json_is_refused() -> None:
    with pytest.raises(ProtocolError, match="an invalid candidate"):
        candidate_of(b"run\n{", SOURCE, "run")


def test_the_report_of_a_finished_run_is_recognised_by_its_begin() -> None:
    failure = RunFailure(cause="agent_raised", message="no")
    failed = RunReport(run_id="run", status=RunStatus.AGENT_FAILED, failure=failure)
    assert is_of_finished_run(frame_of_report(REPORT), "run")
    assert not is_of_finished_run(frame_of_report(REPORT), "ru")
    assert not is_of_finished_run(frame_of_report(failed), "run")
    assert not is_of_finished_run(Frame(Kind.READY), "run")


def test_reports_leave_out_defaults_on_their_way() -> None:
    frame = frame_of_report(REPORT)
    assert b"counterpart" in frame.body
    assert b"physically_avoidable" not in frame.body
    assert report_of(frame, "run") == REPORT
