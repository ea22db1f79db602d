"""Runs without a database."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import Runs, run_all
from drivora_service.runs.run_report import RunSpec, RunStatus
from tests.execution.attempts import LIMITS, TASKS


def specs(folder: Path, count: int) -> list[RunSpec]:
    """Returns runs whose traces cannot be written while the folder does not exist."""
    return [
        RunSpec(
            run_id=f"run-{number}",
            document="writes-trace 0",
            trace_path=str(folder / f"{number}.npz"),
        )
        for number in range(count)
    ]


@pytest.fixture
def executor(tmp_path: Path) -> LocalExecutor:
    return LocalExecutor(
        slots=2, setup=None, folder=tmp_path, limits=LIMITS, perform=TASKS, warm_up=""
    )


def test_a_fault_of_a_second_takes_no_run(executor: LocalExecutor, tmp_path: Path) -> None:
    folder = tmp_path / "traces"
    with executor:
        runs = Runs(executor)
        for spec in specs(folder, 4):
            runs.submit(spec)
        # The first attempts are over within moments, and so would be three of each.
        repair = threading.Timer(1.5, folder.mkdir)
        repair.start()
        statuses = []
        while len(runs):
            statuses += [end.report.status for end in runs.wait()]
        repair.join()
    assert statuses == [RunStatus.FINISHED] * 4


def test_a_run_by_itself_is_not_lost_to_a_fault_of_seconds(
    executor: LocalExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "traces"
    repair = threading.Timer(3.0, folder.mkdir)
    with executor:
        repair.start()
        (report,) = run_all(executor, specs(folder, 1))
        repair.join()
    assert report.status is RunStatus.FINISHED


def test_runs_that_wait_for_the_end_of_a_pause_can_be_forgotten(
    executor: LocalExecutor, tmp_path: Path
) -> None:
    wanted = specs(tmp_path / "traces", 2)
    with executor:
        runs = Runs(executor)
        for spec in wanted:
            runs.submit(spec)
        found: tuple[str, ...] = ()
        while not found:
            assert not runs.wait(0.1)
            found = runs.discard([spec.run_id for spec in wanted])
        assert len(runs) == len(wanted) - len(found)
        assert runs.discard(found) == ()


def test_a_run_that_is_lost_again_and_again_fails(executor: LocalExecutor, tmp_path: Path) -> None:
    (bad,) = specs(tmp_path / "missing", 1)
    good = [RunSpec(run_id=f"good-{number}", document="sleep 0") for number in range(3)]
    with executor:
        found = {report.run_id: report.status for report in run_all(executor, [bad, *good])}
    assert found.pop(bad.run_id) is RunStatus.INFRASTRUCTURE_FAILED
    assert set(found.values()) == {RunStatus.FINISHED}
