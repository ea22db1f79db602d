"""The suite document: scenarios with what is expected of an ADS in each."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from drivora_service.campaigns.document.campaign_documents import OracleNames, PluginName
from drivora_service.given_names import CHECKED_NAME, CHECKED_NOTE
from drivora_service.oracles.verdicts.failure_definition import Counted, KnownFailure
from drivora_service.scenario import fields
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import EntityDocument
from drivora_service.studies.study_documents import Label

MAX_SCENARIOS = 10_000
"""Greatest number of scenarios of a suite: that of a batch."""

MAX_REPETITIONS = 1000

EXTENSION = "drivora:suite"
"""Key of a scenario's extensions that holds its expectations."""

_TAG_PATTERN = r"^[A-Za-z0-9_.:-]{1,64}$"


Tag = Annotated[str, Field(strict=True, pattern=_TAG_PATTERN)]
Tags = Annotated[tuple[Tag, ...], Field(max_length=100)]
Repetitions = Annotated[
    int, Field(strict=True, ge=1, le=MAX_REPETITIONS, json_schema_extra={"x-unit": "1"})
]
_Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]


class MetricBoundsDocument(EntityDocument):
    """The values of a metric that are expected of a run."""

    at_least: _Number | None = Field(None, description="Smallest expected value.")
    at_most: _Number | None = Field(None, description="Greatest expected value.")

    @model_validator(mode="after")
    def _has_a_bound(self) -> MetricBoundsDocument:
        low, high = self.at_least, self.at_most
        if low is None and high is None:
            raise PydanticCustomError("no_bound", "found no bound; give `at_least` or `at_most`")
        if low is not None and high is not None and low > high:
            raise PydanticCustomError(
                "empty_range", "found an `at_least` above `at_most`; no value is between them"
            )
        return self


MetricBounds = Annotated[
    dict[str, MetricBoundsDocument],
    Field(max_length=100, description="Expected values of metrics, by name."),
]


class KnownFailureDocument(EntityDocument):
    """A failure that is known and does not count."""

    oracle: PluginName | None = Field(
        None, description="Violated oracle, or `agent_failed`; without it, any."
    )
    ego: Annotated[str, Field(strict=True, pattern=fields.ID_PATTERN)] | None = Field(
        None, description="Id of the ego; without it, any."
    )
    counterpart: Annotated[str, Field(strict=True, max_length=256), CHECKED_NAME] | None = Field(
        None, description="Id of the other actor; without it, any."
    )
    agents: Annotated[tuple[fields.AgentName, ...], Field(max_length=1000)] = Field(
        (), description="ADSs of which it is known; without any, of every one."
    )
    reason: Label = Field(description="Why it does not count, for reports.")

    @property
    def known_failure(self) -> KnownFailure:
        """It as a value."""
        return KnownFailure(
            oracle=self.oracle or "",
            ego=self.ego or "",
            counterpart=self.counterpart or "",
            agents=tuple(sorted(self.agents)),
            reason=self.reason,
        )


class DifficultyDocument(EntityDocument):
    """Which ADSs fail in a scenario; for people, and for choosing scenarios."""

    failed_by: Annotated[tuple[fields.AgentName, ...], Field(max_length=1000)] = Field(
        (), description="ADSs that fail."
    )
    passed_by: Annotated[tuple[fields.AgentName, ...], Field(max_length=1000)] = Field(
        (), description="ADSs that do not."
    )


class ExpectationsDocument(EntityDocument):
    """What is expected in a scenario.

    A scenario may carry this itself, under `drivora:suite` of its `extensions`, so that a suite can
    list it by a pattern.
    """

    tags: Tags = Field((), description="Words by which it can be chosen.")
    oracles: OracleNames | None = Field(
        None, description="Oracles whose violations count, in place of those of the suite."
    )
    counts: Counted | None = Field(
        None,
        description="Violations that are failures, in place of what the suite says; see the gate.",
    )
    metrics: MetricBounds = Field(default_factory=dict)
    known_failures: Annotated[tuple[KnownFailureDocument, ...], Field(max_length=100)] = Field(
        (), description="Failures that are known and do not count."
    )
    difficulty: DifficultyDocument | None = Field(None, description="Which ADSs fail in it.")
    comment: Annotated[str, Field(strict=True, max_length=10_000), CHECKED_NOTE] = Field(
        "", description="For people."
    )


class SuiteScenarioDocument(ExpectationsDocument):
    """A scenario of the suite.

    What it says is added to what the scenario itself says, or replaces it.
    """

    name: Label = Field(description="Its name, unique in the suite.")
    document: ScenarioDocument = Field(description="The scenario.")


class SuiteDocument(EntityDocument):
    """Scenarios, and what is expected of an ADS in each."""

    version: Literal["1.0"] = Field("1.0", description="Version of this format.")
    name: Label = Field(description="Display name.")
    description: Annotated[str, Field(strict=True, max_length=10_000), CHECKED_NOTE] = Field(
        "", description="For people."
    )
    scenarios: Annotated[
        tuple[SuiteScenarioDocument, ...], Field(min_length=1, max_length=MAX_SCENARIOS)
    ] = Field(description="The scenarios.")
    repetitions: Repetitions = Field(
        1,
        description="Number of runs of each scenario: the first under its own seed, each further "
        "one under another.",
    )
    tags: Tags = Field((), description="Tags of every scenario.")
    oracles: OracleNames | None = Field(
        None,
        description="Oracles whose violations count; without it, those that the gate names, or "
        "all but observations.",
    )
    counts: Counted | None = Field(
        None,
        description="Violations that are failures, as in a gate; without it, what the gate says.",
    )
    metrics: MetricBounds = Field(default_factory=dict)
