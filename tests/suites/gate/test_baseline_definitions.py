"""A baseline is compared with results by the definition of a failure that it was made with."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    KnownFailure,
)
from drivora_service.suites.gate.baseline import Baseline, baseline_changes, make_baseline
from drivora_service.suites.gate.baseline_accepting import update_baseline
from drivora_service.suites.gate.baseline_files import baseline_text, read_baseline
from drivora_service.suites.gate.failure_classes import FailureClass
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide
from drivora_service.suites.suite import Suite
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import SuiteResults
from tests.suites.made_results import results_of, scenarios_of, suite_run, verdict

ANY, ACCOUNTABLE = GateDocument(counts=Counted.ANY), GateDocument()


def made_under(gate: GateDocument, results: SuiteResults, **changes: Any) -> Baseline:
    scenarios = scenarios_of(results, **changes)
    return make_baseline(
        results, find_failures(results, scenarios, gate=gate.definition), metrics=()
    )


def of_others() -> SuiteResults:
    """Returns results with a failure, and a violation that others are at fault for."""
    return results_of(
        [suite_run("a", 0, verdict()), suite_run("b", 0, verdict(at_fault=False, avoidable=None))]
    )


@pytest.mark.parametrize(("before", "now"), [(ANY, ACCOUNTABLE), (ACCOUNTABLE, ANY)])
def test_nothing_is_fixed_or_new_by_another_definition(
    before: GateDocument, now: GateDocument
) -> None:
    results = of_others()
    with pytest.raises(ConfigurationError) as raised:
        decide(results, scenarios_of(results), now, made_under(before, results))
    message = str(raised.value)
    assert "different failures in 2 of 2 scenarios" in message
    assert f"In 'a' the baseline counts {before.definition}; the suite" in message
    assert f"count {now.definition}." in message
    assert "`drivora suite baseline`" in message
    same = decide(results, scenarios_of(results), before, made_under(before, results))
    assert {one.failure_class for one in same.failures} == {FailureClass.SAME}


def test_only_scenarios_that_are_compared_must_agree() -> None:
    results = of_others()
    baseline = made_under(ANY, results)
    changed = results_of(
        [suite_run("a", 0, verdict()), suite_run("c", 0)], scenarios={"a": "0" * 64, "c": "1" * 64}
    )
    assert decide(changed, scenarios_of(changed), ACCOUNTABLE, baseline).not_in_baseline == (
        "a",
        "c",
    )


def test_a_baseline_that_does_not_say_what_it_counts_counts_what_the_suite_counts(
    tmp_path: Path,
) -> None:
    results = of_others()
    content = json.loads(baseline_text(made_under(ANY, results)))
    assert (content.pop("counts"), content.pop("oracles")) == ("any", None)
    assert not any("counts" in one for one in content["scenarios"].values())
    path = tmp_path / "baseline.json"
    path.write_text(json.dumps(content))
    baseline = read_baseline(path)
    assert baseline.scenarios["a"].definition is None
    assert not decide(results, scenarios_of(results), ANY, baseline).fails
    # What is not known stays unknown.
    assert json.loads(baseline_text(baseline)) == content


def test_scenarios_of_a_baseline_may_have_their_own_definitions(tmp_path: Path) -> None:
    results = results_of([suite_run(name, 0, verdict()) for name in "abc"])
    scenarios = {
        **scenarios_of(results),
        "b": scenarios_of(results, counts=Counted.ANY, oracles=frozenset({"collision"}))["b"],
    }
    found = find_failures(results, scenarios)
    baseline = make_baseline(results, found, metrics=())
    content = json.loads(baseline_text(baseline))
    assert content["counts"] == "accountable"
    assert {
        name: (one["counts"], one["oracles"])
        for name, one in content["scenarios"].items()
        if "counts" in one
    } == {"b": ("any", ["collision"])}
    path = tmp_path / "baseline.json"
    path.write_text(baseline_text(baseline))
    assert read_baseline(path) == baseline
    decision = decide(results, scenarios, ACCOUNTABLE, baseline)
    assert not decision.fails
    assert decision.definition.definitions == 2


def test_scenarios_that_stay_keep_their_definition() -> None:
    results = of_others()
    scenarios = scenarios_of(results)
    suite = Suite(name="made", description="", scenarios=tuple(scenarios.values()))
    old = made_under(ANY, results)
    only_a = results_of([suite_run("a", 0, verdict())])
    new = update_baseline(only_a, suite, ACCOUNTABLE, old)
    assert new.scenarios["a"].definition == FailureDefinition()
    assert new.scenarios["b"].definition == FailureDefinition(counts=Counted.ANY)
    (change,) = baseline_changes(old, new)
    assert (change.scenario, change.what) == ("a", "")
    assert change.before == f"counts {FailureDefinition(counts=Counted.ANY)}"
    assert change.after == f"counts {FailureDefinition()}"


def test_an_accepted_failure_that_is_known_from_now_on_is_not_fixed() -> None:
    results = of_others()
    baseline = made_under(ACCOUNTABLE, results)
    of_idm, of_another = (
        KnownFailure(oracle="collision", agents=(name,), reason="issue 3")
        for name in ("idm", "nmpc")
    )
    decision = decide(
        results, scenarios_of(results, known_failures=(of_idm,)), ACCOUNTABLE, baseline
    )
    assert decision.failures == ()
    assert decision.known[0].runs == 1
    decision = decide(
        results, scenarios_of(results, known_failures=(of_another,)), ACCOUNTABLE, baseline
    )
    assert [one.failure_class for one in decision.failures] == [FailureClass.SAME]
