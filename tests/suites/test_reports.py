"""Reports of suites: JUnit, HTML, Markdown and CSV, read by other code."""

from __future__ import annotations

import csv
import io
import re
from datetime import UTC, datetime
from html.parser import HTMLParser
from typing import Any
from xml.etree import ElementTree

import pytest
from junitparser import JUnitXml, TestCase

from drivora_service.cli.suites.suite_reports import print_report, report_content
from drivora_service.oracles.verdicts.failure_definition import Counted, KnownFailure
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.suites.suite_records import ScenarioState
from drivora_service.suites.gate.baseline import make_baseline
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide
from drivora_service.suites.reports.junit import junit_xml
from drivora_service.suites.reports.markdown_summary import summary_markdown
from drivora_service.suites.reports.report_html import report_html
from drivora_service.suites.reports.runs_csv import runs_csv
from drivora_service.suites.reports.suite_recording import decision_of, outcomes_of
from drivora_service.suites.reports.suite_report import SuiteReport, make_report
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import SuiteRun
from tests.suites.made_results import (
    DOCUMENT,
    counted,
    results_of,
    scenarios_of,
    suite_run,
    verdict,
)

NASTY = '<script>alert(1)</script> & "x" | `y` \x00\x1b'


def report(**changes: Any) -> SuiteReport:
    """Returns a report in which scenarios are in every state."""
    lost = suite_run("lost", 0, status=RunStatus.TIMED_OUT, cause="limit", message=NASTY)
    now: list[SuiteRun] = [
        *counted("new", 2, 2),
        *counted("flaky", 1, 2),
        *counted("same", 2, 2),
        *counted("fixed", 0, 2),
        *counted("known", 1, 2),
        *counted("=passes", 0, 2),
        lost,
    ]
    results = results_of(now)
    failing = {"new": 0, "flaky": 1, "same": 2, "fixed": 2, "known": 0, "=passes": 0}
    before = results_of([run for name, count in failing.items() for run in counted(name, count, 2)])
    scenarios = {
        name: SuiteScenario(
            name=name,
            document=DOCUMENT,
            tags=("tag",),
            known_failures=(KnownFailure(oracle="collision", reason=NASTY),)
            if name == "known"
            else (),
        )
        for name in results.scenarios
    }
    baseline = make_baseline(before, find_failures(before, scenarios), metrics=())
    gate = GateDocument.model_validate({"limits": [{"most_scenarios": 9}]})
    decision = decide(results, scenarios, gate, baseline)
    values: dict[str, Any] = {
        "created_at": datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC),
        "baseline": "baseline.json",
        "baseline_subject": "idm · reaction_time 1.0; drivora 1.2",
    }
    return make_report(results, scenarios, decision, **(values | changes))


def test_scenarios_are_in_their_states() -> None:
    assert {row.name: row.state for row in report().rows} == {
        "new": ScenarioState.FAILS_GATE,
        "flaky": ScenarioState.FLAKY,
        "same": ScenarioState.FAILS,
        "fixed": ScenarioState.PASSES,
        "known": ScenarioState.KNOWN,
        "=passes": ScenarioState.PASSES,
        "lost": ScenarioState.NOT_JUDGED,
    }


def test_junit_has_failures_and_errors_where_the_gate_fails() -> None:
    xml = junit_xml(report())
    (suite,) = JUnitXml.fromstring(xml)
    cases: dict[str, TestCase] = {case.name: case for case in suite}
    told = {name: [type(result).__name__ for result in case.result] for name, case in cases.items()}
    assert told == {
        "new": ["Failure"],
        "flaky": ["Skipped"],
        "same": ["Skipped"],
        "fixed": [],
        "known": ["Skipped"],
        "=passes": [],
        "lost": ["Error"],
        "gate": ["Failure"],
    }
    assert (suite.tests, suite.failures, suite.errors, suite.skipped) == (8, 2, 1, 3)
    assert cases["new"].classname == "made"
    assert cases["gate"].classname == "made.gate"
    assert cases["new"].time == pytest.approx(1.0)
    assert cases["new"].result[0].message.startswith("new: Violated collision")
    assert cases["lost"].result[0].message.startswith("timed_out: <script>alert(1)</script>")
    found = ElementTree.fromstring(xml).iter("property")
    properties = {one.get("name"): one.get("value") for one in found}
    assert properties == {
        "agent": "idm",
        "baseline": "baseline.json",
        "baseline_of": "idm · reaction_time 1.0; drivora 1.2",
        "definition": "Failures are violations that an ego is accountable for (accountable), of "
        "all oracles but observations",
    }


