"""Reports of a suite name the ADS with the parameters that differ from its defaults, and its id."""

from __future__ import annotations

import csv
import io
from datetime import UTC, datetime
from xml.etree import ElementTree

import pytest

from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide
from drivora_service.suites.reports.junit import junit_xml
from drivora_service.suites.reports.markdown_summary import summary_markdown
from drivora_service.suites.reports.report_html import report_html
from drivora_service.suites.reports.runs_csv import runs_csv
from drivora_service.suites.reports.suite_recording import decision_of
from drivora_service.suites.reports.suite_report import SuiteReport, make_report
from drivora_service.suites.suite import SuiteScenario
from tests.suites.made_results import DOCUMENT, results_of, suite_run

SLOWED = "idm · reaction_time 1.0"


def report(*configurations: tuple[str, str]) -> SuiteReport:
    """Returns a report of a run for each configuration."""
    results = results_of(
        [
            suite_run(f"s{place}", 0, configuration=words, configuration_id=configuration_id)
            for place, (words, configuration_id) in enumerate(configurations)
        ]
    )
    scenarios = {
        name: SuiteScenario(name=name, document=DOCUMENT, tags=()) for name in results.scenarios
    }
    decision = decide(results, scenarios, GateDocument(), None)
    return make_report(results, scenarios, decision, created_at=datetime(2026, 1, 2, tzinfo=UTC))


def test_reports_carry_the_words_and_the_id() -> None:
    made = report((SLOWED, "bbbbbbbb"), (SLOWED, "bbbbbbbb"))
    found = ElementTree.fromstring(junit_xml(made)).iter("property")
    properties = {one.get("name"): one.get("value") for one in found}
    assert properties["configuration"] == SLOWED
    assert properties["configuration_id"] == "bbbbbbbb"
    assert "reaction" in summary_markdown(made).splitlines()[0]
    assert f"{SLOWED} (bbbbbbbb)" in report_html(made)
    rows = list(csv.DictReader(io.StringIO(runs_csv(made))))
    assert {(row["configuration"], row["configuration_id"]) for row in rows} == {
        (SLOWED, "bbbbbbbb")
    }
    told = decision_of(made)
    assert (told.configuration, told.configuration_id) == (SLOWED, "bbbbbbbb")


@pytest.mark.parametrize(
    "configurations", [(("idm", "aaaaaaaa"), (SLOWED, "bbbbbbbb")), (("", ""),)]
)
def test_a_suite_of_several_configurations_or_of_an_older_file_has_none(
    configurations: tuple[tuple[str, str], ...],
) -> None:
    made = report(*configurations)
    assert made.subject == "idm"
    assert decision_of(made).configuration_id == ""
