"""Runs, verdicts, metrics and agents of batches, campaigns and studies as tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from pydantic_core import to_json

from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import accountable
from drivora_service.oracles.verdicts.failure_facts import followed_oracle
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import read_all
from drivora_service.store.database import Database
from drivora_service.store.engine.chunks import batched
from drivora_service.store.runs.result_records import EvaluationPlace, ResultFilter, StoredResult
from drivora_service.studies.table_names import ResultTableName
from drivora_service.studies.tables.result_table_columns import result_schema
from drivora_service.studies.tables.table_forms import Row, Table

_PAGE = 200
"""Runs that are in memory at once, with their reports."""
_NUMBERS = 50_000
"""Numbers of runs that are looked for at once: a search by batch sorts all runs that it has."""

_UNSAID: Mapping[str, Any] = {
    "severity": Severity.MAJOR,
    "at_fault": None,
    "undetermined": False,
    "avoidable": None,
    "physically_avoidable": None,
    "time": None,
    "step": None,
    "location": None,
    "counterpart": "",
    "evidence": {},
}
"""Values of a verdict that reports of older versions leave out."""


def result_table(database: Database, name: ResultTableName, wanted: ResultFilter) -> Table:
    """Returns a table of the chosen runs: those with rows in the order of submission, then others.

    It is read page by page. What changes meanwhile may be in it as it was before, or after.

    Raises:
        UnknownName: A batch, campaign or study does not exist.
    """
    with database.read() as transaction:
        transaction.results.check(wanted)
    make = _ROWS[name]

    def pages() -> Iterator[Sequence[Row]]:
        for results in _pages(database, wanted, with_seeds=name is ResultTableName.RUNS):
            yield [row for result in results for row in make(result)]

    return Table(schema=result_schema(name), pages=pages)


def _pages(
    database: Database, wanted: ResultFilter, *, with_seeds: bool
) -> Iterator[Sequence[StoredResult]]:
    last = 0
    while True:
        with database.read() as transaction:
            numbers = transaction.results.numbers(wanted, after=last, limit=_NUMBERS)
        for some in batched(numbers, _PAGE):
            with database.read() as transaction:
                page = transaction.results.runs(some, with_seeds=with_seeds)
            yield page
        if len(numbers) < _NUMBERS:
            break
        last = numbers[-1]
    place: EvaluationPlace | None = None
    while True:
        with database.read() as transaction:
            page, place = transaction.results.evaluations(
                wanted, after=place, limit=_PAGE, with_seeds=with_seeds
            )
        yield page
        if place is None:
            return


def _run_rows(result: StoredResult) -> Iterator[Row]:
    report = result.report
    versions = report.get("versions") or {}
    yield {
        # Empty text says that there is none, as null does; a CSV file cannot tell them apart.
        **{name: None if value == "" else value for name, value in result.values.items()},
        "counts": result.definition.counts,
        "oracles": _listed(result.definition.oracles),
        "error": (report.get("failure") or {}).get("message") or None,
        # A run without steps has no mean of them.
        "step_cost_us": report.get("step_cost_us") if report.get("steps") else None,
        "trace_sha256": report.get("trace_sha256") or None,
        "drivora_version": versions.get("drivora"),
        "sumo_version": versions.get("libsumo"),
        "versions": _json(versions) if versions else None,
    }


def _run(result: StoredResult) -> Row:
    return {"run_id": result.values["run_id"], "label": result.values["label"] or None}


def _verdict_rows(result: StoredResult) -> Iterator[Row]:
    of, report = _run(result), result.report
    is_finished = report.get("status") == RunStatus.FINISHED
    agents = {ego: agent["name"] for ego, agent in (report.get("agents") or {}).items()}
    for place, told in enumerate(report.get("verdicts") or ()):
        verdict = {**_UNSAID, **told}
        is_violated = verdict["outcome"] == Outcome.VIOLATED
        # Few verdicts are violations, so that the others need not be read as values.
        (violation,) = read_all(Verdict, [told]) if is_violated else (None,)
        x, y = verdict["location"] or (None, None)
        yield {
            **verdict,
            **of,
            "place": place,
            "severity": verdict["severity"] if is_violated else None,
            "accountability": _accountability(verdict) if is_violated else None,
            "follows": None if violation is None else followed_oracle(violation) or None,
            "counted": None
            if violation is None
            else is_finished and result.definition.is_failure(violation, agents),
            "time_s": verdict["time"],
            "x": x,
            "y": y,
            "counterpart": verdict["counterpart"] or None,
            "message": verdict["message"] or None,
            "evidence": _json(verdict["evidence"]),
        }


def _metric_rows(result: StoredResult) -> Iterator[Row]:
    of, report = _run(result), result.report
    objectives = (report.get("measurement") or {}).get("objectives")
    for kind, values in (
        ("metric", report.get("metrics")),
        ("score", report.get("scores")),
        ("objective", objectives),
    ):
        for name, value in (values or {}).items():
            yield {**of, "kind": kind, "metric": name, "value": value}


def _agent_rows(result: StoredResult) -> Iterator[Row]:
    of, report = _run(result), result.report
    costs, privileged = report.get("agent_cost_us") or {}, report.get("privileged") or ()
    for ego, agent in (report.get("agents") or {}).items():
        yield {
            **of,
            "ego": ego,
            "agent": agent["name"],
            "parameters": _json(agent.get("parameters") or {}),
            "cost_us": costs.get(ego),
            "privileged": ego in privileged,
        }


_ROWS: Mapping[ResultTableName, Callable[[StoredResult], Iterator[Row]]] = {
    ResultTableName.RUNS: _run_rows,
    ResultTableName.VERDICTS: _verdict_rows,
    ResultTableName.METRICS: _metric_rows,
    ResultTableName.AGENTS: _agent_rows,
}


def _accountability(verdict: Mapping[str, Any]) -> str:
    avoidable = verdict["avoidable"]
    return accountable(
        verdict["at_fault"],
        None if avoidable is None else Answer(avoidable),
        undetermined=verdict["undetermined"],
    )


def _listed(names: Sequence[str] | None) -> str | None:
    return None if names is None else ",".join(names)


def _json(values: Mapping[str, Any]) -> str:
    return to_json(values).decode()
