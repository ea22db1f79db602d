"""The retention times of the settings."""

from __future__ import annotations

from datetime import timedelta

from drivora_service.settings import Settings
from drivora_service.store.upkeep.retention import Retention


def retention(settings: Settings) -> Retention:
    """Returns the retention times of the settings."""
    return Retention(
        passed_traces=_days(settings.retain_passed_traces_days),
        passed_runs=_days(settings.retain_passed_runs_days),
        failing_traces=_days(settings.retain_failing_traces_days),
        failing_runs=_days(settings.retain_failing_runs_days),
        campaign_traces=_days(settings.retain_campaign_traces_days),
    )


def _days(number: float | None) -> timedelta | None:
    return None if number is None else timedelta(days=number)
