"""Workers with hostile code: attacks on the channel, the board, the log, and with processes."""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import stat
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from multiprocessing import forkserver
from pathlib import Path

import psutil
import pytest

from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.worker import channel

LIMITS = Limits(agent_deadline_s=2.0, wall_time_s=60.0, memory_bytes=600 << 20)

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")

Start = Callable[..., LocalExecutor]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    with contextlib.ExitStack() as stack:

        def start_executor(limits: Limits = LIMITS) -> LocalExecutor:
            return stack.enter_context(
                LocalExecutor(
                    slots=1,
                    setup=None,
                    folder=tmp_path / "workers",
                    limits=limits,
                    perform="tests.execution.worker_tasks:perform",
                    warm_up="",
                )
            )

        yield start_executor


def run(executor: LocalExecutor, document: str) -> AttemptEnd:
    executor.submit(RunSpec(run_id="run", document=document))
    return end_of(executor)


def end_of(executor: LocalExecutor) -> AttemptEnd:
    limit = time.monotonic() + 60.0
    while time.monotonic() < limit:
        for end in executor.wait(0.5):
            return end
    raise AssertionError("the run did not end")


def failure_of(report: RunReport) -> RunFailure:
    assert report.failure is not None
    return report.failure


def outcome(end: AttemptEnd) -> tuple[RunStatus, str]:
    return end.report.status, failure_of(end.report).cause


def worker_of(executor: LocalExecutor) -> int:
    return int(str(run(executor, "sleep 0").report.versions["pid"]))


def wait_for_phase(executor: LocalExecutor, phase: str) -> int:
    """Waits until the worker is in a phase and returns its process id."""
    limit = time.monotonic() + 30.0
    while time.monotonic() < limit:
        (slot,) = executor.slots()
        if slot.phase == phase and slot.pid is not None:
            return slot.pid
        time.sleep(0.01)
    raise AssertionError(f"the worker was never {phase}")


def is_gone(pid: int, within: float = 10.0) -> bool:
    limit = time.monotonic() + within
    while time.monotonic() < limit:
        try:
            if psutil.Process(pid).status() == psutil.STATUS_ZOMBIE:
                return True
        except psutil.NoSuchProcess:
            return True
        time.sleep(0.02)
    return False


LIES = (
    ("header", "did not end within"),
    ("huge", "a message of 4294967295 bytes; allowed: 16777216"),
    ("pickle {path}", "where a message begins"),
    ("framed-pickle {path}", "an invalid report"),
    ("kind", "the unknown kind 77"),
    ("ready", "the message READY where a report was expected"),
    ("other-run", "the run id 'another'; asked was 'run'"),
    ("not-final", "the status running, which no worker reports"),
    ("many-steps", "1208925819614629174706176 steps"),
    ("no-schema", "an invalid report: run_id"),
    ("deep", "an invalid report"),
    ("nothing-more", "closed its channel"),
)


