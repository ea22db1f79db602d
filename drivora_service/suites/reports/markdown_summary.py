"""The results of a suite in short, as Markdown for the summary of a CI job."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivora_service.markdown_text import Markdown, escape_markdown, table
from drivora_service.suites.gate.gate_decision import ClassifiedFailure
from drivora_service.suites.reports.suite_report import SuiteReport

_MOST_ROWS = 50


def summary_markdown(report: SuiteReport) -> str:
    """Returns the decision, its reasons, and what fails, as Markdown."""
    return "\n".join(_lines(report)) + "\n"


def _lines(report: SuiteReport) -> Iterator[str]:
    decision, results = report.decision, report.results
    mark = "❌" if decision.fails else "✅"
    yield f"## {mark} {escape_markdown(results.suite)}: {escape_markdown(report.subject)}"
    yield ""
    yield f"{escape_markdown(decision.sentence)}."
    yield ""
    yield f"{escape_markdown(decision.definition_sentence)}."
    if decision.reasons:
        yield ""
    for reason in decision.reasons:
        yield f"- {escape_markdown(reason)}"
    if decision.failures:
        yield ""
        rows = [
            (
                _class(one, has_baseline=decision.has_baseline),
                one.key.scenario,
                one.key.oracle.replace("_", " "),
                one.sentence,
                one.change,
            )
            for one in decision.failures
        ]
        yield from _table(("", "scenario", "oracle", "what happened", "how often"), rows)
    if report.baseline:
        yield ""
        yield f"Baseline: {escape_markdown(report.baseline_words)}"
    if decision.limits:
        yield ""
        yield from _table(
            ("limit", "value", "allowed", ""),
            [one.cells for one in decision.limits],
        )
    gone = [(row.name, reason) for row in report.rows for reason in row.gone]
    if gone:
        yield ""
        yield "Known failures that did not occur:"
        for name, reason in gone[:_MOST_ROWS]:
            yield f"- {escape_markdown(name)}: {escape_markdown(reason)}"
    for what, names in (
        ("Not in the baseline, or changed since", decision.not_in_baseline),
        ("In the baseline, and not run", decision.not_run),
    ):
        if names:
            more = "" if len(names) <= _MOST_ROWS else f" and {len(names) - _MOST_ROWS} more"
            yield ""
            yield f"{what}: {escape_markdown(', '.join(names[:_MOST_ROWS]))}{more}"


def _class(one: ClassifiedFailure, *, has_baseline: bool) -> str:
    if not has_baseline:
        return ""
    return Markdown(f"**{one.failure_class}**") if one.fails else str(one.failure_class)


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield from table(columns, rows[:_MOST_ROWS])
    if len(rows) > _MOST_ROWS:
        yield f"| | and {len(rows) - _MOST_ROWS} more |" + " |" * (len(columns) - 2)
