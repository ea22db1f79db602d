"""The study document: campaigns by scenarios, agents, methods and repetitions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from drivora_service.campaigns.document.campaign import DEFAULT_LOOKAHEAD
from drivora_service.campaigns.document.campaign_documents import (
    BudgetDocument,
    Lookahead,
    OracleNames,
    SpaceDocument,
    TesterDocument,
    Workers,
)
from drivora_service.campaigns.document.feedback_documents import FeedbackDocument
from drivora_service.given_names import CHECKED_NAME
from drivora_service.oracles.verdicts.failure_definition import Counted
from drivora_service.scenario import fields
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import AgentDocument, EntityDocument
from drivora_service.store.campaigns.study_records import LONGEST_LABEL

MAX_CAMPAIGNS = 10_000
"""Greatest number of campaigns of a study."""

AS_IN_SCENARIO = "as in the scenario"
"""Label of the agents of a study that names none."""

_WITHOUT_FEEDBACK = " without feedback"


def _without_outer_blanks(text: str) -> str:
    if text != text.strip():
        raise PydanticCustomError("outer_blanks", "found a blank at one of its ends; remove it")
    return text


Label = Annotated[
    str,
    Field(strict=True, min_length=1, max_length=LONGEST_LABEL),
    CHECKED_NAME,
    AfterValidator(_without_outer_blanks),
]


class StudyScenarioDocument(EntityDocument):
    """A seed scenario of the study."""

    document: ScenarioDocument = Field(description="The seed scenario.")
    label: Label | None = Field(
        None, description="Its name in the study; without it, its town and place in the list."
    )
    space: SpaceDocument | None = Field(
        None, description="Its variable parts, in place of those of the study."
    )


class StudyAgentDocument(AgentDocument):
    """An ADS of the study, with its parameters."""

    label: Label | None = Field(None, description="Its name in the study; without it, its name.")


class StudyMethodDocument(TesterDocument):
    """A testing method of the study, with its parameters."""

    label: Label | None = Field(
        None,
        description="Its name in the study; without it, that of the tester, with `without "
        "feedback` if that is shuffled, and with `by` and the names of `minimises`, and with "
        "`from failures` or `from elites` if it starts from those.",
    )
    minimises: FeedbackDocument | None = Field(
        None, description="What it minimises, in place of the `feedback` of the study."
    )


class StudyDocument(EntityDocument):
    """A campaign for each scenario, agent, method and repetition."""

    version: Literal["1.0"] = Field("1.0", description="Version of this format.")
    name: Label = Field(description="Display name.")
    scenarios: Annotated[
        tuple[StudyScenarioDocument, ...], Field(min_length=1, max_length=MAX_CAMPAIGNS)
    ] = Field(description="The seed scenarios.")
    agents: Annotated[tuple[StudyAgentDocument, ...], Field(max_length=1000)] = Field(
        (), description="The ADSs, each of which drives every ego; without any, as in the scenario."
    )
    methods: Annotated[tuple[StudyMethodDocument, ...], Field(min_length=1, max_length=1000)] = (
        Field(description="The testing methods.")
    )
    repetitions: Annotated[
        int, Field(strict=True, ge=1, le=1000, json_schema_extra={"x-unit": "1"})
    ] = Field(1, description="Number of campaigns of each method, which differ in their seeds.")
    seed: fields.Seed = Field(
        1, description="Seed of the first repetition; each further one has the next."
    )
    space: SpaceDocument = Field(
        default_factory=SpaceDocument, description="The variable parts and their ranges."
    )
    budget: BudgetDocument = Field(description="The budget of each campaign.")
    counts: Counted = Field(
        Counted.ACCOUNTABLE,
        description="Violations that are failures: those that an ego is accountable for; also "
        "those at the fault of others that a careful driver avoids (preventable); also unavoidable "
        "ones (at_fault), and those of undetermined fault (possibly_at_fault); or those of others, "
        "too (any).",
    )
    oracles: OracleNames | None = Field(
        None, description="The only oracles that count; without it, all but observations."
    )
    feedback: FeedbackDocument | None = Field(
        None,
        description="What every method minimises; without it, what its own feedback measures.",
    )
    workers: Workers | None = Field(
        None,
        description="Worker processes of all campaigns together, in a command; without it, as many "
        "as the installation has. A service has its own.",
    )
    lookahead: Lookahead = Field(
        DEFAULT_LOOKAHEAD,
        description="Number of candidates of a campaign that may wait for their results.",
    )

    @property
    def scenario_labels(self) -> tuple[str, ...]:
        """The names of the scenarios in the study."""
        return tuple(
            one.label or f"{one.document.map_region.town} {place}"
            for place, one in enumerate(self.scenarios, start=1)
        )

    @property
    def agent_labels(self) -> tuple[str, ...]:
        """The names of the agents in the study."""
        return tuple(one.label or one.name for one in self.agents) or (AS_IN_SCENARIO,)

    @property
    def method_labels(self) -> tuple[str, ...]:
        """The names of the methods in the study."""
        return tuple(
            one.label
            or one.name
            + ("" if one.minimises is None else f" by {one.minimises.words}")
            + (_WITHOUT_FEEDBACK if one.feedback == "shuffled" else "")
            + ("" if one.start_from is None else f" from {one.start_from.kind}")
            for one in self.methods
        )

    @property
    def size(self) -> int:
        """The number of campaigns."""
        combinations = len(self.scenarios) * len(self.agent_labels) * len(self.methods)
        return combinations * self.repetitions


def study_text(document: StudyDocument) -> str:
    """Writes a document as JSON that reads back to an equal one."""
    return document.model_dump_json(exclude_none=True)
