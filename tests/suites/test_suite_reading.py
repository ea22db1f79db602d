"""Reading suites and gates."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.errors import InvalidDocument
from drivora_service.oracles.verdicts.failure_definition import Counted, KnownFailure
from drivora_service.suites.gate.gate_reading import read_gate_document
from drivora_service.suites.suite import MetricBounds, Suite
from drivora_service.suites.suite_documents import EXTENSION
from drivora_service.suites.suite_reading import read_suite

ORACLES = ("collision", "red_light", "discomfort")
METRICS = ("driving_score", "comfort")
EGO = SCENARIO["ego_vehicles"][0]["id"]


def suite(scenario: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """Returns a suite of one scenario."""
    one = {"name": "a", "document": dict(SCENARIO)} | (scenario or {})
    return {"name": "made", "scenarios": [one]} | changes


def read(content: dict[str, Any]) -> Suite:
    return read_suite(content, oracles=ORACLES, metrics=METRICS)


def test_expectations_of_the_suite_hold_for_scenarios_without_their_own() -> None:
    found = read(
        suite(
            {
                "tags": ["left", "wet"],
                "metrics": {"comfort": {"at_least": 0.5}},
                "known_failures": [
                    {"oracle": "collision", "agents": ["idm"], "reason": "x"},
                    {"oracle": "agent_failed", "reason": "y"},
                ],
                "difficulty": {"failed_by": ["idm"], "passed_by": []},
            },
            tags=["wet", "smoke"],
            oracles=["red_light"],
            metrics={"comfort": {"at_least": 0.1}, "driving_score": {"at_most": 90}},
            repetitions=3,
        )
    )
    (one,) = found.scenarios
    assert (found.name, found.repetitions) == ("made", 3)
    assert one.tags == ("wet", "smoke", "left")
    assert one.oracles == frozenset({"red_light"})
    assert one.metrics == {
        "comfort": MetricBounds(at_least=0.5),
        "driving_score": MetricBounds(at_most=90.0),
    }
    assert one.known_failures == (
        KnownFailure(oracle="collision", agents=("idm",), reason="x"),
        KnownFailure(oracle="agent_failed", reason="y"),
    )


@pytest.mark.parametrize(
    ("listed", "carried", "suites", "found"),
    [
        (None, None, None, None),
        (None, None, "any", Counted.ANY),
        (None, "at_fault", "any", Counted.AT_FAULT),
        ("accountable", "at_fault", "any", Counted.ACCOUNTABLE),
    ],
)
def test_the_nearest_word_on_what_counts_holds(
    listed: str | None, carried: str | None, suites: str | None, found: Counted | None
) -> None:
    document = {**SCENARIO, "extensions": {EXTENSION: {"counts": carried}}}
    (one,) = read(suite({"document": document, "counts": listed}, counts=suites)).scenarios
    assert one.counts is found


@pytest.mark.parametrize(
    ("content", "pointer", "code"),
    [
        (suite(nme="x"), "/nme", "extra_forbidden"),
        (suite(scenarios=[]), "/scenarios", "too_short"),
        (suite({"oracles": ["colision"]}), "/scenarios/0/oracles/0", "unknown_oracle"),
        (suite(oracles=["collision", "x"]), "/oracles/1", "unknown_oracle"),
        (
            suite({"known_failures": [{"oracle": "x", "reason": "y"}]}),
            "/scenarios/0/known_failures/0/oracle",
            "unknown_oracle",
        ),
        (
            suite({"known_failures": [{"oracle": "collision"}]}),
            "/scenarios/0/known_failures/0/reason",
            "missing",
        ),
        (suite(metrics={"x": {"at_least": 1}}), "/metrics/x", "unknown_metric"),
        (
            suite(metrics={"comfort[no_such_ego]": {"at_least": 1}}),
            "/metrics/comfort[no_such_ego]",
            "unknown_ego",
        ),
        (
            suite({"metrics": {"comfort[no_such_ego]": {"at_least": 1}}}),
            "/scenarios/0/metrics/comfort[no_such_ego]",
            "unknown_ego",
        ),
        (suite(metrics={"comfort": {}}), "/metrics/comfort", "no_bound"),
        (
            suite(metrics={"comfort": {"at_least": 2, "at_most": 1}}),
            "/metrics/comfort",
            "empty_range",
        ),
        (suite({"tags": ["two words"]}), "/scenarios/0/tags/0", "string_pattern_mismatch"),
        (
            suite({"document": {**SCENARIO, "seed": -1}}),
            "/scenarios/0/document/seed",
            "greater_than_equal",
        ),
        (
            suite(scenarios=[{"name": "a", "document": SCENARIO}] * 2),
            "/scenarios/1/name",
            "repeated_name",
        ),
        (suite(repetitions=0), "/repetitions", "greater_than_equal"),
    ],
)
def test_problems_are_named_at_their_places(
    content: dict[str, Any], pointer: str, code: str
) -> None:
    with pytest.raises(InvalidDocument) as raised:
        read(content)
    assert [(p.pointer, p.code) for p in raised.value.problems] == [(pointer, code)]


def test_names_are_checked_where_the_structure_has_problems() -> None:
    document = {
        **SCENARIO,
        "extensions": {EXTENSION: {"oracles": ["carried", 3]}},
    }
    with pytest.raises(InvalidDocument) as raised:
        read(
            suite(
                {
                    "document": document,
                    "counts": "bogus",
                    "oracles": ["nosuch"],
                    "metrics": {"x": {"at_least": 1}, "comfort[nosuch]": {}},
                    "known_failures": [{"oracle": "none", "reason": "y"}, 3],
                },
                counts="bogus",
                oracles="collision",
            )
        )
    assert [p.pointer for p in raised.value.problems] == [
        f"/scenarios/0/document/extensions/{EXTENSION}/oracles/0",
        "/scenarios/0/counts",
        "/scenarios/0/oracles/0",
        "/scenarios/0/metrics/x",
        "/scenarios/0/metrics/comfort[nosuch]",
        "/scenarios/0/known_failures/0/oracle",
        "/scenarios/0/known_failures/1",
        "/counts",
        "/oracles",
    ]


def test_all_problems_of_a_gate_are_named_at_once() -> None:
    text = (
        "counts: bogus\noracles: [nosuch, 3]\nlimits: [{oracles: [x], most_scenarios: 0}, 4]\n"
        "metrics: [{metric: nosuch}]\n"
    )
    with pytest.raises(InvalidDocument) as raised:
        read_gate_document(text, oracles=ORACLES, metrics=METRICS)
    assert [p.pointer for p in raised.value.problems] == [
        "/counts",
        "/oracles/0",
        "/oracles/1",
        "/limits/0/oracles/0",
        "/limits/1",
        "/metrics/0",
        "/metrics/0/metric",
    ]


def test_a_metric_may_be_that_of_one_ego() -> None:
    assert read(suite(metrics={f"comfort[{EGO}]": {"at_least": 0.5}})).scenarios[0].metrics


@pytest.mark.parametrize(
    ("text", "pointer", "code"),
    [
        ("fail_on: [newer]", "/fail_on/0", "enum"),
        ("limits: [{oracles: [collision]}]", "/limits/0", "no_limit"),
        ("limits: [{most_scenarios: 1, most_share: 0.1}]", "/limits/0", "no_limit"),
        ("limits: [{oracles: [x], most_scenarios: 0}]", "/limits/0/oracles/0", "unknown_oracle"),
        ("limits: [{most_share: 1.5}]", "/limits/0/most_share", "less_than_equal"),
        ("metrics: [{metric: comfort}]", "/metrics/0", "no_limit"),
        ("metrics: [{metric: x, at_least: 1}]", "/metrics/0/metric", "unknown_metric"),
        ("alpha: 0.0", "/alpha", "greater_than"),
        ("oracles: [collision, collision]", "/oracles", "repeated_oracle"),
        ("fail_on: [new]\nfail_on: [same]", "/fail_on", "repeated_key"),
    ],
)
def test_problems_of_gates_are_named_at_their_places(text: str, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        read_gate_document(text, oracles=ORACLES, metrics=METRICS)
    assert [(p.pointer, p.code) for p in raised.value.problems] == [(pointer, code)]
