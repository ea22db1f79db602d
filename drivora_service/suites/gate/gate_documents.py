"""The gate document: what a suite's results must satisfy."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from drivora_service.campaigns.document.campaign_documents import OracleNames
from drivora_service.oracles.verdict import Severity
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.scenario.entities import EntityDocument
from drivora_service.suites.gate.failure_classes import FailureClass

_Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
_Share = Annotated[float, Field(strict=True, ge=0.0, le=1.0, json_schema_extra={"x-unit": "1"})]
_Probability = Annotated[
    float, Field(strict=True, gt=0.0, lt=1.0, json_schema_extra={"x-unit": "1"})
]
_Count = Annotated[int, Field(strict=True, ge=0, le=10_000_000, json_schema_extra={"x-unit": "1"})]


class LimitDocument(EntityDocument):
    """The number of scenarios, or the share of runs, in which certain violations may occur."""

    oracles: OracleNames | None = Field(
        None, description="These violated oracles; without it, those that count as failures."
    )
    severity: Annotated[tuple[Severity, ...], Field(min_length=1)] | None = Field(
        None, description="Violations of these severities; without it, of any."
    )
    accountability: Annotated[tuple[Accountability, ...], Field(min_length=1)] | None = Field(
        None,
        description="Violations with these degrees of accountability; without it, those that "
        "count as failures.",
    )
    most_scenarios: _Count | None = Field(
        None, description="Greatest number of scenarios with such a violation in any of their runs."
    )
    most_share: _Share | None = Field(
        None,
        description="Greatest share of the runs. With repetitions, the gate fails only if the "
        "confidence interval lies above it.",
    )

    @model_validator(mode="after")
    def _has_a_limit(self) -> LimitDocument:
        if (self.most_scenarios is None) == (self.most_share is None):
            raise PydanticCustomError("no_limit", "give one of `most_scenarios` and `most_share`")
        return self


class MetricLimitDocument(EntityDocument):
    """The mean of a metric over the suite."""

    metric: Annotated[str, Field(strict=True, min_length=1, max_length=200)] = Field(
        description="Name of the metric."
    )
    at_least: _Number | None = Field(None, description="Smallest mean.")
    at_most: _Number | None = Field(None, description="Greatest mean.")
    most_drop: Annotated[_Number, Field(ge=0.0)] | None = Field(
        None, description="Greatest decrease of the mean against the baseline."
    )
    most_rise: Annotated[_Number, Field(ge=0.0)] | None = Field(
        None, description="Greatest increase of the mean against the baseline."
    )

    @model_validator(mode="after")
    def _has_a_limit(self) -> MetricLimitDocument:
        if {self.at_least, self.at_most, self.most_drop, self.most_rise} == {None}:
            raise PydanticCustomError(
                "no_limit", "give one of `at_least`, `at_most`, `most_drop` and `most_rise`"
            )
        return self


class GateDocument(EntityDocument):
    """What the results of a suite must satisfy."""

    version: Literal["1.0"] = Field("1.0", description="Version of this format.")
    counts: Counted = Field(
        Counted.ACCOUNTABLE,
        description="Violations that are failures in scenarios without `counts`: those that an ego "
        "is accountable for; also those at the fault of others that a careful driver avoids "
        "(preventable); also unavoidable ones (at_fault), and those of undetermined fault "
        "(possibly_at_fault); or those of others, too (any).",
    )
    oracles: OracleNames | None = Field(
        None,
        description="Oracles that count in scenarios that name none; without it, all but "
        "observations.",
    )
    fail_on: Annotated[tuple[FailureClass, ...], Field(max_length=10)] = Field(
        (FailureClass.NEW, FailureClass.WORSE),
        description="Classes of failures, against the baseline, with which the gate fails.",
    )
    limits: Annotated[tuple[LimitDocument, ...], Field(max_length=100)] = Field(
        (), description="Limits on violations."
    )
    metrics: Annotated[tuple[MetricLimitDocument, ...], Field(max_length=100)] = Field(
        (), description="Limits on means of metrics."
    )
    confirm: Annotated[int, Field(strict=True, ge=0, le=100)] = Field(
        4,
        description="Further runs, under other seeds, of each scenario with a new failure before "
        "the gate decides; 0: none.",
    )
    alpha: _Probability = Field(
        0.01,
        description="Probability with which a failure that occurs in some runs of a scenario may "
        "be called new or worse by chance, over all of them.",
    )
    overall: _Probability | None = Field(
        0.001,
        description="The gate fails if the failures of all scenarios together are more frequent "
        "than in the baseline with a p below this; null: not tested.",
    )
    confidence: _Probability = Field(0.95, description="Level of confidence intervals.")
    unfinished: Literal["fail", "ignore"] = Field(
        "fail", description="Whether the gate fails if a run was not judged."
    )

    @property
    def definition(self) -> FailureDefinition:
        """What counts as a failure in scenarios that do not say it themselves."""
        oracles = None if self.oracles is None else tuple(sorted(self.oracles))
        return FailureDefinition(counts=self.counts, oracles=oracles)
