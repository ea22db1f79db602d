"""The times of every documented list, filter and summary on a million runs.

Fills a database (see ``benchmarks.million_fill``), then asks the HTTP application in this process,
and prints p50, p95 and how SQLite looks for the answer. What claiming and finishing cost is CPU
time of this process.

    python -m benchmarks.million_runs fill --database /tmp/million/drivora.sqlite3
    python -m benchmarks.million_runs ask --database /tmp/million/drivora.sqlite3 --out FILE.md
"""

from __future__ import annotations

import argparse
import asyncio
import gc
import re
import sqlite3
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import httpx
from fastapi import FastAPI
from sqlalchemy import event, text

from benchmarks.million_campaigns import fill_campaigns
from benchmarks.million_fill import fill_runs
from drivora_service.api.answers.network_imports import NetworkImports
from drivora_service.api.application import create_api
from drivora_service.api.context import ApiContext, Limits
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.stored_gene_spaces import GeneSpaces
from drivora_service.campaigns.hosts.campaign_supervisor import CampaignSupervisor
from drivora_service.campaigns.hosts.engine_process import EngineSetup
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.traces.trace_places import TracePlaces
from drivora_service.studies.service_studies import ServiceStudies
from drivora_service.suites.minimization.minimization_runner import MinimizationRunner

