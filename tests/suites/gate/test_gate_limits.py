"""Limits of gates on violations and on metrics."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.oracles.verdict import Answer, Severity
from drivora_service.oracles.verdicts.failure_definition import KnownFailure
from drivora_service.suites.gate.baseline import BaselineScenario, make_baseline
from drivora_service.suites.gate.gate_decision import LimitAnswer
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gate_limits import limit_answers
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import SuiteResults
from tests.suites.made_results import results_of, scenarios_of, suite_run, verdict


def answer(results: SuiteResults, baseline: Any = None, **gate: Any) -> LimitAnswer:
    """Returns the answer to the one limit of a gate."""
    document = GateDocument.model_validate(gate)
    (one,) = limit_answers(results, scenarios_of(results), document, baseline or {})
    return one


MIXED = results_of(
    [
        suite_run("a", 0, verdict()),
        suite_run("b", 0, verdict(avoidable=Answer.NO)),
        suite_run("c", 0, verdict("red_light", severity=Severity.MAJOR, avoidable=None)),
        suite_run("d", 0, verdict("discomfort", severity=Severity.OBSERVATION)),
    ]
)


@pytest.mark.parametrize(
    ("limit", "runs"),
    [
        ({}, 2),
        ({"oracles": ["collision"]}, 1),
        ({"oracles": ["collision"], "accountability": ["avoidable", "unavoidable"]}, 2),
        ({"severity": ["major"]}, 1),
        ({"severity": ["minor"]}, 0),
        ({"oracles": ["discomfort"]}, 1),
    ],
)
def test_scenarios_with_violations_are_limited(limit: dict[str, Any], runs: int) -> None:
    for most in range(4):
        found = answer(MIXED, limits=[{**limit, "most_scenarios": most}])
        assert found.value is not None
        assert found.value.mean == runs
        assert found.fails == (runs > most)


@pytest.mark.parametrize(("counts", "runs"), [("accountable", 2), ("at_fault", 3)])
@pytest.mark.parametrize("oracles", [None, ["collision"], ["discomfort"]])
def test_a_limit_counts_what_its_gate_counts(
    counts: str, runs: int, oracles: list[str] | None
) -> None:
    found = answer(MIXED, counts=counts, oracles=oracles, limits=[{"most_scenarios": 0}])
    assert found.value is not None
    assert (
        found.value.mean
        == {"collision": runs - 1, "discomfort": 1, None: runs}[oracles[0] if oracles else None]
    )
    assert "(counted)" in found.what


def test_known_failures_are_not_limited() -> None:
    known = KnownFailure(oracle="collision", reason="x")
    gate = GateDocument.model_validate(
        {"limits": [{"oracles": ["collision"], "most_scenarios": 0}]}
    )
    (found,) = limit_answers(MIXED, scenarios_of(MIXED, known_failures=(known,)), gate, {})
    assert not found.fails


def test_a_share_fails_only_if_the_seeds_cannot_explain_it() -> None:
    def shares(*failing: int) -> SuiteResults:
        return results_of(
            [
                suite_run(f"s{place}", repetition, *([verdict()] if place < count else []))
                for repetition, count in enumerate(failing)
                for place in range(10)
            ]
        )

    limits = [{"most_share": 0.2}]
    spread = answer(shares(1, 3, 4, 2, 3), limits=limits)
    assert spread.value is not None
    assert spread.value.mean == pytest.approx(0.26)
    assert spread.value.least < 0.2 < spread.value.mean
    assert (spread.fails, spread.is_uncertain) == (False, True)
    certain = answer(shares(4, 4, 5, 4, 5), limits=limits)
    assert (certain.fails, certain.is_uncertain) == (True, False)
    single = answer(shares(3), limits=limits)
    assert (single.fails, single.is_uncertain) == (True, False)
    assert not answer(shares(2), limits=limits).fails


def test_means_of_metrics_are_limited() -> None:
    runs = [
        suite_run("a", 0, metrics={"driving_score": 60.0}),
        suite_run("b", 0, metrics={"driving_score": 80.0}),
        suite_run("c", 0, metrics={"driving_score": None}),
    ]
    results = results_of(runs)
    limit = {"metric": "driving_score"}
    assert not answer(results, metrics=[{**limit, "at_least": 70.0}]).fails
    assert answer(results, metrics=[{**limit, "at_least": 70.1}]).fails
    assert answer(results, metrics=[{**limit, "at_most": 69.9}]).fails
    unknown = answer(results, metrics=[{"metric": "comfort", "at_least": 0.1}])
    assert (unknown.value, unknown.fails) == (None, True)


def test_results_do_not_drop_or_rise_against_themselves() -> None:
    runs = [
        suite_run(name, number, metrics={"driving_score": value, "comfort": 1.0 - value})
        for name in ("a", "b")
        for number, value in enumerate((0.1 + 0.2, 2.0 / 3.0, 1.0 / 3.0, 0.1234567))
    ]
    names = ("driving_score", "comfort")
    limits = [{"metric": name, "most_drop": 0.0, "most_rise": 0.0} for name in names]
    gate = GateDocument.model_validate({"metrics": limits})
    for chosen in (runs, runs[:1], runs[3:4], runs[1:3]):
        results = results_of(chosen)
        scenarios = scenarios_of(results)
        baseline = make_baseline(results, find_failures(results, scenarios), metrics=names)
        answers = limit_answers(results, scenarios, gate, baseline.scenarios)
        assert [(one.fails, one.is_uncertain) for one in answers] == [(False, False)] * 2
        assert answers[0].allowed == "at least 0 and at most 0"
    lower = results_of([suite_run("a", 0, metrics={"driving_score": 0.299})])
    before = {"a": BaselineScenario(sha256="", seeds=(1,), metrics={"driving_score": 0.3})}
    assert answer(lower, before, metrics=[{"metric": "driving_score", "most_drop": 0.0}]).fails


def test_changes_of_means_are_those_of_the_scenarios_in_both() -> None:
    results = results_of(
        [
            suite_run("a", 0, metrics={"driving_score": 60.0}),
            suite_run("b", 0, metrics={"driving_score": 10.0}),
        ]
    )
    baseline = {"a": BaselineScenario(sha256="", seeds=(1,), metrics={"driving_score": 65.0})}
    limit = {"metric": "driving_score"}
    found = answer(results, baseline, metrics=[{**limit, "most_drop": 4.9}])
    assert found.value is not None
    assert (found.value.mean, found.fails, found.allowed) == (-5.0, True, "at least -4.9")
    assert not answer(results, baseline, metrics=[{**limit, "most_drop": 5.0}]).fails
    assert answer(results, {}, metrics=[{**limit, "most_drop": 5.0}]).fails
