"""What the executor of one machine does with its folder and its workers, beyond its contract."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.execution.executor import Limits
from drivora_service.execution.local import LocalExecutor
from drivora_service.runs.run_report import RunStatus
from drivora_service.runs.slot_state import SlotState
from tests.execution.attempts import LIMITS, TASKS, assert_usable, run
from tests.execution.worker_tasks import keep_late

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


def test_workers_are_recycled(start: Start) -> None:
    executor = start(limits=replace(LIMITS, runs_per_worker=3))
    pids = [run(executor, "sleep 0").report.versions["pid"] for _ in range(6)]
    assert [len(set(pids[:3])), len(set(pids[3:])), len(set(pids))] == [1, 1, 2]


def test_a_slot_that_waits_for_work_knows_its_worker(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("drivora_service.execution.kept_worker.keep", keep_late)
    executor = start()
    seen: list[SlotState] = []
    limit = time.monotonic() + 60
    while not seen or seen[-1].phase == "starting":
        assert time.monotonic() < limit
        seen.extend(executor.slots())
        time.sleep(0.01)
    assert (seen[-1].phase, seen[-1].restarts) == ("idle", 0)
    assert seen[-1].pid is not None
    assert seen[-1].memory_bytes > 1 << 20


def test_a_log_does_not_grow_for_ever(start: Start, tmp_path: Path) -> None:
    executor = start(limits=replace(LIMITS, log_bytes=1 << 20))
    assert_usable(executor)
    with (tmp_path / "slot-0.log").open("a") as log:
        log.write("much\n" * 1_000_000)
    assert_usable(executor)
    assert (tmp_path / "slot-0.log").stat().st_size < 1_000_000


def test_a_slot_survives_the_loss_of_its_folder(start: Start, tmp_path: Path) -> None:
    executor = start()
    assert_usable(executor)
    for path in tmp_path.iterdir():
        path.unlink()
    assert_usable(executor)
    assert run(executor, "segfault").report.status is RunStatus.SIMULATOR_CRASHED
    assert_usable(executor)
