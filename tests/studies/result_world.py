"""A store with runs of every kind, and what it holds by SQL alone."""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.database import Database, database_file
from drivora_service.store.runs.run_records import Priority, RunOptions
from tests.store.samples import claim, ended, finish, finished, new_run, register
from tests.studies.computed_study import campaign_content, opened
from tests.studies.example_study import run_computed, stored, study_content

ODD_LABELS = ('=HYPERLINK("http://a.example")', "'quoted'", "-2+3", "line\nbreak, and comma")
ODD_NUMBERS = {"sum": 0.1 + 0.2, "tiny": 5e-324, "large": 1.7976931348623157e308, "none": None}


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """A store.

    Attributes:
        batch: Of four runs with odd labels: two finished, one failed, one queued.
        single: Job that was posted singly, with a seed of its own.
        local: Campaign of a command, whose evaluations have no runs.
        served: Campaign of a service: its first three evaluations have runs, and the first one a
            second, identical run. The others' runs were removed.
        study: Study of a command.
    """

    database: Database
    batch: str
    single: str
    local: str
    served: str
    study: str

    @property
    def file(self) -> Path:
        """The file of the database."""
        file = database_file(self.database.engine.url.render_as_string())
        assert file is not None
        return file


@contextlib.contextmanager
def result_world(folder: Path, catalogues: Catalogues) -> Iterator[World]:
    """Opens a new store and fills it."""
    with opened(folder, catalogues) as study:
        database = study.database
        owner = register(database)
        batch = _batch(database, owner)
        with database.write() as transaction:
            (single,) = transaction.jobs.submit(
                [new_run('{"seed":4}', options=RunOptions(seed_override=77))]
            )
        claim(database, owner, 1)
        finish(database, owner, finished(single, "collision", faults=(False,)))
        local = study.run(campaign_content()).id
        served = study.run(campaign_content() | {"name": "served", "seed": 5}).id
        _serve(database, owner, served)
        study_id = stored(
            database,
            catalogues,
            folder,
            scenarios=study_content()["scenarios"][:1],
            agents=[{"name": "idm"}],
            repetitions=1,
        )
        run_computed(database, catalogues, folder, study_id)
        yield World(
            database=database,
            batch=batch,
            single=single,
            local=local,
            served=served,
            study=study_id,
        )


def _batch(database: Database, owner: str) -> str:
    with database.write() as transaction:
        batch = transaction.batches.create(name="nightly", priority=Priority.CI).id
        runs = [
            new_run(f'{{"seed":{number}}}', label=label, agent="idm-mobil")
            for number, label in enumerate(ODD_LABELS)
        ]
        ids = transaction.jobs.submit(runs, batch_id=batch)
    claim(database, owner, 3)
    violated = Verdict(
        oracle="collision",
        ego="ego",
        outcome=Outcome.VIOLATED,
        message="=cmd()",
        severity=Severity.CRITICAL,
        at_fault=True,
        avoidable=Answer.NO,
        physically_avoidable=Answer.YES,
        time=0.1 + 0.2,
        step=6,
        location=(1 / 3, -2 / 3),
        counterpart="@walker",
        evidence={"ego_speed": 1 / 7, "rule": "“rear”", "missing": None},
    )
    first = finished(ids[0], "discomfort", severity=Severity.OBSERVATION, faults=(True,))
    report = replace(
        first.report,
        verdicts=(*first.report.verdicts, violated),
        metrics=ODD_NUMBERS,
        scores={"min_gap": -0.0},
        trace_sha256="ab" * 32,
        step_cost_us=12.5,
        agents={"ego": AgentChoice(name="idm-mobil", parameters={"politeness": 0.1 + 0.2})},
        agent_cost_us={"ego": 3.25},
        privileged=("ego",),
        versions={"drivora": "0.1.0", "libsumo": "1.28.0", "numpy": "2.4"},
    )
    failure = RunFailure(cause="agent_raised", message="=the agent raised")
    failed = RunReport(run_id=ids[1], status=RunStatus.AGENT_FAILED, failure=failure)
    finish(database, owner, replace(first, report=report), ended(failed), finished(ids[2]))
    with database.write() as transaction:
        # Its last run stays queued.
        transaction.batches.pause(batch)
    return batch


def _serve(database: Database, owner: str, campaign_id: str) -> None:
    """Stores runs of the first evaluations of a campaign, as the queue of a service does."""
    with database.write() as transaction:
        batch = transaction.campaign_runs.open(campaign_id)
        numbers = {f"{campaign_id}-{number}": number for number in range(3)}
        numbers[f"{campaign_id}-0-again"] = 0
        transaction.campaign_runs.put(
            batch,
            *(
                new_run(f'{{"seed":9,"n":{n}}}', run_id=run_id, item=n)
                for run_id, n in numbers.items()
            ),
        )
    claimed = claim(database, owner, 100)
    finish(database, owner, *(finished(one) for one in claimed if one in numbers))


def held(file: Path) -> dict[str, dict[str, Any]]:
    """Returns what a store holds of each run, by its id, in the order of the tables."""
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.row_factory = sqlite3.Row
        rows = connection.execute(
            "SELECT r.*, b.id AS batch_id, p.body AS report, d.body AS document,"
            " c.id AS campaign_id, c.name AS campaign, c.study_id"
            " FROM runs r JOIN batches b ON b.seq = r.batch_seq"
            " LEFT JOIN reports p ON p.run_seq = r.seq"
            " LEFT JOIN campaigns c ON c.batch_id = b.id"
            " JOIN documents d ON d.sha256 = r.document_sha256 ORDER BY r.seq"
        ).fetchall()
        runs = {row["id"]: {**dict(row), "source": "run"} for row in rows}
        rows = connection.execute(
            "SELECT c.id || '-' || e.number AS id, e.number AS item, c.batch_id,"
            " c.id AS campaign_id, c.name AS campaign, c.study_id, c.study_method, c.repetition,"
            " c.agent, e.report, d.body AS document"
            " FROM evaluations e JOIN campaigns c ON c.seq = e.campaign_seq"
            " LEFT JOIN documents d ON d.sha256 = e.document_sha256"
            " ORDER BY e.campaign_seq, e.number"
        ).fetchall()
        for row in rows:
            runs.setdefault(row["id"], {**dict(row), "source": "evaluation"})
    for run in runs.values():
        run["report"] = json.loads(run["report"] or "{}")
        run["document"] = json.loads(run["document"] or "{}")
        run["status"] = run.get("status") or run["report"]["status"]
    statuses = {str(run["status"]) for run in runs.values()}
    assert statuses >= {"finished", "queued", "agent_failed"}, statuses
    return runs
