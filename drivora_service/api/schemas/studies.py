"""Studies: campaigns by scenarios, agents, methods and repetitions."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.oracles.verdicts.failure_definition import (
    StatedDefinition,
    definition_of,
    state_definition,
)
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning
from drivora_service.store.campaigns.missing_results import MissingResult
from drivora_service.store.campaigns.study_records import (
    StudyRecord,
    StudyScene,
    StudyState,
    StudySummary,
    state_of,
    study_warnings,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyInList(StudySummary):
    """A study in a list, with its state."""

    state: StudyState


@dataclass(frozen=True, slots=True, kw_only=True)
class Study(StudyRecord):
    """A study, its progress and its definition.

    Attributes:
        definition: What its campaigns count as failures.
        missing_results: Why runs have no result, the most frequent reason first.
        notes: Warnings; in the answer to posting only.
        warnings: Warnings that a scene says little: its seed fails, or all or none of its
            simulations do.
        campaigns_url: Address of its campaigns.
    """

    state: StudyState
    definition: StatedDefinition
    missing_results: tuple[MissingResult, ...] = ()
    notes: tuple[str, ...] = ()
    warnings: tuple[CampaignWarning, ...] = ()
    campaigns_url: str


class StudyValidation(Schema):
    """A study that can be run."""

    valid: bool
    scenarios: int
    agents: int = Field(description="ADSs; 1 if they are those of the scenarios.")
    methods: int
    repetitions: int
    campaigns: int = Field(description="Of each scenario, ADS, method and repetition.")
    simulations: int = Field(description="Of all campaigns together, at most.")
    genes: int = Field(
        description="Numbers that describe a candidate; the most, if the campaigns differ."
    )
    notes: tuple[str, ...] = Field(description="Warnings.")


def study_in_list(study: StudySummary, *, has_process: bool) -> StudyInList:
    """Returns a study for a list.

    Args:
        study: The study.
        has_process: Whether the process of a command runs it.
    """
    return combine(StudyInList, study, state=state_of(study, has_process=has_process))


def study_of(
    study: StudyRecord,
    scenes: tuple[StudyScene, ...],
    base: str,
    *,
    has_process: bool,
    missing: tuple[MissingResult, ...] = (),
    notes: tuple[str, ...] = (),
) -> Study:
    """Returns a study with its addresses.

    Args:
        study: The study.
        scenes: What it has found by seed scenario and ADS.
        base: Address of the API.
        has_process: Whether the process of a command runs it.
        missing: Why runs have no result.
        notes: Warnings.
    """
    return combine(
        Study,
        study,
        definition=state_definition((definition_of(study.document),)),
        state=state_of(study, has_process=has_process),
        missing_results=missing,
        notes=notes,
        warnings=study_warnings(scenes),
        campaigns_url=f"{base}/campaigns?study={study.id}",
    )
