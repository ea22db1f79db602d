"""Files of results and of baselines."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from drivora_service.errors import ConfigurationError
from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.gate.baseline import (
    Baseline,
    baseline_changes,
)
from drivora_service.suites.gate.baseline_accepting import update_baseline
from drivora_service.suites.gate.baseline_files import baseline_text, read_baseline
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.suite import Suite
from drivora_service.suites.suite_checks import check_baseline, check_results, check_shards
from drivora_service.suites.suite_results import (
    SuiteResults,
    merge_results,
    read_results,
    results_text,
)
from tests.suites.made_results import counted, results_of, scenarios_of, suite_run, verdict


def suite_of(results: SuiteResults) -> Suite:
    scenarios = tuple(scenarios_of(results).values())
    return Suite(name="made", description="", scenarios=scenarios)


def baseline_of(results: SuiteResults, old: Baseline | None = None) -> Baseline:
    return update_baseline(results, suite_of(results), GateDocument(), old)


def test_results_are_read_as_they_were_written(tmp_path: Path) -> None:
    results = results_of([*counted("a", 1, 3), suite_run("ü", 0, verdict(evidence={"x": [1.5]}))])
    path = tmp_path / "results.json"
    path.write_text(results_text(results))
    assert read_results(path) == results


def test_shards_are_merged_in_the_order_of_runs() -> None:
    whole = results_of([*counted("a", 1, 2), *counted("b", 0, 2)], size=2)
    parts = [
        replace(
            whole,
            scenarios={name: whole.scenarios[name]},
            runs=tuple(run for run in whole.runs if run.scenario == name),
            shards=(shard,),
        )
        for name, shard in (("a", "1/2"), ("b", "2/2"))
    ]
    assert merge_results(parts) == replace(whole, shards=("1/2", "2/2"))
    with pytest.raises(ConfigurationError, match="have a run of 'a' with seed 100"):
        merge_results([parts[0], parts[0]])
    with pytest.raises(ConfigurationError, match="different ADSs: 'idm' and 'pdm-closed'"):
        merge_results([parts[0], replace(parts[1], agent="pdm-closed")])
    with pytest.raises(ConfigurationError, match="different suites"):
        merge_results([parts[0], replace(parts[1], suite="other")])
    changed = replace(parts[0], scenarios={"a": "0" * 64}, runs=())
    with pytest.raises(ConfigurationError, match="'a' differs between these results"):
        merge_results([parts[0], changed])


def test_an_invalid_scenario_may_have_several_repetitions() -> None:
    invalid = [
        suite_run("a", number, status=RunStatus.INVALID, seed=None, run_id="") for number in (0, 1)
    ]
    results = results_of(invalid)
    assert merge_results([results]) == results
    with pytest.raises(ConfigurationError, match="have a run of 'a' with repetition 0"):
        merge_results([results, results])


def test_a_baseline_of_another_ads_or_suite_is_told() -> None:
    results = results_of(counted("a", 1, 1))
    baseline = baseline_of(results)
    assert not list(check_baseline(baseline, results))
    (ads,) = check_baseline(baseline, replace(results, agent="pdm-closed"))
    assert ads.startswith("the baseline is of ADS 'idm', and the results are of 'pdm-closed'")
    (suite,) = check_baseline(baseline, replace(results, suite="other"))
    assert suite.startswith("the baseline is of suite 'made', and the results are of 'other'")


def test_a_missing_shard_is_refused() -> None:
    whole = results_of([*counted("a", 0, 1), *counted("b", 0, 1), *counted("c", 0, 1)])
    suite = suite_of(whole)
    part = replace(
        whole, scenarios={n: whole.scenarios[n] for n in "ac"}, shards=("1/3", "3/3"), runs=()
    )
    with pytest.raises(ConfigurationError, match="of the shards 1/3, 3/3, without 2/3"):
        check_shards(part, suite)
    check_shards(replace(part, shards=("1/2", "2/2")), suite)
    check_shards(replace(part, shards=()), suite)
    check_shards(replace(whole, shards=("1/3", "3/3")), suite)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"version": "2.0"}', "\0"])
def test_files_that_hold_something_else_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=r"holds no results of `drivora suite run"):
        read_results(path)
    with pytest.raises(ConfigurationError, match="is no baseline"):
        read_baseline(path)
    with pytest.raises(ConfigurationError, match="cannot be read"):
        read_results(tmp_path / "none.json")
    with pytest.raises(ConfigurationError, match="`drivora suite baseline` writes one"):
        read_baseline(tmp_path / "none.json")


def test_results_with_runs_of_unknown_scenarios_are_refused(tmp_path: Path) -> None:
    content = json.loads(results_text(results_of(counted("a", 1, 1))))
    content["runs"][0]["scenario"] = "b"
    path = tmp_path / "results.json"
    path.write_text(json.dumps(content))
    with pytest.raises(ConfigurationError, match="does not list: b"):
        read_results(path)


def test_a_baseline_is_read_as_it_was_written(tmp_path: Path) -> None:
    baseline = baseline_of(results_of([*counted("a", 2, 3), *counted("b", 0, 1)]))
    assert baseline.scenarios["a"].seeds == (100, 101, 102)
    assert [failure.runs for failure in baseline.scenarios["a"].failures] == [2]
    assert baseline.scenarios["a"].metrics == {"driving_score": round(200.0 / 3.0, 6)}
    path = tmp_path / "baseline.json"
    path.write_text(baseline_text(baseline))
    assert read_baseline(path) == baseline
    path.write_text(baseline_text(baseline).replace('"runs": 2', '"runs": 4'))
    with pytest.raises(ConfigurationError, match="a: collision occurs in 4 of 3 runs"):
        read_baseline(path)


def test_accepting_shows_what_changes_and_keeps_what_was_not_run() -> None:
    old = baseline_of(results_of([*counted("a", 1, 1), *counted("b", 0, 1), *counted("c", 1, 1)]))
    whole = suite_of(results_of([*counted("a", 0, 1), *counted("b", 0, 1), *counted("c", 1, 1)]))
    part = results_of([*counted("a", 0, 1), *counted("b", 2, 3)])
    new = update_baseline(part, whole, GateDocument(), old)
    assert list(new.scenarios) == ["a", "b", "c"]
    assert new.scenarios["c"] == old.scenarios["c"]
    assert [(c.scenario, c.what, c.before, c.after) for c in baseline_changes(old, new)] == [
        ("a", "collision of ego with npc", "fails in 1 of 1", "passes"),
        ("b", "collision of ego with npc", "passes", "fails in 2 of 3"),
    ]
    assert list(baseline_changes(new, new)) == []
    removed = update_baseline(part, suite_of(part), GateDocument(), old)
    assert [(c.scenario, c.after) for c in baseline_changes(old, removed)][-1] == (
        "c",
        "not in the baseline",
    )
    with pytest.raises(ConfigurationError, match="is of ADS 'idm', and the results are of 'x'"):
        update_baseline(replace(part, agent="x"), whole, GateDocument(), old)


def test_a_baseline_is_not_of_several_parameters() -> None:
    whole = results_of([*counted("a", 1, 1), *counted("b", 0, 1)])
    faster = replace(whole, agent_parameters=("speed_factor=1.3",))
    old = baseline_of(whole)
    assert baseline_of(faster, old).agent_parameters == ("speed_factor=1.3",)
    part = replace(faster, scenarios={"a": whole.scenarios["a"]}, runs=whole.runs[:1])
    with pytest.raises(ConfigurationError, match="and have no judged run of 'b', which would stay"):
        update_baseline(part, suite_of(whole), GateDocument(), old)


def test_results_of_another_suite_are_refused() -> None:
    results = results_of([*counted("a", 1, 1), *counted("b", 0, 1)])
    assert list(check_results(results, suite_of(results))) == []
    part = replace(results, scenarios={"a": results.scenarios["a"]}, runs=())
    assert list(check_results(part, suite_of(results))) == ["1 of 2 scenarios were not run: b"]
    with pytest.raises(ConfigurationError, match="'b', and suite 'made' does not"):
        list(check_results(results, suite_of(part)))
    changed = replace(results, scenarios={**results.scenarios, "a": "0" * 64})
    with pytest.raises(ConfigurationError, match="'a' has changed since these results"):
        list(check_results(changed, suite_of(results)))
