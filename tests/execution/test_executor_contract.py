"""What every executor does: that of this machine, and that of a Ray cluster of two nodes.

Workers really crash, hang, grow and are killed.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from drivora_service.execution.executor import Executor, Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.ray.ray_executor import RayExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.runs.run_report import RunSpec, RunStatus
from tests.execution.attempts import (
    LIMITS,
    TASKS,
    assert_usable,
    failure_of,
    pid_of,
    run,
    wait_for,
)
from tests.execution.ray_cluster import Cluster

Start = Callable[..., Executor]
SLOTS = 2


@pytest.fixture(scope="module")
def on_ray(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, RayExecutor]]:
    """Executors of a cluster by their configuration: one serves many tests."""
    executors: dict[str, RayExecutor] = {}
    yield executors
    for executor in executors.values():
        executor.close()


@pytest.fixture(params=["local", pytest.param("ray", marks=pytest.mark.slow(seconds=10))])
def start(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Start]:
    """Starts an executor with two slots, whose workers perform the tasks of the tests."""
    with contextlib.ExitStack() as stack:

        def on_this_machine(limits: Limits, setup: object, warm_up: str) -> Executor:
            return stack.enter_context(
                LocalExecutor(
                    slots=SLOTS,
                    setup=setup,
                    folder=tmp_path,
                    limits=limits,
                    perform=TASKS,
                    warm_up=warm_up,
                )
            )

        def on_cluster(limits: Limits, setup: object, warm_up: str) -> Executor:
            cluster: Cluster = request.getfixturevalue("ray_nodes")
            started: dict[str, RayExecutor] = request.getfixturevalue("on_ray")
            key = f"{limits} {setup}"
            if key not in started:
                started[key] = RayExecutor(
                    address=cluster.address,
                    setup=setup,
                    folder=tmp_path,
                    limits=limits,
                    perform=TASKS,
                    warm_up=warm_up,
                )
            wait_for_slots(started[key])
            return started[key]

        on = on_this_machine if request.param == "local" else on_cluster

        def start_executor(
            limits: Limits = LIMITS, setup: object = "hello", warm_up: str = ""
        ) -> Executor:
            return on(limits, setup, warm_up)

        yield start_executor


of_a_worker = pytest.mark.parametrize("start", ["local"], indirect=True)
"""Of what happens between a worker and its slot: the slots of a node are those of one machine.

