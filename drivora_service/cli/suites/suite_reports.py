"""The reports of a suite: written to files and printed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivora_service.cli.terminal.out_option import check_file, convert_write_errors, write_result
from drivora_service.cli.terminal.output import note, print_prose, print_table, say
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.errors import DrivoraError
from drivora_service.oracles.verdicts.failure_definition import StatedDefinition
from drivora_service.shapes import to_json
from drivora_service.store.suites.suite_records import ScenarioState
from drivora_service.suites.gate.baseline import Baseline
from drivora_service.suites.gate.baseline_files import read_baseline
from drivora_service.suites.gate.gate_decision import OCCURRENCE_TEST, Decision, OverallAnswer
from drivora_service.suites.gate.severity_changes import SEVERITY_TEST, SeverityChange
from drivora_service.suites.reports.suite_report import STATES_IN_WORDS, SuiteReport, make_report
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_results import SuiteResults, SuiteRun, results_text

if TYPE_CHECKING:
    from drivora_service.client import Client

_MOMENTS = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportFiles:
    """The files that a command shall write; ``None``: not.

    Attributes:
        pictures: Greatest number of pictures of failures in the page.
    """

    junit: Path | None = None
    page: Path | None = None
    summary: Path | None = None
    csv: Path | None = None
    results: Path | None = None
    pictures: int = 0

    def check(self) -> None:
        """Checks, before the work, that every file can be written.

        Raises:
            ConfigurationError: One cannot.
        """
        for path in (self.junit, self.page, self.summary, self.csv, self.results):
            check_file(path)


def read_optional_baseline(path: Path | None) -> Baseline | None:
    """Reads the baseline file of a command, if one is named.

    Raises:
        ConfigurationError: It cannot be read.
    """
    return None if path is None else read_baseline(path)


def report_of(
    results: SuiteResults,
    scenarios: Mapping[str, SuiteScenario],
    decision: Decision,
    *,
    baseline: Path | None,
    accepted: Baseline | None = None,
    pictures: Mapping[str, bytes] | None = None,
) -> SuiteReport:
    """Returns the report of a suite at this moment."""
    return make_report(
        results,
        scenarios,
        decision,
        created_at=datetime.now().astimezone(),
        baseline="" if baseline is None else baseline.name,
        baseline_subject="" if accepted is None else accepted.subject,
        pictures=pictures,
    )


def draw_failures(client: Client, decision: Decision, *, most: int) -> dict[str, bytes]:
    """Draws the first runs of failures that need a decision.

    Args:
        client: Client of the application or service that has the recordings.
        decision: What failed.
        most: Greatest number of pictures.

    Returns:
        SVG by run id; without runs that cannot be drawn.
    """
    drawn: dict[str, bytes] = {}
    for one in decision.failures:
        if len(drawn) >= most:
            break
        run_id = "" if one.now is None else one.now.run_id
        if not run_id or run_id in drawn:
            continue
        try:
            drawn[run_id] = client.run_picture(run_id, moments=_MOMENTS)
        except DrivoraError as error:
            note(f"note: no picture of {one.key.scenario}: {error}")
    return drawn


def write_reports(report: SuiteReport, files: ReportFiles) -> None:
    """Writes the files that are wanted.

    Raises:
        ConfigurationError: One cannot be written.
    """
    if files.junit is not None:
        from drivora_service.suites.reports.junit import junit_xml

        with convert_write_errors(files.junit):
            files.junit.write_bytes(junit_xml(report))
            give_to_user(files.junit)
    if files.page is not None:
        from drivora_service.suites.reports.report_html import report_html

        write_result(files.page, report_html(report))
    if files.summary is not None:
        from drivora_service.suites.reports.markdown_summary import summary_markdown

        write_result(files.summary, summary_markdown(report))
    if files.csv is not None:
        from drivora_service.suites.reports.runs_csv import runs_csv

        write_result(files.csv, runs_csv(report))
    if files.results is not None:
        write_result(files.results, results_text(report.results))


def print_report(report: SuiteReport) -> None:
    """Prints what fails, and the decision."""
    decision = report.decision
    if decision.failures:
        columns = ("class", "scenario", "oracle", "what happened", "how often")
        rows = [
            (
                str(one.failure_class),
                one.key.scenario,
                one.key.oracle.replace("_", " "),
                one.sentence,
                one.change,
            )
            for one in decision.failures
        ]
        # Without a baseline all are of one class.
        skipped = 0 if decision.has_baseline else 1
        print_table(
            "",
            columns[skipped:],
            [row[skipped:] for row in rows],
            wrap=("what happened", "how often"),
            cut=("scenario",),
        )
    if decision.limits:
        print_table(
            "Limits",
            ("limit", "value", "allowed", ""),
            [one.cells for one in decision.limits],
            wrap=("limit",),
        )
    for row in report.rows:
        for reason in row.gone:
            say(f"{row.name}: a known failure did not occur: {reason}")
        for run in row.unfinished:
            say(f"{row.name}: {run.status.replace('_', ' ')}: {run.cause}: {run.message}")
    if decision.not_in_baseline:
        say(f"Not in the baseline, or changed since: {', '.join(decision.not_in_baseline)}")
    print_prose(f"{decision.definition_sentence}.")
    for reason in decision.reasons:
        say(f"- {reason}")
    say(f"{decision.sentence}.")


def print_scenarios(scenarios: list[SuiteScenario]) -> None:
    """Prints a row a scenario of a suite."""
    rows = []
    for one in scenarios:
        known = one.difficulty
        judged = 0 if known is None else len(known.failed_by) + len(known.passed_by)
        failed = "-" if known is None or not judged else f"{len(known.failed_by)} of {judged}"
        town = one.document.map_region.town
        rows.append((one.name, town, " ".join(one.tags) or "-", failed))
    print_table("", ("scenario", "town", "tags", "ADSs that fail"), rows, wrap=("tags",))


def report_content(report: SuiteReport) -> dict[str, Any]:
    """Returns the report as JSON for programs; a contract with scripts."""
    decision, configuration = report.decision, report.results.configuration
    return {
        "suite": report.results.suite,
        "agent": report.results.agent,
        "agent_parameters": list(report.results.agent_parameters),
        "configuration": "" if configuration is None else configuration.words,
        "configuration_id": "" if configuration is None else configuration.id,
        "passed": not decision.fails,
        "sentence": decision.sentence,
        "preventable_runs": decision.preventable_runs,
        "reasons": list(decision.reasons),
        "definition": json.loads(to_json(StatedDefinition, decision.definition)),
        "counts": {str(which): count for which, count in decision.counts.items()},
        "not_in_baseline": list(decision.not_in_baseline),
        "not_run": list(decision.not_run),
        "failures": [
            {
                "class": str(one.failure_class),
                "scenario": one.key.scenario,
                "oracle": one.key.oracle,
                "ego": one.key.ego,
                "counterpart": one.key.counterpart,
                "fails": one.fails,
                "runs": one.in_runs.runs,
                "of": one.in_runs.of,
                "runs_before": one.in_runs_before.runs,
                "of_before": one.in_runs_before.of,
                "p": one.p,
                "test": None if one.p is None else OCCURRENCE_TEST,
                "sentence": one.sentence,
                "accountability": None if one.now is None else str(one.now.accountability),
                "accountability_before": (
                    None if one.before is None else str(one.before.accountability)
                ),
                "severity": {
                    "worse": one.is_more_severe,
                    "sentence": one.growth,
                    "measures": [_change_content(change) for change in one.severity],
                },
                "run": None if one.now is None else one.now.run_id,
            }
            for one in decision.failures
        ],
        "overall": None if decision.overall is None else _overall_content(decision.overall),
        "limits": [
            {
                "limit": one.what,
                "value": None if one.value is None else one.value.mean,
                "low": None if one.value is None else one.value.low,
                "high": None if one.value is None else one.value.high,
                "allowed": one.allowed,
                "fails": one.fails,
                "uncertain": one.is_uncertain,
            }
            for one in decision.limits
        ],
        "scenarios": [
            {
                "scenario": row.name,
                "state": STATES_IN_WORDS[row.state],
                "failing_runs": row.failing,
                "judged_runs": row.judged,
                "driving_score": row.score,
                "same_under_all_seeds": row.is_seedless,
            }
            for row in report.rows
        ],
        "runs": [json.loads(to_json(SuiteRun, run)) for run in report.results.runs],
    }


def _change_content(change: SeverityChange) -> dict[str, Any]:
    """Returns how severe a failure was and is by one measure, in numbers."""
    measure, sides = change.measure, (change.before, change.now)
    before, now = (None if one is None else one.median for one in sides)
    worst_before, worst = (None if one is None else one.worst for one in sides)
    return {
        "measure": measure.name,
        "unit": measure.unit,
        "less_is_worse": measure.less_is_worse,
        "margin": measure.margin,
        "before": before,
        "now": now,
        "worst_before": worst_before,
        "worst": worst,
        "words": change.words,
        "clearly_more": change.grows,
        "worse": change.is_worse,
        "p": change.p,
        "test": None if change.p is None else SEVERITY_TEST,
    }


def _overall_content(overall: OverallAnswer) -> dict[str, Any]:
    """Returns the test of all scenarios together."""
    return {
        "runs": overall.now.runs,
        "of": overall.now.of,
        "runs_before": overall.before.runs,
        "of_before": overall.before.of,
        "p": overall.p,
        "test": None if overall.p is None else overall.test,
        "scenarios": overall.scenarios,
        "telling_scenarios": overall.telling,
        "fails": overall.fails,
    }


def failed_names(report: SuiteReport) -> list[str]:
    """Returns the scenarios that need another look: those that fail the gate or were not judged."""
    states = (ScenarioState.FAILS_GATE, ScenarioState.NOT_JUDGED)
    return [row.name for row in report.rows if row.state in states]
