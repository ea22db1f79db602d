"""Workers that really crash, hang, grow and are killed."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.running import run_all
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus

TASKS = "tests.execution.worker_tasks:perform"
LIMITS = Limits(agent_deadline_s=0.8, wall_time_s=20.0, memory_bytes=600 << 20)

Start = Callable[..., LocalExecutor]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    with contextlib.ExitStack() as stack:

        def start_executor(slots: int = 1, limits: Limits = LIMITS) -> LocalExecutor:
            return stack.enter_context(
                LocalExecutor(
                    slots=slots,
                    setup="hello",
                    folder=tmp_path,
                    limits=limits,
                    perform=TASKS,
                    warm_up="",
                )
            )

        yield start_executor


def run(executor: LocalExecutor, document: str) -> AttemptEnd:
    executor.submit(RunSpec(run_id="run", document=document))
    return wait_for(executor, 1)[0]


def wait_for(executor: LocalExecutor, count: int) -> list[AttemptEnd]:
    ends: list[AttemptEnd] = []
    limit = time.monotonic() + 60
    while len(ends) < count and time.monotonic() < limit:
        ends += executor.wait(1.0)
    assert len(ends) == count
    return ends


def failure_of(report: RunReport) -> RunFailure:
    assert report.failure is not None
    return report.failure


def assert_usable(executor: LocalExecutor) -> None:
    assert run(executor, "sleep 0").report.status is RunStatus.FINISHED


def test_each_cause_of_death_is_distinguished_and_the_slot_stays_usable(start: Start) -> None:
    executor = start()
    for document, status, cause, signal_name in (
        ("segfault", RunStatus.SIMULATOR_CRASHED, "signal", "SIGSEGV"),
        ("agent-segfault", RunStatus.AGENT_FAILED, "signal", "SIGSEGV"),
        ("exit 3", RunStatus.SIMULATOR_CRASHED, "worker_exited", ""),
        ("kill-self", RunStatus.INFRASTRUCTURE_FAILED, "worker_lost", "SIGKILL"),
        ("agent-calls-exit 3", RunStatus.AGENT_FAILED, "agent_raised", ""),
        ("simulator-error no", RunStatus.SIMULATOR_CRASHED, "simulator_error", ""),
        ("raises no", RunStatus.INFRASTRUCTURE_FAILED, "worker_error", ""),
    ):
        end = run(executor, document)
        found = (end.report.status, failure_of(end.report).cause, end.signal)
        assert found == (status, cause, signal_name), document
        assert_usable(executor)
    (slot,) = executor.slots()
    assert slot.runs == 14
    assert slot.restarts >= 4
    assert "SIGKILL" in slot.last_crash


def test_an_early_crash_is_not_taken_for_a_loss(start: Start) -> None:
    executor = start()
    ends = [run(executor, "segfault") for _ in range(25)]
    assert {(end.report.status, end.signal) for end in ends} == {
        (RunStatus.SIMULATOR_CRASHED, "SIGSEGV")
    }


def test_the_last_output_before_a_crash_is_kept(start: Start) -> None:
    failure = failure_of(run(start(), "segfault").report)
    assert "about to touch address zero" in failure.log
    assert "Segmentation fault" in failure.log
    assert "worker_tasks.py" in failure.log


@pytest.mark.parametrize("document", ["agent-hangs", "agent-hangs-in-c"])
def test_a_hung_agent_is_named(start: Start, document: str) -> None:
    executor = start()
    report = run(executor, document).report
    assert report.status is RunStatus.AGENT_FAILED
    assert failure_of(report).cause == "agent_hung"
    assert "ego number 2" in failure_of(report).message
    assert "step 17" in failure_of(report).message
    assert_usable(executor)


def test_a_run_that_hangs_elsewhere_is_timed_out(start: Start) -> None:
    executor = start(limits=replace(LIMITS, wall_time_s=1.5))
    report = run(executor, "hangs").report
    assert (report.status, failure_of(report).cause) == (RunStatus.TIMED_OUT, "wall_time_limit")
    assert_usable(executor)


def test_a_run_that_grows_is_ended(start: Start) -> None:
    executor = start(limits=replace(LIMITS, agent_deadline_s=15.0))
    simulator = run(executor, "grows").report
    agent = run(executor, "agent-grows").report
    assert simulator.status is RunStatus.SIMULATOR_CRASHED
    assert agent.status is RunStatus.AGENT_FAILED
    assert failure_of(simulator).cause == failure_of(agent).cause == "memory_limit"
    assert_usable(executor)


def test_a_worker_killed_from_outside_is_lost_to_the_infrastructure(start: Start) -> None:
    executor = start()
    assert_usable(executor)
    executor.submit(RunSpec(run_id="run", document="hangs"))
    os.kill(pid_of(executor, "run"), signal.SIGKILL)
    (end,) = wait_for(executor, 1)
    assert end.report.status is RunStatus.INFRASTRUCTURE_FAILED
    assert_usable(executor)


def test_an_idle_worker_that_is_killed_is_replaced(start: Start) -> None:
    executor = start()
    first = run(executor, "sleep 0.2").report
    os.kill(int(str(first.versions["pid"])), signal.SIGKILL)
    time.sleep(0.5)
    second = run(executor, "sleep 0").report
    assert second.status is RunStatus.FINISHED
    assert second.versions["pid"] != first.versions["pid"]


def test_running_and_waiting_runs_can_be_cancelled(start: Start) -> None:
    executor = start()
    executor.submit(RunSpec(run_id="run", document="hangs"))
    executor.submit(RunSpec(run_id="waits", document="hangs"))
    pid_of(executor, "run")
    executor.cancel("waits")
    executor.cancel("nobody")
    (waiting,) = wait_for(executor, 1)
    executor.cancel("run")
    (running,) = wait_for(executor, 1)
    assert (waiting.report.run_id, running.report.run_id) == ("waits", "run")
    assert waiting.report.status is running.report.status is RunStatus.CANCELLED
    assert_usable(executor)


def test_workers_are_recycled(start: Start) -> None:
    executor = start(limits=replace(LIMITS, runs_per_worker=3))
    pids = [run(executor, "sleep 0").report.versions["pid"] for _ in range(6)]
    assert [len(set(pids[:3])), len(set(pids[3:])), len(set(pids))] == [1, 1, 2]


def test_a_log_does_not_grow_for_ever(start: Start, tmp_path: Path) -> None:
    executor = start(limits=replace(LIMITS, log_bytes=1 << 20))
    assert_usable(executor)
    with (tmp_path / "slot-0.log").open("a") as log:
        log.write("much\n" * 1_000_000)
    assert_usable(executor)
    assert (tmp_path / "slot-0.log").stat().st_size < 1_000_000


def test_workers_have_the_environment_that_makes_results_repeatable(start: Start) -> None:
    environment = run(start(), "environment").report.versions
    assert environment["PYTHONHASHSEED"] == "0"
    assert environment["NUMBA_CPU_NAME"] == "generic"
    assert environment["OMP_NUM_THREADS"] == environment["NUMBA_NUM_THREADS"] == "1"


def test_what_a_dead_worker_started_dies_with_it(start: Start) -> None:
    executor = start()
    worker = int(str(run(executor, "sleep 0").report.versions["pid"]))
    assert run(executor, "spawns").report.status is RunStatus.SIMULATOR_CRASHED
    # A worker leads a process group, to which what it starts belongs.
    assert not [process for process in psutil.process_iter() if _lives_in(worker, process)]


def _lives_in(group: int, process: psutil.Process) -> bool:
    with contextlib.suppress(ProcessLookupError, PermissionError, psutil.NoSuchProcess):
        # The entry of a dead one may stay until it is reaped.
        return os.getpgid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE
    return False


def test_a_slot_survives_the_loss_of_its_folder(start: Start, tmp_path: Path) -> None:
    executor = start()
    assert_usable(executor)
    for path in tmp_path.iterdir():
        path.unlink()
    assert_usable(executor)
    assert run(executor, "segfault").report.status is RunStatus.SIMULATOR_CRASHED
    assert_usable(executor)


def test_closing_ends_every_process(tmp_path: Path) -> None:
    executor = LocalExecutor(
        slots=2, setup=None, folder=tmp_path, limits=LIMITS, perform=TASKS, warm_up=""
    )
    for number in range(5):
        executor.submit(RunSpec(run_id=f"run-{number}", document="hangs"))
    pids = [pid_of(executor, "run-0"), pid_of(executor, "run-1")]
    begin = time.monotonic()
    executor.close()
    assert time.monotonic() - begin < 30  # neither run would ever end by itself
    assert not any(psutil.pid_exists(pid) for pid in pids)
    with pytest.raises(RuntimeError, match="closed"):
        executor.submit(RunSpec(run_id="late", document="sleep 0"))


@pytest.mark.slow
def test_three_bad_runs_among_fifty_do_not_disturb_the_others(start: Start) -> None:
    executor = start(slots=2)
    bad = {9: "segfault", 23: "agent-hangs-in-c", 37: "grows"}
    specs = [
        RunSpec(run_id=f"run-{number}", document=bad.get(number, "sleep 0.01"))
        for number in range(50)
    ]
    reports = {report.run_id: report for report in run_all(executor, specs)}
    assert len(reports) == 50
    finished = [r for r in reports.values() if r.status is RunStatus.FINISHED]
    assert len(finished) == 47
    causes = {number: failure_of(reports[f"run-{number}"]).cause for number in bad}
    assert causes == {9: "signal", 23: "agent_hung", 37: "memory_limit"}
    for number in range(2):
        executor.submit(RunSpec(run_id=f"after-{number}", document="sleep 3"))
    assert {end.worker for end in wait_for(executor, 2)} == {"slot-0", "slot-1"}


def test_a_crash_is_confirmed_by_one_repetition(start: Start, tmp_path: Path) -> None:
    executor = start()
    specs = [
        RunSpec(run_id="always", document="segfault"),
        RunSpec(run_id="once", document=f"crash-once {tmp_path / 'crashed'}"),
    ]
    reports = {report.run_id: report.status for report in run_all(executor, specs)}
    assert reports == {"always": RunStatus.SIMULATOR_CRASHED, "once": RunStatus.FINISHED}
    assert executor.slots()[0].runs == 4


def pid_of(executor: LocalExecutor, run_id: str) -> int:
    """Waits until a run is running and returns its process."""
    limit = time.monotonic() + 30
    while time.monotonic() < limit:
        for slot in executor.slots():
            if slot.run_id == run_id and slot.phase == "simulating" and slot.pid is not None:
                return slot.pid
        time.sleep(0.02)
    raise AssertionError(f"{run_id} was never seen running")
