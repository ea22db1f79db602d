"""Suites that were run, and the history of their scenarios."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivora_service.errors import InvalidDocument, UnknownName
from drivora_service.store.database import Database
from drivora_service.store.suites.suite_records import (
    ScenarioState,
    SuiteDecision,
    SuiteEstimate,
    SuiteOutcome,
    SuiteRunSummary,
)

DECISION = SuiteDecision(
    suite="smoke",
    agent="idm",
    agent_parameters=("time_gap=1.5",),
    fails=True,
    sentence="Gate failed: 1 new against the baseline.",
    reasons=("1 new failure",),
    counts={"new": 1},
    baseline="baseline.json",
    scenarios=2,
    passing=1,
    judged_runs=4,
    pass_rate=SuiteEstimate(mean=0.5, low=0.1, high=0.9),
    score=SuiteEstimate(mean=80.0, low=None, high=None),
    versions={"drivora": "0.1.0"},
)


def outcome(
    scenario: str, state: ScenarioState = ScenarioState.PASSES, failures: tuple[str, ...] = ()
) -> SuiteOutcome:
    return SuiteOutcome(
        scenario=scenario,
        state=state,
        failing=len(failures),
        judged=2,
        score=None,
        run_id="r",
        failures=failures,
    )


def add(database: Database, *outcomes: SuiteOutcome, decision: SuiteDecision = DECISION) -> str:
    with database.write() as transaction:
        return transaction.suite_runs.add(decision, outcomes)


def test_a_run_of_a_suite_is_read_as_it_was_told(database: Database) -> None:
    told = (outcome("a", ScenarioState.FAILS_GATE, ("collision: …",)), outcome("b"))
    suite_run = add(database, *told)
    with database.read() as transaction:
        record = transaction.suite_runs.get(suite_run)
        (listed,) = transaction.suite_runs.page().items
        with pytest.raises(UnknownName, match=suite_run):
            transaction.suite_runs.get("none")
    assert record.outcomes == told
    assert (record.id, record.created_at) == (suite_run, listed.created_at)
    assert {name: getattr(record, name) for name in SuiteDecision.__slots__} == {
        name: getattr(DECISION, name) for name in SuiteDecision.__slots__
    }
    assert isinstance(listed, SuiteRunSummary)
    assert record.revision > 0


def test_runs_are_listed_newest_first_by_suite_and_agent(database: Database) -> None:
    ids = [
        add(database, decision=replace(DECISION, suite=suite, agent=agent))
        for suite, agent in (("a", "idm"), ("b", "idm"), ("a", "pdm"), ("a", "idm"))
    ]
    with database.read() as transaction:

        def found(suite: str = "", agent: str = "") -> list[str]:
            page = transaction.suite_runs.page(suite=suite, agent=agent)
            return [one.id for one in page.items]

        assert found() == ids[::-1]
        assert found(suite="a") == [ids[3], ids[2], ids[0]]
        assert found(suite="a", agent="idm") == [ids[3], ids[0]]
        assert found(suite="c") == []
        first = transaction.suite_runs.page(suite="a", limit=2)
        rest = transaction.suite_runs.page(suite="a", limit=2, page_token=first.next_page_token)
        assert [one.id for one in (*first.items, *rest.items)] == [ids[3], ids[2], ids[0]]
        assert rest.next_page_token == ""
        with pytest.raises(InvalidDocument):
            transaction.suite_runs.page(page_token=first.next_page_token)
        suites = transaction.suite_runs.suites()
    assert [(one.suite, one.runs, one.last.id) for one in suites] == [
        ("a", 3, ids[3]),
        ("b", 1, ids[1]),
    ]


def test_the_history_has_a_line_for_each_scenario_changed_ones_first(
    database: Database,
) -> None:
    broken = outcome("c", ScenarioState.FAILS_GATE, ("collision: …",))
    ids = [
        add(database, outcome("a"), outcome("gone")),
        add(database, outcome("a"), outcome("b"), outcome("c")),
        add(database, outcome("a"), outcome("new"), outcome("b"), broken),
    ]
    with database.read() as transaction:
        history = transaction.suite_runs.history("smoke")
        last = transaction.suite_runs.history("smoke", limit=1)
        with pytest.raises(UnknownName, match="known: smoke"):
            transaction.suite_runs.history("other")
        with pytest.raises(UnknownName):
            transaction.suite_runs.history("smoke", agent="pdm")
    assert [one.id for one in history.runs] == ids
    assert {one.scenario: one.outcomes for one in history.scenarios} == {
        "c": (None, outcome("c"), broken),
        "a": (outcome("a"),) * 3,
        "new": (None, None, outcome("new")),
        "b": (None, outcome("b"), outcome("b")),
        "gone": (outcome("gone"), None, None),
    }
    assert [one.scenario for one in history.scenarios] == ["c", "a", "new", "b", "gone"]
    assert [one.id for one in last.runs] == ids[-1:]
    assert [one.scenario for one in last.scenarios] == ["a", "new", "b", "c"]


def test_runs_of_an_agent_and_its_slowed_version_are_told_apart(database: Database) -> None:
    plain = replace(DECISION, configuration="idm", configuration_id="aaaaaaaa")
    slowed = replace(DECISION, configuration="idm · reaction_time 1.0", configuration_id="bbbbbbbb")
    for decision in (plain, slowed):
        add(database, outcome("a"), outcome("b"), decision=decision)
    with database.read() as transaction:
        page = transaction.suite_runs.page(agent="idm", configuration_id="bbbbbbbb")
        history = transaction.suite_runs.history("smoke", configuration_id="aaaaaaaa")
    assert [one.configuration for one in page.items] == [slowed.configuration]
    assert [one.configuration for one in history.runs] == ["idm"]
