"""Jobs: a scenario that was posted, and where its run is in its life."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.runs.run_report import RunFailure
from drivora_service.shapes import combine
from drivora_service.store.runs.run_records import RunRecord, RunSummary


@dataclass(frozen=True, slots=True, kw_only=True)
class Job(RunSummary):
    """A job, with the reason if its run failed.

    Attributes:
        error: Why the run was not judged.
        run_url: Address of the run's result.
    """

    error: RunFailure | None = None
    run_url: str


def job_of(run: RunRecord, base: str) -> Job:
    """Returns the job of a run; ``base`` is the address of the API."""
    return combine(Job, run, run_url=f"{base}/runs/{run.id}")
