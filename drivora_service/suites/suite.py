"""A suite as it is run and judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    Counted,
    FailureDefinition,
    KnownFailure,
)
from drivora_service.scenario.documents import ScenarioDocument


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricBounds:
    """Expected values of a metric; ``None``: not bounded on that side."""

    at_least: float | None = None
    at_most: float | None = None

    def hold(self, value: float) -> bool:
        """Returns whether a value is within the bounds."""
        return (self.at_least is None or value >= self.at_least) and (
            self.at_most is None or value <= self.at_most
        )

    def __str__(self) -> str:
        """Returns the bounds in words."""
        parts = (
            f"at least {self.at_least:g}" if self.at_least is not None else "",
            f"at most {self.at_most:g}" if self.at_most is not None else "",
        )
        return " and ".join(filter(None, parts))


@dataclass(frozen=True, slots=True, kw_only=True)
class Difficulty:
    """The ADSs that fail in a scenario, and those that do not."""

    failed_by: tuple[str, ...] = ()
    passed_by: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteScenario:
    """A scenario with what is expected in it.

    Attributes:
        name: Unique in the suite.
        tags: Its own and those of the suite.
        oracles: Oracles whose violations count; ``None``: as the gate says.
        counts: Violations that are failures; ``None``: as the gate says.
        metrics: Expected values by metric, those of the suite included.
        difficulty: ``None``: not known.
    """

    name: str
    document: ScenarioDocument
    tags: tuple[str, ...] = ()
    oracles: frozenset[str] | None = None
    counts: Counted | None = None
    metrics: Mapping[str, MetricBounds] = field(default_factory=dict)
    known_failures: tuple[KnownFailure, ...] = ()
    difficulty: Difficulty | None = None

    def definition(self, gate: FailureDefinition = DEFAULT_DEFINITION) -> FailureDefinition:
        """Returns what counts as a failure in its runs.

        Args:
            gate: What the gate says, where neither the suite nor the scenario says anything.
        """
        return FailureDefinition(
            counts=self.counts or gate.counts,
            oracles=gate.oracles if self.oracles is None else tuple(sorted(self.oracles)),
            known=self.known_failures,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Suite:
    """Scenarios with expectations.

    Attributes:
        repetitions: Runs of each scenario, which differ in their seeds.
    """

    name: str
    description: str
    scenarios: tuple[SuiteScenario, ...]
    repetitions: int = 1

    @property
    def by_name(self) -> Mapping[str, SuiteScenario]:
        """The scenarios by name."""
        return {one.name: one for one in self.scenarios}
