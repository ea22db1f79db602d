"""Suites that were run, with the decisions of their gates."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field, model_validator

from drivora_service.agents.configuration import ID_LENGTH
from drivora_service.api.schemas.base import Schema
from drivora_service.given_names import describe_name_fault
from drivora_service.shapes import Shape
from drivora_service.store.suites.suite_records import SuiteDecision, SuiteOutcome, SuiteSummary

MOST_SCENARIOS = 20_000
"""Of a suite of which a run is posted."""
_LONGEST_NAME = 200


class SuiteRunRequest(Schema):
    """A run of a suite that was decided, as `drivora suite run` tells it."""

    decision: SuiteDecision = Field(description="What its gate decided.")
    outcomes: tuple[SuiteOutcome, ...] = Field(
        max_length=MOST_SCENARIOS,
        description="What became of each scenario, in the order of the suite.",
    )

    @model_validator(mode="after")
    def _agree(self) -> SuiteRunRequest:
        names = [one.scenario for one in self.outcomes]
        if len(set(names)) != len(names):
            raise ValueError("each scenario of a suite has one outcome")
        if len(names) != self.decision.scenarios:
            raise ValueError(
                f"the decision counts {self.decision.scenarios} scenarios, and there are "
                f"{len(names)} outcomes"
            )
        if not 0 <= self.decision.passing <= self.decision.scenarios:
            raise ValueError("more scenarios pass than there are")
        if not 1 <= len(self.decision.suite) <= _LONGEST_NAME:
            raise ValueError(f"the name of a suite has 1 to {_LONGEST_NAME} characters")
        if len(self.decision.agent) > _LONGEST_NAME:
            raise ValueError(f"the name of an ADS has at most {_LONGEST_NAME} characters")
        if len(self.decision.configuration_id) > ID_LENGTH:
            raise ValueError(f"the id of a configuration has at most {ID_LENGTH} characters")
        for what, name in (
            ("suite", self.decision.suite),
            ("ADS", self.decision.agent),
            ("baseline", self.decision.baseline),
            *(("scenario", one.scenario) for one in self.outcomes),
        ):
            if fault := describe_name_fault(name):
                raise ValueError(f"the name of {what} {name[:80]!r}: {fault}")
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteList(Shape):
    """All suites that were run.

    Attributes:
        items: The last run first.
    """

    items: tuple[SuiteSummary, ...]