BASELINE = "baseline.json (of idm · reaction_time 1.0; drivora 1.2)"
FISHER = "one-sided exact test of Fisher, corrected by Holm"
MANTEL = "one-sided test of Cochran, Mantel and Haenszel over 6 scenarios, 3 with failing and"


def test_junit_says_who_accepted_what_it_skips() -> None:
    (suite,) = JUnitXml.fromstring(junit_xml(report()))
    skipped = {
        case.name: case.result[0].message
        for case in suite
        if type(case.result[0] if case.result else None).__name__ == "Skipped"
    }
    assert skipped["same"].startswith(f"accepted in the baseline {BASELINE}: Violated collision")
    assert skipped["flaky"].startswith(f"flaky, against the baseline {BASELINE}: Violated")
    assert skipped["flaky"].endswith(
        f"It fails in 1 of 2 runs, before in 1 of 2 runs (p 0.83, {FISHER})."
    )
    assert skipped["known"].startswith(
        "known failure, accepted by the author of the suite: <script>alert(1)</script>"
    )


def test_a_failure_that_the_gate_ignores_is_no_accepted_one() -> None:
    results = results_of(counted("a", 1, 1))
    scenarios = scenarios_of(results)
    gate = GateDocument.model_validate({"fail_on": []})
    before = results_of(counted("a", 0, 1))
    for baseline, expected in (
        (None, "the gate does not fail for it: Violated collision"),
        (
            make_baseline(before, find_failures(before, scenarios), metrics=()),
            "new, for which the gate does not fail, against the baseline b.json: Violated",
        ),
    ):
        decision = decide(results, scenarios, gate, baseline)
        created_at = datetime(2026, 1, 2, tzinfo=UTC)
        made = make_report(
            results,
            scenarios,
            decision,
            created_at=created_at,
            baseline="" if baseline is None else "b.json",
        )
        (suite,) = JUnitXml.fromstring(junit_xml(made))
        (message,) = [one.message for case in suite if case.name == "a" for one in case.result]
        assert message.startswith(expected)


def more_severe() -> SuiteReport:
    """Returns the report of an accepted touch that is a crash now."""
    old, now = (
        results_of([suite_run("a", 0, verdict(evidence={"relative_speed": speed}))])
        for speed in (1.0, 15.0)
    )
    scenarios = scenarios_of(now)
    baseline = make_baseline(old, find_failures(old, scenarios), metrics=())
    decision = decide(now, scenarios, GateDocument(), baseline)
    created_at = datetime(2026, 1, 2, tzinfo=UTC)
    return make_report(now, scenarios, decision, created_at=created_at, baseline="b.json")


def test_every_report_shows_what_is_more_severe() -> None:
    made, growth = more_severe(), "more severe: impact speed 1.0 → 15.0 m/s"
    (suite,) = JUnitXml.fromstring(junit_xml(made))
    (failure,) = [one for case in suite if case.name == "a" for one in case.result]
    (outcome,) = outcomes_of(made)
    assert failure.message.endswith(f"It is {growth}.")
    assert growth in (failure.text or "")
    assert growth in summary_markdown(made)
    assert growth in report_html(made)
    assert growth in decision_of(made).reasons[0]
    assert outcome.failures[0].endswith(f"It is {growth}.")
    (content,) = report_content(made)["failures"]
    assert content["class"] == "worse"
    severity = content["severity"]
    assert (severity["worse"], severity["sentence"]) == (True, growth)
    assert severity["measures"][1] == {
        "measure": "impact_speed",
        "unit": "m/s",
        "less_is_worse": False,
        "margin": 2.0,
        "before": 1.0,
        "now": 15.0,
        "worst_before": 1.0,
        "worst": 15.0,
        "words": "impact speed 1.0 → 15.0 m/s",
        "clearly_more": True,
        "worse": True,
        "p": None,
        "test": None,
    }


def test_the_test_of_each_p_is_named_beside_it() -> None:
    made = report()
    content = report_content(made)
    assert {one["test"] for one in content["failures"] if one["p"] is not None} == {FISHER}
    assert content["overall"]["test"] == f"{MANTEL} passing runs"
    assert (content["overall"]["scenarios"], content["overall"]["telling_scenarios"]) == (6, 3)
    for text in (summary_markdown(made), report_html(made), junit_xml(made).decode()):
        assert FISHER in text
    assert MANTEL in report_html(made)
    for text in (*(one.change for one in made.decision.failures), *made.decision.reasons):
        assert not re.search(r"\(p [\d.e-]+\)", text)


