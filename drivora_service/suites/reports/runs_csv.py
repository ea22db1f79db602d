"""The runs of a suite as CSV: a row for each."""

from __future__ import annotations

from drivora_service.studies.tables.csv_text import csv_lines
from drivora_service.suites.reports.suite_report import STATES_IN_WORDS, SuiteReport

_COLUMNS = (
    "scenario",
    "repetition",
    "seed",
    "state",
    "status",
    "cause",
    "run_id",
    "town",
    "agents",
    "configuration",
    "configuration_id",
    "violations",
    "failures",
    "sim_time_s",
    "wall_time_s",
    "trace_sha256",
)


def runs_csv(report: SuiteReport) -> str:
    """Returns a row for each run, with all metrics in columns of their own.

    Returns:
        CSV with a header; values that are not measurable are empty.
    """
    metrics = sorted({name for run in report.results.runs for name in run.metrics})
    lines: list[tuple[object, ...]] = [(*_COLUMNS, *metrics)]
    for row in report.rows:
        for run in row.runs:
            failures = [
                one.key.oracle
                for one in row.failures
                if one.now is not None and run.seed in one.now.seeds
            ]
            values = (
                row.name,
                run.repetition,
                run.seed,
                STATES_IN_WORDS[row.state],
                run.status,
                run.cause,
                run.run_id,
                run.town,
                " ".join(dict.fromkeys(run.agents.values())),
                run.configuration,
                run.configuration_id,
                " ".join(dict.fromkeys(verdict.oracle for verdict in run.violations)),
                " ".join(failures),
                run.sim_time_s,
                run.wall_time_s,
                run.trace_sha256,
            )
            lines.append((*values, *(run.metrics.get(name) for name in metrics)))
    return csv_lines(lines)
