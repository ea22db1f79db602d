"""Results of suites, made by hand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_results import SuiteResults, SuiteRun, scenario_hash

DOCUMENT = ScenarioDocument.model_validate(SCENARIO)
_HASH = scenario_hash(DOCUMENT)


def verdict(
    oracle: str = "collision",
    *,
    counterpart: str = "npc",
    at_fault: bool | None = True,
    avoidable: Answer | None = Answer.YES,
    severity: Severity = Severity.CRITICAL,
    **changes: Any,
) -> Verdict:
    """Returns a violation; as it stands, an avoidable collision at fault."""
    return Verdict(
        oracle=oracle,
        ego="ego",
        outcome=Outcome.VIOLATED,
        message=f"Violated {oracle}.",
        severity=severity,
        at_fault=at_fault,
        avoidable=avoidable,
        time=1.0,
        step=10,
        location=(1.0, 2.0),
        counterpart=counterpart,
        **changes,
    )


def suite_run(scenario: str, repetition: int, *violations: Verdict, **changes: Any) -> SuiteRun:
    """Returns a judged run of a scenario."""
    values: dict[str, Any] = {
        "scenario": scenario,
        "repetition": repetition,
        "seed": 100 + repetition,
        "run_id": f"{scenario}-{repetition}",
        "status": RunStatus.FINISHED,
        "town": "tee-town",
        "agents": {"ego": "idm"},
        "violations": violations,
        "metrics": {"driving_score": 50.0 if violations else 100.0},
        "trace_sha256": f"{scenario}{repetition}",
        "sim_time_s": 10.0,
        "wall_time_s": 0.5,
    }
    return SuiteRun(**(values | changes))


def results_of(
    runs: Sequence[SuiteRun], *, repetitions: int | None = None, **changes: Any
) -> SuiteResults:
    """Returns the results of runs, of a suite with their scenarios."""
    names = dict.fromkeys(run.scenario for run in runs)
    values: dict[str, Any] = {
        "suite": "made",
        "agent": "idm",
        "size": len(names),
        "repetitions": repetitions or 1 + max(run.repetition for run in runs),
        "scenarios": dict.fromkeys(names, _HASH),
        "runs": (),
    }
    return SuiteResults(**(values | changes)).with_runs(runs)


def counted(scenario: str, failing: int, of: int, **changes: Any) -> list[SuiteRun]:
    """Returns runs of a scenario of which some have an avoidable collision."""
    return [
        suite_run(scenario, number, *([verdict()] if number < failing else []), **changes)
        for number in range(of)
    ]


def scenarios_of(results: SuiteResults, **changes: Any) -> Mapping[str, SuiteScenario]:
    """Returns expectations for all scenarios of results."""
    return {
        name: SuiteScenario(name=name, document=DOCUMENT, **changes) for name in results.scenarios
    }
