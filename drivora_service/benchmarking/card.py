"""The card of an agent: its results in the runs of the benchmark."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from drivora_service.agents.entry import AgentEntry
from drivora_service.benchmarking.benchmark_run import COLLISION, RED_LIGHT, BenchmarkRun
from drivora_service.metrics.aggregates import benchmark_scores
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.run_report import RunStatus

_AGENTS_OWN = frozenset({RunStatus.AGENT_FAILED, RunStatus.TIMED_OUT})
"""Statuses of runs that are the agent's fault."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """Aggregates of several runs; counts are numbers of runs.

    Attributes:
        runs: All runs.
        judged: Judged runs.
        arrivals: Runs in which the ego reached its destination in time.
        clean_arrivals: Arrivals without a collision at the ego's fault.
        collisions: Runs in which the ego touched an actor.
        at_fault_collisions: Runs with a collision at the ego's fault.
        avoidable_collisions: Runs with a collision at the ego's fault that a careful and competent
            driver avoids.
        preventable_collisions: Runs with a collision at the fault of others that such a driver of
            the ego avoids.
        red_lights: Runs in which the ego ran a red light.
        driving_score: Mean of Leaderboard 2.1, per cent. In this and the following means, a run in
            which the agent failed counts 0, one that failed because of the machine is omitted.
        driving_score_deviation: Its sample standard deviation; ``None`` for fewer than two runs.
        driving_score_1_0: Mean of Leaderboard 1.0, per cent.
        driving_score_2_0: Mean of Leaderboard 2.0, per cent.
        route_completion: Mean, per cent.
        success_rate: Bench2Drive, 0..1.
        nuplan_closed_loop: Mean of nuPlan's closed-loop score, 0..1.
        efficiency: Mean of Bench2Drive's driving efficiency, of judged runs, per cent.
        comfort: Mean share of segments within the bounds of comfort, of judged runs.
        comfortable: Judged runs entirely within the bounds of comfort.
        step_cost_median_us: Wall microseconds of a whole step, simulation and agent: median of the
            judged runs' means.
        step_cost_p95_us: 95th percentile of the same.
        agent_cost_median_us: The agent's share of a step; also ``None`` if SUMO drives.
    """

    runs: int
    judged: int
    arrivals: int
    clean_arrivals: int
    collisions: int
    at_fault_collisions: int
    avoidable_collisions: int
    preventable_collisions: int
    red_lights: int
    driving_score: float | None
    driving_score_deviation: float | None
    driving_score_1_0: float | None
    driving_score_2_0: float | None
    route_completion: float | None
    success_rate: float | None
    nuplan_closed_loop: float | None
    efficiency: float | None
    comfort: float | None
    comfortable: int
    step_cost_median_us: float | None
    step_cost_p95_us: float | None
    agent_cost_median_us: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkFigures:
    """Aggregates of the runs on one network."""

    network: str
    figures: Figures


@dataclass(frozen=True, slots=True, kw_only=True)
class ViolatedOracle:
    """An oracle that the agent violated.

    Attributes:
        oracle: Name of the oracle.
        runs: Number of runs with a violation.
        at_fault: In how many of these the verdict blames the ego; 0 if the oracle does not
            attribute fault.
        example: Message of the first verdict.
        example_run: Scenario of that verdict.
    """

    oracle: str
    runs: int
    at_fault: int
    example: str
    example_run: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureCause:
    """A cause of runs that were not judged.

    Attributes:
        status: Status of the runs.
        cause: Short stable name.
        runs: Number of runs.
        example: Message of the first one.
        example_run: Scenario of the first one.
    """

    status: RunStatus
    cause: str
    runs: int
    example: str
    example_run: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentCard:
    """The results of an agent.

    Attributes:
        agent: Entry of the catalogue.
        total: Aggregates of all its runs.
        networks: Aggregates by network.
        violated: Violated oracles, the most frequent first.
        failures: Causes, the most frequent first.
        runs: The underlying runs.
        shown: The run to draw; ``None`` if none was judged.
    """

    agent: AgentEntry
    total: Figures
    networks: tuple[NetworkFigures, ...]
    violated: tuple[ViolatedOracle, ...]
    failures: tuple[FailureCause, ...]
    runs: tuple[BenchmarkRun, ...]
    shown: BenchmarkRun | None

    @property
    def failed_otherwise(self) -> int:
        """The number of runs that failed without the agent's fault."""
        return sum(not run.is_judged and run.record.status not in _AGENTS_OWN for run in self.runs)