def test_what_is_no_report_ends_the_worker_and_harms_nothing_else(
    start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(channel, "_WHOLE_WITHIN_S", 0.5)
    monkeypatch.setattr("drivora_service.execution.kept_worker._ANSWER_S", 1.0)
    executor = start()
    touched = tmp_path / "touched"
    for what, message in LIES:
        end = run(executor, f"agent-sends {what.format(path=touched)}")
        assert outcome(end) == (RunStatus.AGENT_FAILED, "worker_protocol"), what
        assert message in failure_of(end.report).message
        assert "in the agent of ego number 2 at step 17" in failure_of(end.report).message
    assert not touched.exists()
    assert worker_of(executor)


def test_a_breach_outside_of_an_agent_is_not_attributed_to_it(start: Start) -> None:
    executor = start()
    end = run(executor, "sends other-run")
    assert outcome(end) == (RunStatus.INFRASTRUCTURE_FAILED, "worker_protocol")


def test_what_begins_as_a_report_is_refused_when_it_is_read(start: Start) -> None:
    executor = start()
    first = worker_of(executor)
    end = run(executor, "sends-like-finished")
    assert outcome(end) == (RunStatus.INFRASTRUCTURE_FAILED, "worker_protocol")
    assert "an invalid report: steps" in failure_of(end.report).message
    # The worker waits for runs by now, and gets none.
    assert worker_of(executor) != first
    assert "an invalid report" in executor.slots()[0].last_crash


def test_a_process_is_found_after_many_runs_that_started_none(start: Start, tmp_path: Path) -> None:
    executor = start()
    first = worker_of(executor)
    assert {worker_of(executor) for _ in range(5)} == {first}
    run(executor, f"daemonizes {tmp_path / 'pid'}")
    assert is_gone(int((tmp_path / "pid").read_text()))
    assert worker_of(executor) != first


def test_an_agent_cannot_report_for_its_worker(start: Start) -> None:
    end = run(start(), "agent-sends own-report")
    assert outcome(end) == (RunStatus.AGENT_FAILED, "worker_protocol")


def test_a_second_report_is_not_taken_for_that_of_the_next_run(start: Start) -> None:
    executor = start()
    first = worker_of(executor)
    assert run(executor, "sends-twice").report.status is RunStatus.FINISHED
    assert worker_of(executor) != first


def test_a_long_document_goes_to_a_worker_that_was_stopped(start: Start) -> None:
    executor = start()
    pid = worker_of(executor)
    os.kill(pid, signal.SIGSTOP)
    executor.submit(RunSpec(run_id="run", document="sleep 0 " + " " * (8 << 20)))
    time.sleep(0.5)
    assert executor.slots()[0].run_id == "run"
    executor.cancel("run")
    assert end_of(executor).report.status is RunStatus.CANCELLED


def test_a_document_may_be_longer_than_a_report(start: Start) -> None:
    executor = start()
    document = "sleep 0" + " " * (channel.LONGEST_BODY + 1)
    assert run(executor, document).report.status is RunStatus.FINISHED


def test_a_fork_server_that_was_stopped_is_replaced(start: Start) -> None:
    executor = start()
    assert worker_of(executor)
    server = psutil.Process(forkserver._forkserver._forkserver_pid)  # type: ignore[attr-defined]  # no other way
    server.suspend()
    assert run(executor, "exit 3").report.status is RunStatus.SIMULATOR_CRASHED
    assert worker_of(executor)
    assert is_gone(server.pid)


def test_a_worker_that_was_stopped_is_no_hung_agent(start: Start) -> None:
    executor = start()
    executor.submit(RunSpec(run_id="run", document="agent-sleeps 1.0"))
    pid = wait_for_phase(executor, "in_agent")
    os.kill(pid, signal.SIGSTOP)
    time.sleep(3.0)
    os.kill(pid, signal.SIGCONT)
    assert end_of(executor).report.status is RunStatus.FINISHED


def test_a_worker_that_stays_stopped_is_lost(start: Start) -> None:
    executor = start(limits=replace(LIMITS, wall_time_s=1.5))
    end = run(executor, "agent-stops-itself")
    assert outcome(end) == (RunStatus.INFRASTRUCTURE_FAILED, "worker_stopped")


@pytest.mark.parametrize("word", ["daemonizes", "daemonizes-and-crashes"])
def test_what_a_run_starts_dies_with_it(start: Start, tmp_path: Path, word: str) -> None:
    executor = start()
    first = worker_of(executor)
    note = tmp_path / "daemon"
    run(executor, f"{word} {note}")
    assert is_gone(int(note.read_text()))
    assert worker_of(executor) != first
    if word == "daemonizes":
        log = (tmp_path / "workers" / "slot-0.log").read_text()
        assert f"run run left processes behind: python ({note.read_text()})" in log


def test_the_memory_of_its_children_counts(start: Start) -> None:
    executor = start(limits=replace(LIMITS, agent_deadline_s=30.0, memory_bytes=400 << 20))
    end = run(executor, "child-grows")
    assert outcome(end) == (RunStatus.AGENT_FAILED, "memory_limit")
    assert "the processes that were started in it to" in failure_of(end.report).message
    assert worker_of(executor)


def test_memory_that_processes_share_counts_once(start: Start) -> None:
    executor = start(limits=replace(LIMITS, agent_deadline_s=30.0, memory_bytes=400 << 20))
    assert run(executor, "forks-and-idles 150").report.status is RunStatus.FINISHED


def test_a_flood_of_lines_is_cut_while_it_goes_on(start: Start, tmp_path: Path) -> None:
    executor = start(limits=replace(LIMITS, log_bytes=1 << 20))
    assert worker_of(executor)
    log = tmp_path / "workers" / "slot-0.log"
    sizes = []
    executor.submit(RunSpec(run_id="run", document="floods 1.0"))
    while not (ends := executor.wait(0.02)):
        sizes.append(log.stat().st_size)
    assert ends[0].report.status is RunStatus.FINISHED
    assert worker_of(executor)
    assert log.stat().st_size <= 1 << 20
    assert "[the log grew beyond 1048576 bytes" in log.read_text()
    assert "the last words" in log.read_text()
    assert any(later < earlier for earlier, later in itertools.pairwise(sizes))


def test_a_log_that_was_replaced_by_a_link_is_not_followed(start: Start, tmp_path: Path) -> None:
    database = tmp_path / "drivora.sqlite3"
    database.write_bytes(b"all the runs")
    log = tmp_path / "workers" / "slot-0.log"
    executor = start()
    assert worker_of(executor)
    assert stat.S_IMODE(log.stat().st_mode) == 0o600
    end = run(executor, f"replaces-log {log} {database}")
    assert "something new" in failure_of(end.report).log
    assert worker_of(executor)
    assert not log.is_symlink()
    assert database.read_bytes() == b"all the runs"


def test_a_log_that_is_a_link_at_the_start_is_not_followed(start: Start, tmp_path: Path) -> None:
    database = tmp_path / "drivora.sqlite3"
    database.write_bytes(b"all the runs")
    (tmp_path / "workers").mkdir()
    (tmp_path / "workers" / "slot-0.log").symlink_to(database)
    assert worker_of(start())
    assert database.read_bytes() == b"all the runs"


def test_runs_survive_the_fork_server(start: Start) -> None:
    executor = start()
    executor.submit(RunSpec(run_id="run", document="sleep 1.5"))
    wait_for_phase(executor, "simulating")
    server = forkserver._forkserver._forkserver_pid  # type: ignore[attr-defined] # no other way
    os.kill(server, signal.SIGKILL)
    assert end_of(executor).report.status is RunStatus.FINISHED
    assert run(executor, "exit 3").report.status is RunStatus.SIMULATOR_CRASHED
    assert worker_of(executor)


def test_the_loss_of_a_keeper_is_infrastructure_failed(start: Start, tmp_path: Path) -> None:
    executor = start()
    executor.submit(RunSpec(run_id="run", document="agent-sleeps 60"))
    worker = wait_for_phase(executor, "in_agent")
    keeper = psutil.Process(worker).parent()
    assert keeper is not None
    keeper.kill()
    assert outcome(end_of(executor)) == (RunStatus.INFRASTRUCTURE_FAILED, "worker_lost")
    assert is_gone(worker)
    assert worker_of(executor)


def test_what_was_started_is_ended_without_a_keeper_too(start: Start, tmp_path: Path) -> None:
    executor = start(limits=replace(LIMITS, agent_deadline_s=30.0))
    note = tmp_path / "daemon"
    executor.submit(RunSpec(run_id="run", document="agent-spawns-and-hangs"))
    worker = psutil.Process(wait_for_phase(executor, "in_agent"))
    while not (children := worker.children()):
        time.sleep(0.01)
    assert not note.exists()
    keeper = worker.parent()
    assert keeper is not None
    keeper.kill()
    assert outcome(end_of(executor)) == (RunStatus.INFRASTRUCTURE_FAILED, "worker_lost")
    assert is_gone(children[0].pid)


def test_a_keeper_that_was_stopped_is_replaced(start: Start) -> None:
    executor = start()
    executor.submit(RunSpec(run_id="run", document="sleep 1.0"))
    worker = wait_for_phase(executor, "simulating")
    keeper = psutil.Process(worker).parent()
    assert keeper is not None
    keeper.suspend()
    assert end_of(executor).report.status is RunStatus.FINISHED
    assert worker_of(executor) != worker
    assert is_gone(keeper.pid)
    assert is_gone(worker)


@pytest.mark.parametrize(
    ("report", "stays"),
    [
        ("invalid", True),
        ("invalid in-process", False),
        ("agent_failed", True),
        ("agent_failed in-process", False),
        ("plugin_failed", False),
        ("simulator_crashed", False),
    ],
)
def test_a_worker_is_replaced_after_a_run_that_may_have_changed_its_state(
    start: Start, report: str, stays: bool
) -> None:
    executor = start()
    first = worker_of(executor)
    assert worker_of(executor) == first
    assert run(executor, f"reports {report}").report.status == report.partition(" ")[0]
    assert (worker_of(executor) == first) == stays