_RUN_FILTERS = {
    "all": "",
    "status": "status=timed_out",
    "two statuses": "status=timed_out&status=queued",
    "status, none": "status=infrastructure_failed",
    "agent": "agent=idm",
    "agent, only old runs": "agent=retired-agent",
    "agent, none": "agent=frenetix",
    "agent + violated": "agent=idm&violated=true",
    "agent + violated, only old": "agent=retired-agent&violated=true",
    "agent + violated, none": "agent=plant-lite&violated=true",
    "agent + town, none": "agent=retired-agent&town=NONE",
    "town": "town=Town04",
    "town + status": "town=Town04&status=agent_failed",
    "violated": "violated=true",
    "not violated": "violated=false",
    "accountability": "accountability=unavoidable",
    "accountability, none": "accountability=not_judged",
    "scenario": "scenario_sha256=SCENARIO",
    "scenario + violated": "scenario_sha256=SCENARIO&violated=true",
    "scenario + batch, none": "scenario_sha256=SCENARIO&batch=SMALL",
    "oracle": "oracle=collision",
    "oracle, none": "oracle=deadlock",
    "oracle + outcome": "oracle=lane_keeping&outcome=not_measurable",
    "oracle + at fault": "oracle=collision&at_fault=true",
    "oracle + not at fault": "oracle=red_light&at_fault=false",
    "oracle + outcome + at fault, none": (
        "oracle=lane_keeping&outcome=not_measurable&at_fault=true"
    ),
    "oracle + agent": "oracle=collision&agent=nmpc",
    "oracle + agent, only old": "oracle=collision&agent=retired-agent",
    "oracle + agent, none": "oracle=collision&agent=puffer-drive",
    "oracle + status, none": "oracle=collision&status=cancelled",
    "batch of 200,000": "batch=BIG",
    "batch + status": "batch=BIG&status=simulator_crashed",
    "batch + status, none": "batch=BIG&status=infrastructure_failed",
    "batch + violated": "batch=BIG&violated=true",
    "batch + violated, none": "batch=QUEUE&violated=true",
    "batch + accountability": "batch=BIG&accountability=not_at_fault",
    "batch + agent": "batch=BIG&agent=idm",
    "batch + agent, none": "batch=BIG&agent=retired-agent",
    "batch + town + violated": "batch=BIG&town=Town04&violated=true",
    "batch + oracle": "batch=BIG&oracle=speeding",
    "batch + oracle, none": "batch=BIG&oracle=deadlock",
    "batch + oracle + at fault": "batch=BIG&oracle=speeding&at_fault=true",
    "batch + oracle, small batch": "batch=SMALL&oracle=collision",
    "unknown batch": "batch=nothing",
    "all filters": (
        "batch=BIG&status=finished&agent=idm&town=Town04&oracle=speeding&at_fault=true"
        "&accountability=avoidable&violated=true"
    ),
    "oldest first": "order=created_at",
    "since + until": "since=2026-02-10T00:00:00Z&until=2026-02-20T00:00:00Z",
    "since + agent + violated": "since=2026-01-10T00:00:00Z&agent=idm&violated=true",
    "since + oracle + at fault": "since=2026-01-10T00:00:00Z&oracle=collision&at_fault=true",
    "at fault": "at_fault=true",
    "not at fault + town": "at_fault=false&town=Town04",
    "campaign": "campaign=CAMPAIGN",
    "500 runs of a page, status": "status=agent_failed&limit=500",
    "500 runs of a page, batch + violated": "batch=BIG&violated=true&limit=500",
}
_OTHERS = {
    "counts of runs": "/runs:counts",
    "counts of runs, agent": "/runs:counts?agent=idm",
    "counts of runs, oracle": "/runs:counts?oracle=collision",
    "counts of runs, batch": "/runs:counts?batch=BIG",
    "counts of runs, since": "/runs:counts?since=2026-01-10T00:00:00Z",
    "batches": "/batches",
    "500 batches of a page": "/batches?limit=500",
    "batch of 200,000": "/batches/BIG",
    "small batch": "/batches/SMALL",
    "run": "/runs/RUN",
    "job": "/jobs/RUN",
    "campaigns": "/campaigns",
    "campaigns, state": "/campaigns?state=finished&state=failed",
    "campaigns, state, none": "/campaigns?state=cancelled",
    "campaign of 100,000": "/campaigns/CAMPAIGN",
    "discoveries of 100,000": "/campaigns/CAMPAIGN/discoveries",
    "evaluations": "/campaigns/CAMPAIGN/evaluations",
    "evaluations, newest": "/campaigns/CAMPAIGN/evaluations?order=-number",
    "evaluations, status": "/campaigns/CAMPAIGN/evaluations?status=failed",
    "evaluations, violating": "/campaigns/CAMPAIGN/evaluations?violating=true&order=-number",
    "evaluations, not violating": "/campaigns/CAMPAIGN/evaluations?violating=false",
    "evaluations, status + violating, none": (
        "/campaigns/CAMPAIGN/evaluations?status=failed&violating=true"
    ),
    "evaluations, generation": "/campaigns/CAMPAIGN/evaluations?generation=900",
    "evaluations, generation, none": "/campaigns/CAMPAIGN/evaluations?generation=999999",
    "evaluations, generation + status": (
        "/campaigns/CAMPAIGN/evaluations?generation=900&status=invalid"
    ),
    "all failures": "/failures",
    "all failures, avoidable": "/failures?accountability=avoidable",
    "all failures, agent, only old": "/failures?agent=retired-agent",
    "all failures, none": "/failures?oracle=deadlock",
    "all failures, campaign": "/failures?campaign=CAMPAIGN",
    "all failures, since": "/failures?since=2026-01-10T00:00:00Z&oracle=collision",
    "groups of failures": "/failures/groups",
    "groups of failures, avoidable": "/failures/groups?accountability=avoidable",
    "groups of failures, campaign": "/failures/groups?campaign=CAMPAIGN",
    "failures": "/campaigns/CAMPAIGN/failures",
    "failures, kind": "/campaigns/CAMPAIGN/failures?kind=collision|road 59",
    "failures, kind, none": "/campaigns/CAMPAIGN/failures?kind=none",
    "failures, rule": "/campaigns/CAMPAIGN/failures?oracle=red_light",
    "failures, rule, none": "/campaigns/CAMPAIGN/failures?oracle=deadlock",
    "failures, at fault": "/campaigns/CAMPAIGN/failures?at_fault=true",
    "failures, accountability, none": ("/campaigns/CAMPAIGN/failures?accountability=not_at_fault"),
    "failures, confirmation": "/campaigns/CAMPAIGN/failures?confirmation=flaky",
    "failures, confirmation, none": "/campaigns/CAMPAIGN/failures?confirmation=open",
}
_OUTSIDE = {"metrics": "/metrics", "readiness": "/readyz"}


