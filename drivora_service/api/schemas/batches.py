"""Batches: scenarios that were posted together."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum

from pydantic import Field

from drivora_service.api.problems import ProblemItem
from drivora_service.api.schemas.base import Schema
from drivora_service.runs.report import RunStatus
from drivora_service.store.records import BatchRecord, BatchState


class PriorityName(StrEnum):
    """Whose runs go first: interactive, then ci, then campaign."""

    INTERACTIVE = "interactive"
    CI = "ci"
    CAMPAIGN = "campaign"


class Batch(Schema):
    """A batch and how far it is."""

    id: str
    name: str
    priority: PriorityName
    state: BatchState
    created_at: datetime
    size: int = Field(description="Runs in it.")
    done: bool = Field(description="Whether every run has ended.")
    counts: dict[RunStatus, int] = Field(description="Runs by status.")
    violated_runs: int = Field(description="Finished runs with at least one broken rule.")
    jobs_url: str


class ItemResult(StrEnum):
    """What became of one scenario of a batch."""

    ACCEPTED = "accepted"
    REJECTED = "rejected"


class BatchItem(Schema):
    """One scenario of a batch: a job, or the reasons why not."""

    item: int = Field(description="Place in the request, from 0.")
    result: ItemResult
    job_id: str = Field(default="", description="Empty if rejected.")
    problems: tuple[ProblemItem, ...] = Field(
        default=(), description="Every problem; pointers are into the one scenario."
    )


class BatchSubmission(Schema):
    """The answer to a batch."""

    batch: Batch
    accepted: int
    rejected: int
    items: tuple[BatchItem, ...]


def batch_view(record: BatchRecord, base: str) -> Batch:
    """Gives a batch as the API shows it; ``base`` is the address of the API."""
    return Batch(
        id=record.id,
        name=record.name,
        priority=PriorityName(record.priority.name.lower()),
        state=record.state,
        created_at=record.created_at,
        size=record.size,
        done=record.is_done,
        counts=dict(record.counts),
        violated_runs=record.violated_runs,
        jobs_url=f"{base}/jobs?batch={record.id}",
    )
