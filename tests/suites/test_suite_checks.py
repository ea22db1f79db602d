"""Remarks on results that are not those of a whole suite."""

from __future__ import annotations

from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.suite_checks import check_judged
from tests.suites.made_results import results_of, suite_run


def test_scenarios_without_a_judged_run_are_named() -> None:
    failed = RunStatus.AGENT_FAILED
    lost = RunStatus.INFRASTRUCTURE_FAILED
    results = results_of(
        [
            suite_run("judged", 0),
            suite_run("judged", 1, status=lost),
            suite_run("agent", 0, status=failed),
            suite_run("agent", 1, status=failed),
            suite_run("lost", 0, status=lost),
            suite_run("lost", 1, status=lost),
        ]
    )
    (remark,) = check_judged(results)
    assert remark == "1 scenario without a judged run: lost"
    assert not list(check_judged(results_of([suite_run("judged", 0)])))
