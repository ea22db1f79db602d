"""The comparison of two batches on the same scenarios, as the API shows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from drivora_service.oracles.oracle_descriptions import Better
from drivora_service.oracles.verdicts.failure_definition import StatedDefinition
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape
from drivora_service.suites.paired.failure_rules import FailureFound, Unfinished
from drivora_service.suites.paired.pairing import LeftOutReason

SIGNIFICANT = 0.05


class WhichFails(StrEnum):
    """Which of A and B fails in a scenario; with several seeds, which fails more often."""

    A_ONLY = "a_only"
    B_ONLY = "b_only"
    BOTH = "both"
    """Both fail; with several seeds, equally often."""
    NEITHER = "neither"


class PairedJudgement(StrEnum):
    """How B stands against A."""

    BETTER = "better"
    WORSE = "worse"
    HIGHER = "higher"
    """Of a metric that is neither better nor worse if it is higher."""
    LOWER = "lower"
    """Of a metric that is neither better nor worse if it is higher."""
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedBatch(Shape):
    """One of the two batches.

    Attributes:
        batch: Id of the batch.
        name: Display name of the batch.
        title: What sets it apart from the other one: its agents, their parameters, or versions.
        agents: Agents of its egos, with the parameters that differ from their defaults; with those
            in which the batches differ, where that does not tell them apart.
        runs: Stored runs.
        finished: Those that were judged.
        failing: Compared runs with a failure.
        preventable: Compared runs with a violation that is not the fault of the ego, but avoidable,
            whether it counts or not.
    """

    batch: str
    name: str
    title: str
    created_at: datetime
    agents: tuple[str, ...]
    runs: int
    finished: int
    failing: int
    preventable: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingDifference(Shape):
    """A parameter or version in which the batches differ.

    Attributes:
        name: `agent`, the name of a parameter after its agent's, or that of a version.
        a: Values of A, joined by commas; empty: none.
        b: Values of B.
    """

    name: str
    a: str
    b: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureComparison(Shape):
    """Failures of A and B over the scenarios.

    Attributes:
        oracle: Name of the oracle, or status of runs without a judgement; empty: any of them.
        a_only: Scenarios in which A fails and B does not; with several seeds, A more often.
        b_only: Scenarios in which B fails and A does not; with several seeds, B more often.
        both: Scenarios in which both fail; with several seeds, equally often.
        neither: Scenarios in which neither fails.
        not_measurable: Pairs that are left out, since the oracle was not measurable in a run.
        not_counted: Pairs that are left out, since the definition of their scenario does not name
            the oracle.
        runs_a: Runs of A with the failure.
        runs_b: Runs of B with the failure.
        difference: Share of scenarios of `b_only` minus that of `a_only`; less is better for B.
        low: Lower end of its 95 % confidence interval.
        high: Upper end.
        p: p-value of McNemar's exact test, two-sided.
        p_holm: p corrected for all oracles with a failure; of any failure, p itself.
        judgement: Undecided unless `p_holm` is below 0.05.
    """

    oracle: str
    a_only: int
    b_only: int
    both: int
    neither: int
    not_measurable: int
    not_counted: int = 0
    runs_a: int
    runs_b: int
    difference: float | None
    low: float | None
    high: float | None
    p: float
    p_holm: float
    judgement: PairedJudgement

    @property
    def scenarios(self) -> int:
        """Number of the scenarios that were compared."""
        return self.a_only + self.b_only + self.both + self.neither


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricComparison(Shape):
    """A metric of A and B; means are over scenarios, in each over its pairs.

    Attributes:
        metric: Name of the metric.
        unit: Unit; `1` for a share; empty if unknown.
        better: Direction in which it is better.
        scenarios: Scenarios with a pair in which both runs have a value.
        pairs: Those pairs.
        not_measurable: Pairs that are left out, since a run has no value.
        mean_a: Mean of A; null without pairs.
        mean_b: Mean of B; null without pairs.
        difference: `mean_b` minus `mean_a`.
        low: Lower end of its 95 % confidence interval; null with fewer than two scenarios.
        high: Upper end.
        p: p-value of the test by flipped signs, two-sided.
        p_holm: p corrected for all metrics with a difference.
        judgement: Undecided unless `p_holm` is below 0.05.
    """

    metric: str
    unit: str
    better: Better
    scenarios: int
    pairs: int
    not_measurable: int
    mean_a: float | None
    mean_b: float | None
    difference: float | None
    low: float | None
    high: float | None
    p: float
    p_holm: float
    judgement: PairedJudgement


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult(Shape):
    """A run of a pair.

    Attributes:
        run: Id of the run.
        failures: Its failures, the most frequent oracles of the comparison first.
        metrics: Values of the chosen metrics, or of the driving score; null: not measurable.
    """

    run: str
    status: RunStatus
    failures: tuple[FailureFound, ...]
    metrics: Mapping[str, float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class PairResult(Shape):
    """A run of A and one of B with the same scenario and seed.

    Attributes:
        scenario: Label of the runs; without one, the town and the beginning of the scenario's hash.
        fails: Which of A and B fails in this pair.
        scenario_fails: Which of them fails more often over all pairs of the scenario.
        same_trace: Whether both runs have the same trace, kept or not.
    """

    scenario: str
    seed: int
    town: str
    fails: WhichFails
    scenario_fails: WhichFails
    same_trace: bool
    a: RunResult
    b: RunResult


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOut(Shape):
    """Runs that are not compared, and why.

    Attributes:
        scenario: Label of the runs; without one, the town and the beginning of the scenario's hash.
        seed: Seed of A's run; of B's, if there is none of A.
        a: Id of the run of A; empty if there is none.
        b: Id of the run of B; empty if there is none.
        message: The reason in words.
    """

    reason: LeftOutReason
    scenario: str
    seed: int
    a: str
    b: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchComparison(Shape):
    """Two batches on the same scenarios.

    Attributes:
        sentence: How things stand.
        definition: The violations that count as failures.
        unfinished: The runs without a judgement that count as failures.
        scenarios: Scenarios with a pair, regardless of seeds.
        differences: Agents, parameters and versions in which the batches differ.
        notes: Remarks for the reader.
        failures: Scenarios with any failure.
        by_oracle: The same by oracle, those with a failure only.
        metrics: Metrics of the pairs.
        pairs: Every pair, those that tell A from B first.
        left_out: Runs that are not compared.
    """

    sentence: str
    a: ComparedBatch
    b: ComparedBatch
    definition: StatedDefinition
    unfinished: Unfinished
    scenarios: int
    differences: tuple[SettingDifference, ...]
    notes: tuple[str, ...]
    failures: FailureComparison
    by_oracle: tuple[FailureComparison, ...]
    metrics: tuple[MetricComparison, ...]
    pairs: tuple[PairResult, ...]
    left_out: tuple[LeftOut, ...]