def card_of(agent: AgentEntry, runs: Iterable[BenchmarkRun]) -> AgentCard:
    """Computes a card.

    Args:
        agent: The agent.
        runs: The runs, in any order.
    """
    ordered = tuple(sorted(runs, key=lambda run: (run.network, run.number)))
    by_network: dict[str, list[BenchmarkRun]] = defaultdict(list)
    for run in ordered:
        by_network[run.network].append(run)
    return AgentCard(
        agent=agent,
        total=figures_of(ordered),
        networks=tuple(
            NetworkFigures(network=network, figures=figures_of(own))
            for network, own in by_network.items()
        ),
        violated=_count_violated_oracles([run for run in ordered if run.is_judged]),
        failures=_failures(ordered),
        runs=ordered,
        shown=worst_run(ordered),
    )


def figures_of(runs: Sequence[BenchmarkRun]) -> Figures:
    """Returns the aggregates of runs."""
    judged = [run for run in runs if run.is_judged]
    costs = [cost for run in judged if (cost := run.record.step_cost_us) is not None]
    typical, p95 = np.percentile(costs, (50.0, 95.0)) if costs else (None, None)
    own = [cost for run in judged if (cost := run.agent_cost_us) is not None]
    at_fault = [run for run in judged if run.has_violated(COLLISION, at_fault=True)]
    arrivals = [run for run in judged if run.arrived]
    failed = sum(run.record.status in _AGENTS_OWN for run in runs)
    scores = benchmark_scores([run.record.metrics for run in judged], missing=failed)
    return Figures(
        runs=len(runs),
        judged=len(judged),
        arrivals=len(arrivals),
        clean_arrivals=sum(not run.has_violated(COLLISION, at_fault=True) for run in arrivals),
        collisions=sum(run.has_violated(COLLISION) for run in judged),
        at_fault_collisions=len(at_fault),
        avoidable_collisions=sum(run.has_collided(Accountability.AVOIDABLE) for run in judged),
        preventable_collisions=sum(run.has_collided(Accountability.PREVENTABLE) for run in judged),
        red_lights=sum(run.has_violated(RED_LIGHT) for run in judged),
        driving_score=scores.driving_score.mean,
        driving_score_deviation=scores.driving_score.deviation,
        driving_score_1_0=scores.driving_score_1_0.mean,
        driving_score_2_0=scores.driving_score_2_0.mean,
        route_completion=scores.route_completion.mean,
        success_rate=scores.success_rate.mean,
        nuplan_closed_loop=scores.nuplan_closed_loop.mean,
        efficiency=scores.efficiency.mean,
        comfort=scores.comfort.mean,
        comfortable=sum(run.metric("comfort") == 1.0 for run in judged),
        step_cost_median_us=None if typical is None else float(typical),
        step_cost_p95_us=None if p95 is None else float(p95),
        agent_cost_median_us=median(own) if own else None,
    )


def worst_run(runs: Iterable[BenchmarkRun]) -> BenchmarkRun | None:
    """Returns the judged run with the most violations; of equal ones the longest.

    A collision at the ego's fault weighs most, then the number of violated oracles.
    """

    def badness(run: BenchmarkRun) -> tuple[bool, int, float]:
        return (
            run.has_violated(COLLISION, at_fault=True),
            len({verdict.oracle for verdict in run.violations}),
            run.record.sim_time_s or 0.0,
        )

    return max((run for run in runs if run.is_judged), key=badness, default=None)


def _count_violated_oracles(runs: Sequence[BenchmarkRun]) -> tuple[ViolatedOracle, ...]:
    oracles = dict.fromkeys(verdict.oracle for run in runs for verdict in run.violations)
    found = []
    for oracle in oracles:
        violating = [run for run in runs if run.has_violated(oracle)]
        at_fault = [run for run in violating if run.has_violated(oracle, at_fault=True)]
        shown = (at_fault or violating)[0]
        verdicts = [verdict for verdict in shown.violations if verdict.oracle == oracle]
        example = next((verdict for verdict in verdicts if verdict.at_fault), verdicts[0])
        found.append(
            ViolatedOracle(
                oracle=oracle,
                runs=len(violating),
                at_fault=len(at_fault),
                example=example.message,
                example_run=shown.name,
            )
        )
    return tuple(sorted(found, key=lambda violated: (-violated.runs, violated.oracle)))


def _failures(runs: Sequence[BenchmarkRun]) -> tuple[FailureCause, ...]:
    groups: dict[tuple[RunStatus, str], list[BenchmarkRun]] = defaultdict(list)
    for run in runs:
        if not run.is_judged:
            groups[run.record.status, run.cause].append(run)
    told = [
        FailureCause(
            status=status,
            cause=cause,
            runs=len(failed),
            example=failed[0].reason,
            example_run=failed[0].name,
        )
        for (status, cause), failed in groups.items()
    ]
    return tuple(sorted(told, key=lambda failure: (-failure.runs, failure.status, failure.cause)))
