"""Values of studies that the store reads and writes, apart from its rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from enum import StrEnum
from typing import Any

from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import (
    CampaignCounts,
    CampaignRequest,
    CampaignState,
)
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning, campaign_warnings
from drivora_service.store.campaigns.seed_run_records import SeedRun

LONGEST_LABEL = 100
"""Characters of a name in a study."""


class StudyState(StrEnum):
    """The state of a study, which follows from those of its campaigns."""

    QUEUED = "queued"
    RUNNING = "running"
    PAUSED = "paused"
    FINISHED = "finished"
    FAILED = "failed"
    """A campaign of it has failed, and none runs or waits; the study may be resumed."""
    CANCELLED = "cancelled"
    """A campaign of it was cancelled, and all others have finished."""
    INTERRUPTED = "interrupted"
    """The process of the command that ran it was killed; it may be resumed."""

    @property
    def is_active(self) -> bool:
        """Whether it runs, or waits for a process that will run it."""
        return self in (StudyState.QUEUED, StudyState.RUNNING)


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyScene:
    """The campaigns of a study with one seed scenario and one ADS, all methods together.

    Attributes:
        scenario: Name of the seed scenario in the study.
        agent: Name of the ADS in the study.
        counts: Sum of the counts of its campaigns.
        seed_runs: The runs of the seed scenario as it is.
        is_finished: Whether all of its campaigns are finished.
    """

    scenario: str
    agent: str
    counts: CampaignCounts
    seed_runs: tuple[SeedRun, ...]
    is_finished: bool


def study_warnings(scenes: Iterable[StudyScene]) -> tuple[CampaignWarning, ...]:
    """Returns the warnings about the scenes of a study, with their names, scene by scene."""
    return tuple(
        replace(warning, message=f"{scene.scenario}, {scene.agent}: {warning.message}")
        for scene in scenes
        for warning in campaign_warnings(
            scene.counts, scene.seed_runs, is_finished=scene.is_finished
        )
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class StudySummary(Shape):
    """A study in a list, with its progress.

    Attributes:
        request: Pending request to a study whose campaigns run.
        campaigns: Number of campaigns by their states.
        budget: Simulations of all campaigns.
        simulations: Simulations so far.
        counts: Counts of the evaluations of all campaigns so far.
        is_on_service: Whether a service runs its campaigns.
        updated_at: When a campaign of it was last told an evaluation, or changed its state.
        revision: Count of all changes at its newest one, those of its campaigns included.
    """

    id: str
    name: str
    request: CampaignRequest
    campaigns: Mapping[CampaignState, int]
    budget: int
    simulations: int
    counts: CampaignCounts
    is_on_service: bool
    created_at: datetime
    updated_at: datetime
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyRecord(StudySummary):
    """A study with what defines it.

    Attributes:
        document: As posted, with defaults filled in.
    """

    document: Mapping[str, Any]


def state_of(study: StudySummary, *, has_process: bool) -> StudyState:
    """Returns the state of a study.

    Args:
        study: The study.
        has_process: Whether the process of a command runs it.
    """
    counts = study.campaigns
    waiting = counts.get(CampaignState.QUEUED, 0)
    if waiting or counts.get(CampaignState.RUNNING, 0):
        if study.is_on_service or has_process:
            begun = set(counts) - {CampaignState.QUEUED} or study.simulations
            return StudyState.RUNNING if begun or has_process else StudyState.QUEUED
        paused = study.request is CampaignRequest.PAUSE
        return StudyState.PAUSED if paused else StudyState.INTERRUPTED
    if has_process and study.request is CampaignRequest.NONE and _may_go_on(counts):
        # The process has the study, and has not begun with its campaigns.
        return StudyState.RUNNING
    for state in (CampaignState.PAUSED, CampaignState.FAILED, CampaignState.CANCELLED):
        if counts.get(state, 0):
            return StudyState(state.value)
    return StudyState.FINISHED


def _may_go_on(counts: Mapping[CampaignState, int]) -> bool:
    return any(number and not state.is_over for state, number in counts.items())
