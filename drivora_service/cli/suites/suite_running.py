"""Runs of a suite, in this process or on a service."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from drivora_service.cli.runs.file_running import run_files
from drivora_service.cli.runs.run_output import ScenarioResult
from drivora_service.cli.scenarios.scenario_files import ScenarioFile
from drivora_service.client import Client
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    FailureDefinition,
)
from drivora_service.scenario.documents import document_text
from drivora_service.store.runs.run_records import Priority
from drivora_service.suites.scenario_selection import Shard
from drivora_service.suites.suite import Suite, SuiteScenario
from drivora_service.suites.suite_results import (
    SuiteResults,
    SuiteRun,
    remove_expectations,
    scenario_hash,
)
from drivora_service.suites.suite_seeds import seed_of_run

_MOST_ITEMS = 2000
_MOST_BYTES = 8 << 20
"""Of one batch: below the limits of a service."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteOrder:
    """How a suite is run.

    Attributes:
        agent: ADS of every ego; "": as documented.
        agent_parameters: ``NAME=VALUE`` or ``EGO:NAME=VALUE``.
        repetitions: Runs of each scenario.
        seed: Number from which the seeds follow; ``None``: those of the documents.
        where: Options with which other commands find the runs.
        gate: What the gate counts as a failure where the suite says nothing.
    """

    agent: str
    agent_parameters: tuple[str, ...]
    repetitions: int
    seed: int | None
    where: str
    gate: FailureDefinition = DEFAULT_DEFINITION


@dataclass(frozen=True, slots=True, kw_only=True)
class _Planned:
    """A run that is to be made."""

    scenario: SuiteScenario
    repetition: int
    seed: int


def run_suite(
    client: Client,
    suite: Suite,
    chosen: Sequence[SuiteScenario],
    order: SuiteOrder,
    *,
    shard: Shard | None,
    on_run: Callable[[], None],
) -> SuiteResults:
    """Runs scenarios of a suite under all their seeds.

    Args:
        client: Client of the application or service that runs them.
        suite: The suite.
        chosen: Those of its scenarios that are run.
        order: How they are run.
        shard: Part of the suite that was chosen; ``None``: none.
        on_run: Called when a run has ended.

    Raises:
        ConfigurationError: The agent or one of its parameters cannot be used.
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    planned = [
        _plan_run(scenario, order, repetition)
        for repetition in range(order.repetitions)
        for scenario in chosen
    ]
    runs, versions, oracles = _run(client, suite, planned, order, on_run=on_run)
    empty = SuiteResults(
        suite=suite.name,
        agent=order.agent,
        agent_parameters=order.agent_parameters,
        size=len(suite.scenarios),
        repetitions=order.repetitions,
        scenarios={one.name: scenario_hash(one.document) for one in chosen},
        shards=() if shard is None else (str(shard),),
        versions=versions,
        oracles=tuple(sorted(oracles)),
        runs=(),
    )
    return empty.with_runs(runs)


def run_again(
    client: Client,
    suite: Suite,
    results: SuiteResults,
    names: Sequence[str],
    order: SuiteOrder,
    *,
    times: int,
    on_run: Callable[[], None],
) -> SuiteResults:
    """Runs scenarios under further seeds, and returns the results with these runs.

    Args:
        client: As for :func:`run_suite`.
        suite: The suite.
        results: The runs so far.
        names: Scenarios to run again.
        order: How they were run.
        times: Further runs of each.
        on_run: Called when a run has ended.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    scenarios = suite.by_name
    first = {
        name: 1 + max(run.repetition for run in runs)
        for name, runs in results.of_scenario().items()
        if runs
    }
    planned = [
        _plan_run(scenarios[name], order, first[name] + number)
        for number in range(times)
        for name in names
    ]
    runs, _, _ = _run(client, suite, planned, order, on_run=on_run)
    return results.with_runs(runs)


def _plan_run(scenario: SuiteScenario, order: SuiteOrder, repetition: int) -> _Planned:
    seed = seed_of_run(scenario.name, scenario.document.seed, repetition, given=order.seed)
    return _Planned(scenario=scenario, repetition=repetition, seed=seed)


def _run(
    client: Client,
    suite: Suite,
    planned: Sequence[_Planned],
    order: SuiteOrder,
    *,
    on_run: Callable[[], None],
) -> tuple[list[SuiteRun], dict[str, str], set[str]]:
    """Returns the runs, the versions of all software, and the oracles that judged."""
    runs: list[SuiteRun] = []
    versions: dict[str, str] = {}
    oracles: set[str] = set()
    for part in _parts(planned):
        files = [
            ScenarioFile(
                name=one.scenario.name,
                path=Path(one.scenario.name),
                document=remove_expectations(one.scenario.document),
                notes=(),
            )
            for one in part
        ]
        results = run_files(
            client,
            files,
            agent=order.agent,
            agent_parameters=order.agent_parameters,
            seed=None,
            out=None,
            where=order.where,
            on_result=lambda _result: on_run(),
            seeds=[one.seed for one in part],
            batch_name=f"suite {suite.name}",
            priority=Priority.CI,
            definitions=[one.scenario.definition(order.gate) for one in part],
        )
        for one, result in zip(part, results, strict=True):
            runs.append(_suite_run(one, result))
            if result.run is not None:
                versions |= {name: str(value) for name, value in result.run.versions.items()}
                oracles |= {verdict.oracle for verdict in result.run.verdicts}
    return runs, versions, oracles


def _parts(planned: Sequence[_Planned]) -> Iterator[Sequence[_Planned]]:
    """Yields runs in batches that a service takes."""
    part: list[_Planned] = []
    size = 0
    for one in planned:
        length = len(document_text(one.scenario.document))
        if part and (len(part) >= _MOST_ITEMS or size + length > _MOST_BYTES):
            yield part
            part, size = [], 0
        part.append(one)
        size += length
    if part:
        yield part


def _suite_run(planned: _Planned, result: ScenarioResult) -> SuiteRun:
    run = result.run
    if run is None:
        problems = "; ".join(f"{p.pointer or '/'}: {p.message}" for p in result.problems)
        return SuiteRun(
            scenario=planned.scenario.name,
            repetition=planned.repetition,
            seed=None,
            run_id="",
            status=result.status,
            cause="invalid_document",
            message=problems,
        )
    return SuiteRun(
        scenario=planned.scenario.name,
        repetition=planned.repetition,
        seed=planned.seed,
        run_id=run.id,
        status=run.status,
        cause=run.cause,
        message="" if run.error is None else run.error.message,
        town=run.town,
        # An ADS that could not be made ready has not told its parameters.
        agents={ego: agent.name for ego, agent in run.agents.items()} or {"": run.agent},
        configuration=run.configuration,
        configuration_id=run.configuration_id,
        violations=result.violations,
        metrics=run.metrics,
        trace_sha256=run.trace_sha256,
        sim_time_s=run.sim_time_s,
        wall_time_s=run.wall_time_s,
    )
