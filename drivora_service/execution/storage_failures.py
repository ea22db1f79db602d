"""Ends of runs that a storage fault may have caused, and reports of those that it did."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import UTC, datetime

from drivora_service.errors import StoreUnavailable
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus

TRACE_NOT_WRITTEN = "trace_not_written"
"""Cause of a run whose trace could not be written."""

_FULL_DISK_MESSAGES = ("No space left on device", "Disk quota exceeded", "Read-only file system")
"""Error messages of the operating system for storage that cannot be written to."""


def may_be_storage(report: RunReport) -> bool:
    """Returns whether a probe of the storage must decide if this is the run's own end.

    It must also for an agent that raised because its log could not be written.
    """
    if report.status is RunStatus.INFRASTRUCTURE_FAILED:
        return True
    failure = report.failure
    return failure is not None and any(sign in failure.message for sign in _FULL_DISK_MESSAGES)


def unpreparable_trace(spec: RunSpec, error: OSError) -> AttemptEnd:
    """Returns the end of a run that was not started because its trace has no folder."""
    now = datetime.now(UTC)
    report = RunReport(
        run_id=spec.run_id,
        status=RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(
            cause=TRACE_NOT_WRITTEN,
            message=f"the folder of the run's trace cannot be made: {error}",
        ),
    )
    return AttemptEnd(report=report, worker="", started=now, ended=now)


def unwritable_report(report: RunReport, error: Exception) -> RunReport:
    """Returns the report that replaces one that cannot be stored."""
    return RunReport(
        run_id=report.run_id,
        status=RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(
            cause="unwritable_report",
            message=f"the report of the {report.status} run cannot be stored: {error!r}"[:500],
        ),
    )


def write_in_parts(
    ends: Sequence[AttemptEnd], write: Callable[[Sequence[AttemptEnd]], None]
) -> None:
    """Writes ends of which one cannot be written: halves, until it is found and replaced.

    Args:
        ends: At least one end; writing all of them together has failed.
        write: Writes some of them in a transaction.

    Raises:
        StoreUnavailable: Nothing can be written now.
    """
    middle = len(ends) // 2
    for part in (ends[:middle], ends[middle:]):
        if not part:
            continue
        try:
            write(part)
        except StoreUnavailable:
            raise
        except Exception as error:
            if len(part) > 1:
                write_in_parts(part, write)
            else:
                write([replace(part[0], report=unwritable_report(part[0].report, error))])
