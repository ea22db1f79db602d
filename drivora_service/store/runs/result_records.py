"""Values for reading the results of many runs at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.store.runs.run_records import JobFilter


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultFilter:
    """A choice of runs, by where they belong and by their own attributes.

    A run is chosen if any of the batches, campaigns or studies has it, or if none is named, and if
    it passes ``runs``.

    Attributes:
        batch_ids: Ids of batches.
        campaign_ids: Ids of campaigns.
        study_ids: Ids of studies.
        runs: Conditions on a run; its own batch and campaign are not looked at.
    """

    batch_ids: tuple[str, ...] = ()
    campaign_ids: tuple[str, ...] = ()
    study_ids: tuple[str, ...] = ()
    runs: JobFilter = field(default_factory=JobFilter)

    @property
    def names_any(self) -> bool:
        """Whether it names batches, campaigns or studies."""
        return bool(self.batch_ids or self.campaign_ids or self.study_ids)


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredResult:
    """A run with its report.

    Attributes:
        values: What is known of the run besides its report, by column of the table ``runs``; text
            that there is none of is empty or ``None``.
        report: The report as plain JSON values; empty until the run has ended.
        definition: What counts as a failure of the run.
    """

    values: Mapping[str, Any]
    report: Mapping[str, Any]
    definition: FailureDefinition


@dataclass(frozen=True, slots=True, order=True)
class EvaluationPlace:
    """The place of an evaluation in the order of reading: its campaign's, then its number."""

    campaign_seq: int
    number: int
