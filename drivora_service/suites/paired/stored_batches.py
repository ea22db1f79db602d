"""Reading the runs of stored batches for a comparison."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.oracles.verdict import WITHOUT_FINDING
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    FailureDefinition,
)
from drivora_service.runs.run_report import RunReport
from drivora_service.store.database import Database, Transaction
from drivora_service.store.id_lookup import find_id
from drivora_service.store.id_records import IdKind
from drivora_service.store.runs.run_records import JobFilter, RunSummary
from drivora_service.suites.paired.batch_comparison import BatchComparison
from drivora_service.suites.paired.batch_pairing import BatchRuns, compare_runs
from drivora_service.suites.paired.failure_rules import Rules
from drivora_service.suites.paired.paired_runs import (
    DrivenScenario,
    PairedRun,
    read_driven_scenario,
)

_PAGE = 500


def compare_stored_batches(
    database: Database,
    first: str,
    second: str,
    *,
    rules: Rules = Rules(),  # noqa: B008 # frozen
    metrics: Sequence[str] = (),
) -> BatchComparison:
    """Compares two stored batches.

    Args:
        database: Holds the batches.
        first: Id of A or the first digits of it, its name (the newest of this name), or ``latest``.
        second: B, likewise.
        rules: What counts as a failure.
        metrics: Metrics to compare; empty: all.

    Raises:
        UnknownName: There is no such batch or metric.
    """
    scenarios: dict[str, DrivenScenario] = {}
    a = read_batch_runs(database, first, scenarios)
    b = read_batch_runs(database, second, scenarios)
    return compare_runs(a, b, rules=rules, metrics=metrics)


def read_batch_runs(
    database: Database, wanted: str, scenarios: dict[str, DrivenScenario]
) -> BatchRuns:
    """Reads the runs of a batch, page by page.

    Args:
        database: Holds the batch.
        wanted: Id of the batch or the first digits of it, its name (the newest of this name), or
            ``latest``.
        scenarios: Known scenarios by the hash of their document; new ones are added.

    Raises:
        UnknownName: There is no such batch.
    """
    runs: list[PairedRun] = []
    token = ""
    with database.read() as transaction:
        found = find_id(transaction.session, [IdKind.BATCH], wanted, newest_of_name=True)
        batch = transaction.batches.get(found.id)
    while True:
        with database.read() as transaction:
            page = transaction.jobs.page(
                JobFilter(batch_id=batch.id), limit=_PAGE, page_token=token, newest_first=False
            )
            _read_scenarios(transaction, page.items, scenarios)
            ids = [job.id for job in page.items]
            reports = transaction.jobs.reports(ids)
            definitions = transaction.jobs.definitions(ids)
        for job in page.items:
            scenario = scenarios.get(job.scenario_sha256)
            if scenario is not None:
                definition = definitions.get(job.id, DEFAULT_DEFINITION)
                runs.append(_run(job, scenario, reports.get(job.id), definition))
        token = page.next_page_token
        if not token:
            return BatchRuns(batch=batch, runs=tuple(runs))


def _read_scenarios(
    transaction: Transaction, jobs: Sequence[RunSummary], scenarios: dict[str, DrivenScenario]
) -> None:
    wanted = {job.scenario_sha256 for job in jobs} - scenarios.keys()
    for sha256, document in transaction.jobs.documents(sorted(wanted)).items():
        scenarios[sha256] = read_driven_scenario(document)


def _run(
    job: RunSummary,
    scenario: DrivenScenario,
    report: RunReport | None,
    definition: FailureDefinition,
) -> PairedRun:
    verdicts = () if report is None else report.verdicts
    return PairedRun(
        id=job.id,
        label=job.label,
        scenario=scenario,
        seed=scenario.seed if job.seed is None else job.seed,
        status=job.status,
        cause=job.cause,
        trace_sha256="" if report is None else report.trace_sha256,
        oracles=frozenset(verdict.oracle for verdict in verdicts),
        # Batches have thousands of runs, and most verdicts have no finding.
        verdicts=tuple(v for v in verdicts if v.outcome not in WITHOUT_FINDING),
        metrics={} if report is None else report.metrics,
        agents={} if report is None else report.agents,
        agent=job.agent,
        configuration=job.configuration,
        configuration_id=job.configuration_id,
        versions={} if report is None else report.versions,
        definition=definition,
    )
