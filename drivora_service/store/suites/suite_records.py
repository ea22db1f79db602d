"""Suites that were run, with the decisions of their gates, as values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from drivora_service.shapes import Shape


class ScenarioState(StrEnum):
    """What became of a scenario of a suite; those that need a decision come first."""

    FAILS_GATE = "fails_gate"
    NOT_JUDGED = "not_judged"
    FLAKY = "flaky"
    FAILS = "fails"
    """As the baseline accepts it."""
    KNOWN = "known"
    """By known failures only."""
    PASSES = "passes"


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteEstimate(Shape):
    """A share or a mean with its interval at 95 %.

    Attributes:
        mean: The share or the mean.
        low: Lower end; null without an interval.
        high: Upper end; null without an interval.
    """

    mean: float
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteOutcome(Shape):
    """What became of a scenario in a run of its suite.

    Attributes:
        scenario: Its name in the suite.
        failing: Judged runs with the failure that occurs most often.
        judged: Judged runs.
        score: Mean driving score; null: not measurable.
        run_id: A run to look at: one that fails, if any does; empty if none was made.
        failures: What fails, a sentence each.
    """

    scenario: str
    state: ScenarioState
    failing: int
    judged: int
    score: float | None
    run_id: str
    failures: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteDecision(Shape):
    """What a gate decided on a run of a suite.

    Attributes:
        suite: Name of the suite.
        agent: ADS that drove every ego; empty: as in the scenarios.
        agent_parameters: Its parameters that were set, as `NAME=VALUE`.
        configuration: The ADS with the parameters that differ from its defaults; empty if the
            scenarios have different ones, or if it was not recorded.
        configuration_id: Short id of the ADS with all its parameters; empty likewise.
        fails: Whether the gate fails.
        sentence: How things stand, in one sentence.
        reasons: Why the gate fails, one sentence each.
        counts: Number of failures of each class.
        baseline: Name of the baseline; empty without one.
        scenarios: Number of scenarios that were run.
        passing: Number of those without a failure but known ones, all of whose runs were judged.
        judged_runs: Number of runs that were judged.
        pass_rate: Share of scenarios that pass, with the interval of Wilson (1927).
        score: Mean driving score of the scenarios, with Student's interval; null: not measurable.
        versions: Versions of the software that took part, by name.
        definition: What counts as a failure, in words; empty if it was not recorded.
    """

    suite: str
    agent: str
    agent_parameters: tuple[str, ...]
    configuration: str = ""
    configuration_id: str = ""
    fails: bool
    sentence: str
    reasons: tuple[str, ...]
    counts: Mapping[str, int]
    baseline: str
    scenarios: int
    passing: int
    judged_runs: int
    pass_rate: SuiteEstimate
    score: SuiteEstimate | None
    versions: Mapping[str, str]
    definition: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteRunSummary(SuiteDecision):
    """A run of a suite in a list.

    Attributes:
        id: Of this run of the suite.
        created_at: When it was told.
        revision: Count of all changes at its newest one.
    """

    id: str
    created_at: datetime
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteRunRecord(SuiteRunSummary):
    """A run of a suite, with what became of its scenarios.

    Attributes:
        outcomes: In the order of the suite.
    """

    outcomes: tuple[SuiteOutcome, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteSummary(Shape):
    """A suite that was run.

    Attributes:
        suite: Its name.
        runs: How often it was run.
        last: The last of these runs.
    """

    suite: str
    runs: int
    last: SuiteRunSummary


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioHistory(Shape):
    """What became of a scenario in the last runs of its suite.

    Attributes:
        scenario: Its name in the suite.
        outcomes: One for each of these runs, in their order; null where it was not run.
    """

    scenario: str
    outcomes: tuple[SuiteOutcome | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteHistory(Shape):
    """The last runs of a suite, and what became of its scenarios in them.

    Attributes:
        suite: Its name.
        runs: Oldest first.
        scenarios: Those that any of these runs had, in the order of the last that had them; those
            that changed in the last run come first.
    """

    suite: str
    runs: tuple[SuiteRunSummary, ...]
    scenarios: tuple[ScenarioHistory, ...]