class Asked:
    """The statements sent to the database, with their values."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self.statements: list[tuple[str, tuple[object, ...]]] = []

    @contextmanager
    def record_statements(self) -> Iterator[None]:
        """Records the statements."""

        def note(
            _: object, __: object, statement: str, values: tuple[object, ...], *___: object
        ) -> None:
            if statement.startswith("SELECT"):
                self.statements.append((statement, values))

        event.listen(self._database.engine, "before_cursor_execute", note)
        yield
        event.remove(self._database.engine, "before_cursor_execute", note)

    def plan(self) -> str:
        """Returns the tables that are read, with the indices used."""
        steps: list[str] = []
        with self._database.engine.connect() as connection:
            for statement, values in self.statements:
                rows = connection.exec_driver_sql("EXPLAIN QUERY PLAN " + statement, values)
                steps += [row.detail for row in rows]
        kept = [
            re.sub(r"USING (COVERING )?(INDEX|INTEGER PRIMARY KEY) ?", "", step)
            for step in steps
            if re.match(r"(SCAN|SEARCH) (?!\(|anon|CONSTANT)", step) or "TEMP" in step
        ]
        return "; ".join(dict.fromkeys(kept))


def _engines(database: Database, folder: Path) -> EngineSetup:
    return EngineSetup(
        database_url=str(database.engine.url),
        campaigns=folder / "campaigns",
        traces=TracePlaces.below(folder),
        shipped_networks=shipped_networks(),
        imported_networks=None,
        workers=1,
    )


def application(database: Database, folder: Path) -> FastAPI:
    """Builds the HTTP application over a database; no run is started."""
    campaigns = CampaignSupervisor(database, _engines(database, folder), at_once=1)
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    traces = TraceFolder(folder / "traces")
    return create_api(
        ApiContext(
            opened=lambda: database,
            revision=database.changes.value,
            catalogues=catalogues,
            tokens=None,
            limits=Limits(
                body_bytes=1 << 20, network_bytes=1 << 20, batch_items=100, queued_runs=10**6
            ),
            trace_path=traces.path,
            gene_spaces=GeneSpaces(catalogues),
            campaign_folder=lambda campaign_id: CampaignFolder(folder / "campaigns", campaign_id),
            wake=lambda: None,
            campaigns=campaigns,
            studies=ServiceStudies(database, campaigns),
            minimizations=MinimizationRunner(lambda: database, catalogues, traces.path, at_once=1),
            imports=NetworkImports(folder / "networks"),
            reserve=lambda _runs: "",
            faults=dict,
            storage_fault=lambda: "",
            stopping=lambda: False,
        )
    )


async def ask(database: Database, folder: Path, rounds: int) -> list[str]:
    """Times every query and returns the lines of the table."""
    with database.read() as transaction:
        rows = transaction.session.execute(
            text("SELECT id, size FROM batches WHERE id != 'jobs' ORDER BY size")
        ).all()
        scenario = transaction.session.execute(
            text("SELECT document_sha256 FROM runs WHERE seq = (SELECT max(seq) / 2 FROM runs)")
        ).scalar_one()
        run = transaction.session.execute(
            text("SELECT id FROM runs WHERE seq = (SELECT max(seq) / 2 FROM runs)")
        ).scalar_one()
        queue = transaction.session.execute(
            text("SELECT id FROM batches WHERE queued = size ORDER BY seq LIMIT 1")
        ).scalar()
    names = {
        "SCENARIO": scenario,
        "BIG": rows[-1].id,
        "SMALL": rows[0].id,
        "QUEUE": queue or rows[0].id,
        "RUN": run,
        "CAMPAIGN": f"c{10:023x}",
        "NONE": "Town99",
    }
    queries = [(f"runs: {name}", f"/api/v1/runs?{query}") for name, query in _RUN_FILTERS.items()]
    queries += [(name, f"/api/v1{path}") for name, path in _OTHERS.items()]
    queries += list(_OUTSIDE.items())
    lines: list[str] = []
    transport = httpx.ASGITransport(app=application(database, folder))
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
        # As the service does after its start.
        gc.collect()
        gc.freeze()
        for name, path in [*queries, *await _last_pages(client, names)]:
            for word, value in names.items():
                path = re.sub(rf"\b{word}\b", value, path)
            asked = Asked(database)
            with asked.record_statements():
                answer = await client.get(path)
            assert answer.status_code == 200, (path, answer.text)
            wall: list[float] = []
            cpu: list[float] = []
            for number in range(rounds):
                # Else the service would answer from memory.
                known = {"If-None-Match": f'"{number}"'}
                begun, worked = time.perf_counter(), time.process_time()
                await client.get(path, headers=known)
                wall.append((time.perf_counter() - begun) * 1e3)
                cpu.append((time.process_time() - worked) * 1e3)
            figures = (
                f"{figure:.1f}"
                for times in (wall, cpu)
                for figure in (statistics.median(times), statistics.quantiles(times, n=20)[-1])
            )
            line = f"| {name} | {' | '.join(figures)} | {asked.plan()} |"
            print(line, flush=True)
            lines.append(line)
    return lines


async def _last_pages(client: httpx.AsyncClient, names: dict[str, str]) -> list[tuple[str, str]]:
    """Walks lists to their ends and returns the addresses of their last pages."""
    last: list[tuple[str, str]] = []
    for name, path in (
        ("runs: last page, status", "/api/v1/runs?status=timed_out&limit=500"),
        ("runs: last page, agent", "/api/v1/runs?agent=retired-agent&limit=500"),
        (
            "runs: last page, batch + status",
            f"/api/v1/runs?batch={names['BIG']}&status=agent_failed&limit=500",
        ),
        (
            "evaluations, last page",
            f"/api/v1/campaigns/{names['CAMPAIGN']}/evaluations?status=failed&limit=500",
        ),
    ):
        token, address = "", path
        while True:
            address = f"{path}&page_token={token}" if token else path
            token = (await client.get(address)).json()["next_page_token"]
            if not token:
                break
        last.append((name, address))
    return last


def measure_writes(database: Database, runs: int) -> str:
    """Measures the CPU time of claiming and finishing runs one by one."""
    claimed = finished = 0.0
    with database.write() as transaction:
        owner = transaction.workers.register()
    for _ in range(runs):
        begun = time.process_time()
        with database.write() as transaction:
            (spec,) = transaction.queue.claim(owner, 1, trace_path=lambda *_: "")
        claimed += time.process_time() - begun
        now = datetime.now(UTC)
        report = RunReport(run_id=spec.run_id, status=RunStatus.FINISHED, steps=10)
        end = AttemptEnd(report=report, worker="slot-0", started=now, ended=now)
        begun = time.process_time()
        with database.write() as transaction:
            transaction.queue.finish(owner, [end], RetryPolicy())
        finished += time.process_time() - begun
    return (
        f"Claiming a run took {claimed / runs * 1e3:.2f} ms and finishing it "
        f"{finished / runs * 1e3:.2f} ms of CPU time (mean of {runs}, one by one)."
    )


def main() -> None:
    """Fills or queries."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("fill", "ask"))
    parser.add_argument("--database", type=Path, required=True)
    parser.add_argument("--runs", type=int, default=1_000_000)
    parser.add_argument("--evaluations", type=int, default=200_000)
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    database = open_database(f"sqlite:///{options.database}")
    if options.what == "fill":
        # A fill that is damaged by a power loss is repeated.
        event.listen(database.engine, "connect", _without_waiting_for_the_disk)
        database.engine.dispose()
        fill_runs(database, options.runs)
        fill_campaigns(database, options.evaluations)
    else:
        lines = asyncio.run(ask(database, options.database.parent, options.rounds))
        cost = measure_writes(database, 200)
        print(cost)
        if options.out is not None:
            size = options.database.stat().st_size
            options.out.write_text(_page(database, lines, cost, size))
    database.close()


def _without_waiting_for_the_disk(connection: sqlite3.Connection, _: object) -> None:
    connection.execute("PRAGMA synchronous = OFF").close()


def _page(database: Database, lines: list[str], cost: str, size: int) -> str:
    with database.read() as transaction:
        counted = {
            name: transaction.session.execute(text(f"SELECT count(*) FROM {name}")).scalar_one()
            for name in ("runs", "batches", "campaigns", "evaluations", "facets")
        }
    holds = ", ".join(f"{number:,} {name}" for name, number in counted.items())
    return "\n".join(
        (
            "# A million runs",
            "",
            "Made by `python -m benchmarks.million_runs fill --database FILE`, then `ask "
            "--database FILE --out benchmarks/results/million_runs.md`.",
            "",
            f"The database holds {holds}: {size / 1e9:.1f} GB. Times are milliseconds from the "
            "request to the answer of the application in the same process, and of CPU time "
            f"among them; pages of 50 unless said otherwise. {cost}",
            "",
            "| query | p50 | p95 | CPU p50 | CPU p95 | what SQLite reads |",
            "|---|---|---|---|---|---|",
            *lines,
            "",
        )
    )


if __name__ == "__main__":
    main()