def test_every_report_says_what_a_failure_is(capsys: pytest.CaptureFixture[str]) -> None:
    words = "Failures are violations that an ego is accountable for (accountable), of all oracles"
    made = report()
    print_report(made)
    for text in (
        " ".join(capsys.readouterr().out.split()),
        summary_markdown(made),
        report_html(made),
        junit_xml(made).decode(),
    ):
        assert text.count(words) == 1
    assert decision_of(made).definition == made.decision.definition.words
    assert report_content(made)["definition"] == {
        "words": "violations that an ego is accountable for (accountable), of all oracles but "
        "observations",
        "origin": "default",
        "counts": "accountable",
        "oracles": None,
        "definitions": 1,
    }


def test_reports_say_that_scenarios_have_different_definitions() -> None:
    results = results_of([*counted("a", 1, 1), *counted("b", 1, 1)])
    scenarios = {**scenarios_of(results), "b": scenarios_of(results, counts=Counted.ANY)["b"]}
    decision = decide(results, scenarios, GateDocument(), None)
    assert decision.definition_sentence == (
        "Failures are, by scenario (2 definitions): violations that an ego is accountable for "
        "(accountable), of all oracles but observations; or violations of any fault (any), of all "
        "oracles but observations"
    )


def test_the_p_of_all_scenarios_says_what_it_compares() -> None:
    names = [f"s{number}" for number in range(40)]
    now = results_of([run for name in names for run in counted(name, 3, 5)])
    before = results_of([run for name in names for run in counted(name, 1, 5)])
    scenarios = scenarios_of(now)
    baseline = make_baseline(before, find_failures(before, scenarios), metrics=())
    (reason,) = decide(now, scenarios, GateDocument(), baseline).reasons
    assert reason.endswith(
        "one-sided test of Cochran, Mantel and Haenszel over 40 scenarios, 40 with failing and "
        "passing runs; it compares scenario by scenario, so that the sums alone do not give this p)"
    )


def test_junit_has_no_error_where_the_gate_ignores_runs_that_were_not_judged() -> None:
    lost = suite_run("lost", 0, status=RunStatus.TIMED_OUT, cause="limit", message="long")
    results = results_of([*counted("a", 0, 1), lost])
    scenarios = scenarios_of(results)
    for unfinished, errors in (("ignore", 0), ("fail", 1)):
        gate = GateDocument.model_validate({"unfinished": unfinished})
        decision = decide(results, scenarios, gate, None)
        created_at = datetime(2026, 1, 2, tzinfo=UTC)
        xml = junit_xml(make_report(results, scenarios, decision, created_at=created_at))
        (suite,) = JUnitXml.fromstring(xml)
        assert (suite.errors, suite.failures, suite.skipped) == (errors, errors, 1 - errors)
        assert decision.fails == bool(errors)


class _Page(HTMLParser):
    """Collects the tags, addresses and text of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.addresses: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_page_needs_nothing_else_and_runs_nothing() -> None:
    text = report_html(report(pictures={"new-0": b"<svg/>"}))
    page = _Page()
    page.feed(text)
    assert "script" not in page.tags
    assert page.addresses == ["data:image/svg+xml;base64,PHN2Zy8+"]
    assert not re.search(r"url\(|@import", text)
    assert "<script>alert(1)</script>" in page.text
    for sentence in ("Gate failed", "fails in 2 of 2 runs, before in 0 of 2 runs", "timed out"):
        assert sentence in page.text


def test_the_summary_escapes_markup() -> None:
    text = summary_markdown(report())
    assert "<script>" not in text
    assert r"| **new** | new | collision | Violated collision" in text
    tables = [line for line in text.splitlines() if line.startswith("|")]
    assert {len(re.findall(r"(?<!\\)\|", line)) for line in tables} == {5, 6}
    assert "1 run was not judged" in text


def test_runs_as_csv_are_safe_for_spreadsheets() -> None:
    rows = list(csv.DictReader(io.StringIO(runs_csv(report()))))
    assert len(rows) == 13
    assert {row["scenario"] for row in rows} >= {"new", "'=passes"}
    by_run = {row["run_id"]: row for row in rows}
    assert by_run["new-1"]["failures"] == "collision"
    assert by_run["flaky-1"]["failures"] == ""
    assert by_run["known-0"]["violations"] == "collision"
    assert float(by_run["new-1"]["driving_score"]) == 50.0
