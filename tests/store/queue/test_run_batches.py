"""Claims and ends of many runs in one transaction."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.errors import StoreError, StoreUnavailable
from drivora_service.execution.storage_failures import write_in_parts
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import Priority
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify
from tests.store.samples import (
    POLICY,
    claim,
    crashed,
    finish,
    finished,
    lost,
    no_trace,
    register,
    statements,
    submit,
)

MOST_STEPS = 2**63
"""One more than a column of the database holds."""


def too_long(run_id: str) -> AttemptEnd:
    """An end whose report cannot be written."""
    end = finished(run_id)
    return replace(end, report=replace(end.report, steps=MOST_STEPS))


def statuses(database: Database, run_ids: tuple[str, ...]) -> list[RunStatus]:
    with database.read() as transaction:
        return [transaction.jobs.get(run_id).status for run_id in run_ids]


def test_the_statements_of_a_batch_do_not_grow_with_it(database: Database) -> None:
    submit(database, 60, priority=Priority.CI)
    owner = register(database)
    numbers = []
    for size in (2, 50):
        with statements(database) as sent:
            runs = claim(database, owner, size)
            assert len(runs) == size
            finish(database, owner, *(finished(run_id, "collision") for run_id in runs))
        numbers.append(len(sent))
    assert numbers[0] == numbers[1] > 0


def test_each_run_of_a_mixed_batch_has_its_own_end(database: Database, tmp_path: Path) -> None:
    submit(database, 5, priority=Priority.CI)
    owner = register(database)
    runs = claim(database, owner, 5)
    ends = (
        finished(runs[0]),
        crashed(runs[1]),
        finished(runs[2], "collision", "red_light"),
        lost(runs[3]),
        finished("unknown"),
    )
    final = finish(database, owner, *ends)
    assert [report.run_id for report in final] == [runs[0], runs[2]]
    expected = [RunStatus.FINISHED, RunStatus.QUEUED, RunStatus.FINISHED, RunStatus.QUEUED]
    assert statuses(database, runs) == [*expected, RunStatus.RUNNING]
    with database.read() as transaction:
        clean, broken = transaction.jobs.get(runs[0]), transaction.jobs.get(runs[2])
        attempts = [transaction.jobs.attempts(run_id)[0] for run_id in runs]
        queued = transaction.batches.get(clean.batch_id).counts[RunStatus.QUEUED]
    assert (clean.violations, broken.violations, broken.at_fault_violations) == (0, 2, 2)
    assert [attempt.outcome for attempt in attempts] == [
        "finished",
        "simulator_crashed",
        "finished",
        "infrastructure_failed",
        "",
    ]
    assert [attempt.signal for attempt in attempts] == ["", "SIGSEGV", "", "", ""]
    assert [attempt.log for attempt in attempts] == ["", "last line", "", "", ""]
    assert queued == 2
    # The runs that are repeated come before none that was queued later.
    assert claim(database, owner, 5) == (runs[1], runs[3])
    assert list(verify(database, TraceFolder(tmp_path / "traces"))) == []


def test_a_batch_with_a_report_that_cannot_be_written_changes_nothing(database: Database) -> None:
    submit(database, 3, priority=Priority.CI)
    owner = register(database)
    runs = claim(database, owner, 3)
    with pytest.raises((OverflowError, StoreError)):
        finish(database, owner, finished(runs[0]), too_long(runs[1]), finished(runs[2]))
    assert statuses(database, runs) == [RunStatus.RUNNING] * 3
    assert len(finish(database, owner, finished(runs[0]), finished(runs[2]))) == 2


def test_the_report_that_cannot_be_written_is_found_and_holds_up_no_other(
    database: Database,
) -> None:
    submit(database, 33, priority=Priority.CI)
    owner = register(database)
    runs = claim(database, owner, 33)
    ends = [finished(run_id) for run_id in runs]
    ends[20] = too_long(runs[20])
    sizes: list[int] = []

    def write(part: Sequence[AttemptEnd]) -> None:
        sizes.append(len(part))
        finish(database, owner, *part)

    write_in_parts(ends, write)
    expected = [RunStatus.FINISHED] * 33
    # A first loss is repeated.
    expected[20] = RunStatus.QUEUED
    assert statuses(database, runs) == expected
    assert len(sizes) <= 14
    with database.read() as transaction:
        (attempt,) = transaction.jobs.attempts(runs[20])
    assert (attempt.outcome, attempt.cause) == ("infrastructure_failed", "unwritable_report")


def test_parts_are_not_tried_while_nothing_can_be_written() -> None:
    tried: list[int] = []

    def write(part: Sequence[AttemptEnd]) -> None:
        tried.append(len(part))
        raise StoreUnavailable("the disk is full")

    with pytest.raises(StoreUnavailable):
        write_in_parts([finished("a"), finished("b"), finished("c")], write)
    assert tried == [1]


def test_ends_and_claims_together_take_one_statement_a_table(database: Database) -> None:
    submit(database, 60, priority=Priority.CI)
    owner = register(database)
    runs = claim(database, owner, 4)
    with statements(database) as sent, database.write() as transaction:
        specs = transaction.queue.finish_and_claim(
            owner, [finished(run_id) for run_id in runs], POLICY, 30, trace_path=no_trace
        )
    assert len(specs) == 30
    for table in ("change_epochs", "facets", "batch_facets", "batches"):
        written = [one for one in sent if re.match(rf'(UPDATE|INSERT INTO) "?{table}\b', one)]
        assert len(written) == 1, table
    assert statuses(database, runs) == [RunStatus.FINISHED] * 4


def test_a_run_that_goes_back_to_the_queue_is_found_by_the_claim_beside(
    database: Database, tmp_path: Path
) -> None:
    submit(database, 3, priority=Priority.CI)
    owner = register(database)
    first, second = claim(database, owner, 2)
    with database.write() as transaction:
        specs = transaction.queue.finish_and_claim(
            owner, [lost(first), finished(second)], POLICY, 1, trace_path=no_trace
        )
    assert [spec.run_id for spec in specs] == [first]
    assert list(verify(database, TraceFolder(tmp_path / "traces"))) == []