That limits, causes, signals and logs also pass through a cluster is in the tests on both.
"""


def wait_for_slots(executor: Executor) -> None:
    limit = time.monotonic() + 120
    while len(executor.slots()) < SLOTS:
        assert time.monotonic() < limit, executor.fault
        time.sleep(0.05)


def runs_of(executor: Executor) -> int:
    return sum(slot.runs for slot in executor.slots())


def test_each_cause_of_death_is_distinguished_and_the_slot_stays_usable(start: Start) -> None:
    executor = start()
    before = runs_of(executor)
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
    assert runs_of(executor) - before == 14
    assert sum(slot.restarts for slot in executor.slots()) >= 4


@of_a_worker
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


@of_a_worker
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


@of_a_worker
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
    running = [f"run-{number}" for number in range(len(executor.slots()))]
    for run_id in (*running, "waits"):
        executor.submit(RunSpec(run_id=run_id, document="hangs"))
    for run_id in running:
        pid_of(executor, run_id)
    executor.cancel("waits")
    executor.cancel("unknown")
    (waiting,) = wait_for(executor, 1)
    assert waiting.report.run_id == "waits"
    for run_id in running:
        executor.cancel(run_id)
    ends = [waiting, *wait_for(executor, len(running))]
    assert sorted(end.report.run_id for end in ends) == [*running, "waits"]
    assert {end.report.status for end in ends} == {RunStatus.CANCELLED}
    assert_usable(executor)


def test_what_no_slot_has_started_can_be_withdrawn(start: Start) -> None:
    executor = start()
    running = [f"run-{number}" for number in range(len(executor.slots()))]
    waiting = [f"waits-{number:02}" for number in range(12)]
    for run_id in (*running, *waiting):
        executor.submit(RunSpec(run_id=run_id, document="hangs"))
    for run_id in running:
        pid_of(executor, run_id)
    assert sorted(executor.withdraw()) == waiting
    assert executor.withdraw() == ()
    for run_id in running:
        executor.cancel(run_id)
    assert sorted(end.report.run_id for end in wait_for(executor, len(running))) == running
    # Runs that were withdrawn may be submitted again, and end once.
    executor.submit(RunSpec(run_id=waiting[0], document="sleep 0"))
    assert [end.report.status for end in wait_for(executor, 1)] == [RunStatus.FINISHED]
    assert executor.wait(0.2) == ()


def test_each_cancel_meets_its_own_run(start: Start) -> None:
    """Cancels are sent at any moment of a run: none may be lost or affect the next run."""
    executor = start()
    cancelled = set(range(0, 24, 3))
    statuses: dict[int, RunStatus] = {}
    for number in range(24):
        document = "hangs" if number in cancelled else "sleep 0.001"
        executor.submit(RunSpec(run_id=str(number), document=document))
        # The one before may be at its very end: a cancel for it must not touch this one.
        executor.cancel(str(number - 1))
        if number in cancelled:
            time.sleep(0.0007 * (number % 8))
            executor.cancel(str(number))
        (end,) = wait_for(executor, 1)
        statuses[int(end.report.run_id)] = end.report.status
    assert {n for n, status in statuses.items() if status is RunStatus.CANCELLED} == cancelled


def test_ends_are_waited_for_in_number(start: Start) -> None:
    executor = start()
    for number in range(3):
        executor.submit(RunSpec(run_id=str(number), document="sleep 0.05"))
    ends = executor.wait(30.0, count=3)
    assert sorted(end.report.run_id for end in ends) == ["0", "1", "2"]
    executor.submit(RunSpec(run_id="3", document="sleep 0"))
    # Fewer than wanted come after the time, or when the executor is woken.
    assert len(executor.wait(2.0, count=2)) == 1
    timer = threading.Timer(0.2, executor.wake)
    timer.start()
    begun = time.monotonic()
    assert executor.wait(30.0, count=2) == ()
    assert time.monotonic() - begun < 15.0
    timer.join()


def test_runs_wait_while_no_worker_can_start(start: Start, tmp_path: Path) -> None:
    needed = tmp_path / "can-start"
    executor = start(setup=needed, warm_up="tests.execution.worker_tasks:start_if_there")
    executor.submit(RunSpec(run_id="run", document="sleep 0"))
    executor.submit(RunSpec(run_id="cancelled", document="sleep 0"))
    limit = time.monotonic() + 60
    while not executor.fault:
        # It returns when a fault is found.
        executor.wait(limit - time.monotonic())
        assert time.monotonic() < limit
    assert "OSError: a worker needs can-start" in executor.fault
    executor.cancel("cancelled")
    assert [end.report.status for end in wait_for(executor, 1)] == [RunStatus.CANCELLED]
    needed.touch()
    assert [end.report.status for end in wait_for(executor, 1)] == [RunStatus.FINISHED]
    assert executor.fault == ""


def test_workers_have_the_environment_that_makes_results_repeatable(start: Start) -> None:
    environment = run(start(), "environment").report.versions
    assert environment["PYTHONHASHSEED"] == "0"
    assert environment["NUMBA_CPU_NAME"] == "generic"
    assert environment["OMP_NUM_THREADS"] == environment["NUMBA_NUM_THREADS"] == "1"


@of_a_worker
def test_what_a_dead_worker_started_dies_with_it(start: Start) -> None:
    executor = start()
    # Both slots are busy at once, so that these are their workers; either may take the next run.
    specs = [RunSpec(run_id=str(number), document="sleep 1.0") for number in range(SLOTS)]
    workers = {int(str(report.versions["pid"])) for report in run_all(executor, specs)}
    assert len(workers) == SLOTS
    assert run(executor, "spawns").report.status is RunStatus.SIMULATOR_CRASHED
    (dead,) = (worker for worker in workers if not psutil.pid_exists(worker))
    # A worker leads a process group, to which what it starts belongs.
    assert not [process for process in psutil.process_iter() if _lives_in(dead, process)]


def _lives_in(group: int, process: psutil.Process) -> bool:
    with contextlib.suppress(ProcessLookupError, PermissionError, psutil.NoSuchProcess):
        # The entry of a dead one may stay until it is reaped.
        return os.getpgid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE
    return False


def test_closing_ends_every_process(start: Start) -> None:
    executor = start(setup="closed by the test")
    for number in range(5):
        executor.submit(RunSpec(run_id=f"run-{number}", document="hangs"))
    begin = time.monotonic()
    while not any(slot.run_id for slot in executor.slots()):
        assert time.monotonic() - begin < 60
        time.sleep(0.05)
    pids = [slot.pid for slot in executor.slots() if slot.pid is not None]
    assert pids
    begin = time.monotonic()
    executor.close()
    assert time.monotonic() - begin < 30  # none of the runs would ever end by itself
    assert not any(psutil.pid_exists(pid) for pid in pids)
    with pytest.raises(RuntimeError, match="closed"):
        executor.submit(RunSpec(run_id="late", document="sleep 0"))


@pytest.mark.slow
def test_three_bad_runs_among_fifty_do_not_disturb_the_others(start: Start) -> None:
    executor = start()
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
    names = {slot.name for slot in executor.slots()}
    for number in range(len(names)):
        executor.submit(RunSpec(run_id=f"after-{number}", document="sleep 3"))
    assert {end.worker for end in wait_for(executor, len(names))} == names


def test_a_crash_is_confirmed_by_one_repetition(start: Start, tmp_path: Path) -> None:
    executor = start()
    before = runs_of(executor)
    specs = [
        RunSpec(run_id="always", document="segfault"),
        RunSpec(run_id="once", document=f"crash-once {tmp_path / 'crashed'}"),
    ]
    reports = {report.run_id: report.status for report in run_all(executor, specs)}
    assert reports == {"always": RunStatus.SIMULATOR_CRASHED, "once": RunStatus.FINISHED}
    assert runs_of(executor) - before == 4
