"""Slots that continue after any fault of their workers, and cancels of the right run."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunSpec, RunStatus

TASKS = "tests.execution.worker_tasks:perform"
PR_SET_CHILD_SUBREAPER = 36


def executor_in(folder: Path, *, slots: int = 1, limits: Limits | None = None) -> LocalExecutor:
    return LocalExecutor(
        slots=slots,
        setup=None,
        folder=folder,
        limits=limits or Limits(agent_deadline_s=0.5),
        perform=TASKS,
        warm_up="",
    )


@pytest.fixture
def executor(tmp_path: Path) -> Iterator[LocalExecutor]:
    with executor_in(tmp_path / "workers") as started:
        yield started


def ends_of(executor: LocalExecutor, count: int, within: float = 60.0) -> list[AttemptEnd]:
    ends: list[AttemptEnd] = []
    limit = time.monotonic() + within
    while len(ends) < count and time.monotonic() < limit:
        ends += executor.wait(0.5)
    assert len(ends) == count
    return ends


def run(executor: LocalExecutor, document: str) -> AttemptEnd:
    executor.submit(RunSpec(run_id="run", document=document))
    return ends_of(executor, 1)[0]


def look_again_and_again(executor: LocalExecutor, documents: list[str]) -> list[str]:
    """Performs runs while the slots are looked at; returns what the looks raised."""
    raised: list[str] = []
    over = threading.Event()

    def look() -> None:
        while not over.is_set():
            try:
                executor.slots()
            except Exception as error:
                raised.append(repr(error))
                return
            time.sleep(0.001)

    thread = threading.Thread(target=look)
    thread.start()
    try:
        for document in documents:
            run(executor, document)
    finally:
        over.set()
        thread.join()
    return raised


def where_orphans_stay(folder: Path) -> None:
    """Ends workers where the process that adopts orphans does not reap them, as some PIDs 1."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    with executor_in(folder) as executor:
        raised = look_again_and_again(executor, ["agent-spawns-and-hangs"] * 2 + ["segfault"] * 3)
        status = run(executor, "sleep 0").report.status
    print(*raised, status)


@pytest.mark.skipif(sys.platform != "linux", reason="orphans are adopted by chosen processes")
def test_slots_can_be_looked_at_where_nothing_reaps_orphans(
    tmp_path: Path, repository: Path
) -> None:
    code = (
        "import sys, pathlib; from tests.execution.test_supervision import where_orphans_stay; "
        "where_orphans_stay(pathlib.Path(sys.argv[1]))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)],
        env={**os.environ, "PYTHONPATH": str(repository)},
        cwd=repository,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (ended.returncode, ended.stdout.strip()) == (0, "finished"), ended.stderr


def test_an_unknown_phase_harms_no_look(executor: LocalExecutor) -> None:
    assert look_again_and_again(executor, ["writes-board 77 5 0 1 0", "sleep 0"]) == []


def test_numbers_of_the_board_are_bounded(executor: LocalExecutor) -> None:
    executor.submit(RunSpec(run_id="run", document=f"writes-board 2 {2**62} {-(2**62)} 1 0"))
    limit = time.monotonic() + 30
    steps = set()
    while time.monotonic() < limit and not (ends := executor.wait(0.02)):
        steps.add(executor.slots()[0].step)
    assert [end.report.status for end in ends] == [RunStatus.FINISHED]
    assert max(steps) == 2**31 - 1


def test_a_slot_whose_log_cannot_be_written_says_so_and_goes_on_later(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    obstacle = tmp_path / "workers" / "slot-0.log"
    obstacle.mkdir(parents=True)
    with executor_in(tmp_path / "workers") as executor:
        executor.submit(RunSpec(run_id="run", document="sleep 0"))
        limit = time.monotonic() + 30
        while not executor.fault and time.monotonic() < limit:
            time.sleep(0.05)
        assert "slot-0.log" in executor.fault
        assert executor.slots()[0].pid is None
        obstacle.rmdir()
        (end,) = ends_of(executor, 1)
        assert end.report.status is RunStatus.FINISHED
        assert executor.fault == ""


def test_a_fault_in_the_supervision_costs_one_attempt_and_no_slot(
    executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run(executor, "sleep 0").report.status is RunStatus.FINISHED

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("no such luck")

    with monkeypatch.context() as patched:
        patched.setattr("drivora_service.execution.slot.Watch", broken)
        ends = [run(executor, "sleep 0") for _ in range(3)]
    assert {end.report.status for end in ends} == {RunStatus.INFRASTRUCTURE_FAILED}
    assert ends[0].report.failure is not None
    assert "no such luck" in ends[0].report.failure.message
    assert run(executor, "sleep 0").report.status is RunStatus.FINISHED
    log = "".join(capfd.readouterr())
    assert log.count("slot=slot-0") == 1


def test_a_fault_in_the_sink_does_not_end_the_slot(
    executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    (slot,) = executor._slots
    sound = slot._sink
    faults = iter([MemoryError("none left")])

    def sink(run_id: str, read: Callable[[], AttemptEnd]) -> None:
        for fault in faults:
            raise fault
        sound(run_id, read)

    monkeypatch.setattr(slot, "_sink", sink)
    assert run(executor, "sleep 0").report.status is RunStatus.FINISHED
    assert "none left" in "".join(capfd.readouterr())


def test_a_cancel_between_queue_and_slot_is_kept(
    executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    (slot,) = executor._slots
    attempt = slot._attempt

    def late(*arguments: object) -> Callable[[], AttemptEnd]:
        executor.cancel("run")
        return attempt(*arguments)  # type: ignore[arg-type] # handed on as it came

    monkeypatch.setattr(slot, "_attempt", late)
    assert run(executor, "hangs").report.status is RunStatus.CANCELLED
