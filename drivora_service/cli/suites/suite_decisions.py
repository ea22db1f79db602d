"""The decision on a suite: confirmed by further runs, reported, and told by the exit code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.suites.suite_reports import (
    ReportFiles,
    draw_failures,
    print_report,
    read_optional_baseline,
    report_content,
    report_of,
    write_reports,
)
from drivora_service.cli.suites.suite_running import SuiteOrder, run_again
from drivora_service.cli.terminal.output import note
from drivora_service.cli.terminal.output_forms import Form
from drivora_service.cli.terminal.run_progress import run_progress
from drivora_service.client import Client
from drivora_service.errors import DrivoraError
from drivora_service.suites.gate.baseline import Baseline
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide, to_confirm
from drivora_service.suites.reports.suite_recording import decision_of, outcomes_of
from drivora_service.suites.reports.suite_report import SuiteReport
from drivora_service.suites.suite import Suite
from drivora_service.suites.suite_checks import check_baseline
from drivora_service.suites.suite_results import SuiteResults, SuiteRun


def confirm_changes(
    client: Client,
    suite: Suite,
    results: SuiteResults,
    order: SuiteOrder,
    gate: GateDocument,
    baseline: Baseline | None,
) -> SuiteResults:
    """Runs scenarios that changed against the baseline again, under other seeds.

    Args:
        client: Client of the application or service that runs them.
        suite: The suite.
        results: The runs so far.
        order: How they were run.
        gate: Says how often scenarios are run again.
        baseline: The accepted failures; without it nothing is run again.

    Returns:
        The results with the further runs.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    if baseline is None or not gate.confirm:
        return results
    while names := to_confirm(
        decide(results, suite.by_name, gate, baseline), results, times=gate.confirm
    ):
        note(
            f"scenarios whose change is to be confirmed: {len(names)}; {gate.confirm} further runs "
            "of each"
        )
        with run_progress(["confirmation"], total=len(names) * gate.confirm) as count:
            on_run = partial(count, "confirmation")
            results = run_again(
                client, suite, results, names, order, times=gate.confirm, on_run=on_run
            )
    return results


def decide_and_report(
    client: Client | None,
    results: SuiteResults,
    suite: Suite,
    gate: GateDocument,
    baseline: Path | None,
    files: ReportFiles,
) -> SuiteReport:
    """Decides on results and writes the reports.

    Args:
        client: Client that has the recordings; ``None``: reports have no pictures.
        results: The runs.
        suite: Their suite.
        gate: What is asked of them.
        baseline: File of the accepted failures, if there is one.
        files: What is written.

    Raises:
        ConfigurationError: The baseline cannot be read, or a file cannot be written.
    """
    accepted = read_optional_baseline(baseline)
    if accepted is not None:
        for remark in check_baseline(accepted, results):
            note(f"note: {remark}")
    decision = decide(results, suite.by_name, gate, accepted)
    pictures = {}
    if client is not None and files.page is not None:
        pictures = draw_failures(client, decision, most=files.pictures)
    report = report_of(
        results,
        suite.by_name,
        decision,
        baseline=baseline,
        accepted=accepted,
        pictures=pictures,
    )
    write_reports(report, files)
    return report


def post_decision(client: Client, report: SuiteReport) -> str:
    """Has the application or service keep what was decided, for the history of the suite.

    A service that cannot, such as one of an older version, loses nothing of the decision.

    Returns:
        Id of the run of the suite; "" if it is not kept.
    """
    try:
        return client.post_suite_run(decision_of(report), outcomes_of(report)).id
    except DrivoraError as error:
        note(f"note: the decision is not in the history of the suite: {error}")
        return ""


def _unjudged(runs: Sequence[SuiteRun]) -> str:
    """Returns how many runs were not judged, and the most frequent reason."""
    ((message, number),) = Counter(run.message for run in runs).most_common(1)
    few = "1 run was" if len(runs) == 1 else f"{len(runs)} runs were"
    share = "" if number == len(runs) else f" ({number} of them)"
    return f"{few} not judged: {message}{share}"


def print_and_exit(
    report: SuiteReport, form: Form, *, judges: bool, suite_run_id: str = ""
) -> None:
    """Prints a report and ends the command with the exit code of its decision.

    Args:
        report: The report.
        form: The form in which it is printed.
        judges: Whether the gate decides; a shard by itself is not judged.
        suite_run_id: Id under which the decision is kept; "": it is not.
    """
    if form.is_table:
        print_report(report)
    else:
        form.print_content({**report_content(report), "id": suite_run_id})
    if report.decision.unfinished and judges:
        note(_unjudged(report.decision.unfinished))
    if not judges:
        note("this is a shard: `drivora suite gate` decides on the results of all of them")
        raise typer.Exit(ExitCode.DONE)
    if report.decision.fails:
        only_unfinished = not any(one.fails for one in report.decision.failures) and not any(
            one.fails for one in report.decision.limits
        )
        overall = report.decision.overall
        if report.decision.unfinished and only_unfinished and not (overall and overall.fails):
            raise typer.Exit(ExitCode.NOT_DONE)
        raise typer.Exit(ExitCode.GATE_FAILED)
