"""Warnings about a campaign while it runs, each once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from drivora_service.campaigns.search.engine import Told
from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import CampaignCounts
from drivora_service.store.campaigns.campaign_warnings import (
    CampaignWarning,
    WarningCode,
    campaign_warnings,
)
from drivora_service.store.campaigns.seed_run_records import SeedRun


class WarningWatch:
    """Counts what a campaign finds, and passes on each kind of warning when it first applies."""

    def __init__(self, on_warning: Callable[[CampaignWarning], None]) -> None:
        """Creates the watch of a campaign that has found nothing yet."""
        self._on_warning = on_warning
        self._counts = CampaignCounts()
        self._seeds: list[SeedRun] = []
        self._given: set[WarningCode] = set()

    def see_seed(self, run: SeedRun) -> None:
        """Takes the run of a seed scenario."""
        self._seeds.append(run)
        self._look(is_finished=False)

    def see_evaluation(self, told: Told) -> None:
        """Takes an evaluation."""
        record, counts = told.record, self._counts
        self._counts = replace(
            counts,
            evaluations=counts.evaluations + 1,
            judged=counts.judged + (record.status is EvaluationStatus.JUDGED),
            failed=counts.failed + (record.status is EvaluationStatus.FAILED),
            violating=counts.violating + bool(record.violations),
            agent_failed=(counts.agent_failed or 0)
            + (record.report.status is RunStatus.AGENT_FAILED),
        )
        self._look(is_finished=False)

    def end(self) -> None:
        """Takes that the search has spent its budget."""
        self._look(is_finished=True)

    def _look(self, *, is_finished: bool) -> None:
        for warning in campaign_warnings(self._counts, self._seeds, is_finished=is_finished):
            if warning.code not in self._given:
                self._given.add(warning.code)
                self._on_warning(warning)
