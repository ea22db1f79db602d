"""Batches: scenarios that were posted together."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.api.schemas.problems import ProblemItem
from drivora_service.campaigns.document.campaign_documents import OracleNames
from drivora_service.given_names import CHECKED_NAME
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    StatedDefinition,
)
from drivora_service.scenario import fields
from drivora_service.shapes import Shape, combine
from drivora_service.store.runs import run_records
from drivora_service.store.runs.run_records import LONGEST_LABEL
from drivora_service.suites.suite_documents import KnownFailureDocument


class PostedFailures(Schema):
    """What is a failure of a run."""

    counts: Counted = Field(Counted.ACCOUNTABLE, description="The violations that are failures.")
    oracles: OracleNames | None = Field(
        None, description="The only oracles that count; without it, all but observations."
    )
    known: Annotated[tuple[KnownFailureDocument, ...], Field(max_length=100)] = Field(
        (), description="Failures that are known and do not count."
    )

    @property
    def definition(self) -> FailureDefinition:
        """It as a value."""
        return FailureDefinition(
            counts=self.counts,
            oracles=None if self.oracles is None else tuple(sorted(self.oracles)),
            known=tuple(one.known_failure for one in self.known),
        )


class LabelledScenario(Schema):
    """A scenario of a batch, with what belongs to its run."""

    label: Annotated[str, Field(strict=True, max_length=LONGEST_LABEL), CHECKED_NAME] = Field(
        description="Display name."
    )
    seed: fields.Seed | None = Field(
        None, description="Overrides the seeds of the request and of the scenario."
    )
    failures: PostedFailures | None = Field(
        None, description="What is a failure of its run, in place of what the request says."
    )
    scenario: dict[str, Any] = Field(description="The scenario.")


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch(run_records.Batch):
    """A batch and its progress.

    Attributes:
        jobs_url: Address of its jobs.
        definition: What `failing_runs` counts; null in lists and in answers to commands.
    """

    jobs_url: str
    definition: StatedDefinition | None = None


class ItemResult(StrEnum):
    """The result of one scenario of a batch."""

    ACCEPTED = "accepted"
    REJECTED = "rejected"


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchItem(Shape):
    """One scenario of a batch: a job, or the reasons why not.

    Attributes:
        item: Place in the request, from 0.
        job_id: Empty if rejected.
        problems: Every problem; pointers are into the item, so that those of a scenario with a
            label begin with `/scenario`.
        notes: Remarks of validation.
    """

    item: int
    result: ItemResult
    job_id: str = ""
    problems: tuple[ProblemItem, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchSubmission(Shape):
    """The answer to a batch."""

    batch: Batch
    accepted: int
    rejected: int
    items: tuple[BatchItem, ...]


def batch_of(
    batch: run_records.Batch, base: str, definition: StatedDefinition | None = None
) -> Batch:
    """Returns a batch with the address of its jobs.

    Args:
        batch: The batch.
        base: Address of the API.
        definition: What counts as a failure of its runs; ``None`` where that is not read.
    """
    return combine(Batch, batch, jobs_url=f"{base}/jobs?batch={batch.id}", definition=definition)
