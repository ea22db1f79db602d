"""A database with a million runs, for ``benchmarks.million_runs``.

The proportions are those of services that have worked for a year: one batch holds a fifth of all
runs, several hundred share the rest, and one campaign holds half of all evaluations. Agents come
and go, so that the runs of some are all old; some batches have one agent on one town, some all.
"""

from __future__ import annotations

import hashlib
import json
import random
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.report_encoding import report_to_json
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.runs.slot_state import SlotState
from drivora_service.store.database import Database
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.runs.facets import Facet, add_counts, facet_key
from drivora_service.store.runs.run_tables import (
    AttemptRow,
    BatchRow,
    ReportRow,
    RunRow,
    VerdictRow,
)

AGENTS = ("idm", "idm-mobil", "pdm-closed", "nmpc", "sumo-krauss", "plant-lite", "puffer-drive")
TOWNS = ("tee-town", "signal-grid", "roundabout", "Town01", "Town03", "Town04", "Town05")
ORACLES = (
    "collision",
    "off_road",
    "red_light",
    "route_deviation",
    "speeding",
    "stuck",
    "lane_keeping",
    "wrong_way",
)
_ENDS = (
    (RunStatus.FINISHED, 0.955),
    (RunStatus.AGENT_FAILED, 0.02),
    (RunStatus.CANCELLED, 0.01),
    (RunStatus.TIMED_OUT, 0.007),
    (RunStatus.SIMULATOR_CRASHED, 0.005),
    (RunStatus.PLUGIN_FAILED, 0.003),
)
_FAULTS = (
    (True, Accountability.AVOIDABLE),
    (True, Accountability.UNAVOIDABLE),
    (True, Accountability.NOT_MEASURABLE),
    (False, Accountability.NOT_AT_FAULT),
    (None, Accountability.UNDETERMINED),
)
_BEGIN = datetime(2026, 1, 1, tzinfo=UTC)
_CHUNK = 5000

Table = (
    type[DocumentRow]
    | type[RunRow]
    | type[ReportRow]
    | type[VerdictRow]
    | type[AttemptRow]
    | type[FoundRow]
)


def fill_runs(database: Database, runs: int) -> None:
    """Fills a new database with runs in batches, with their documents, reports and verdicts."""
    draw = random.Random(7)
    with database.write() as transaction:
        owner = transaction.workers.register()
        slots = [
            SlotState(
                name=f"slot-{number}",
                pid=number,
                run_id="",
                phase="idle",
                step=0,
                memory_bytes=1 << 28,
                runs=100,
                restarts=0,
                last_crash="",
                updated_at=_BEGIN,
            )
            for number in range(16)
        ]
        transaction.workers.beat(owner, slots)
    sizes = _sizes(draw, runs)
    seq = 0
    for number, size in enumerate(sizes, start=1):
        agents = draw.sample(AGENTS[:5], 1 if number % 4 else 4)
        if number <= 10:
            agents = ["retired-agent"]
        towns = draw.sample(TOWNS, 1 if number % 3 else 5)
        waiting = min(size, 400) if number > len(sizes) - 3 else 0
        for start in range(0, size, _CHUNK):
            count = min(_CHUNK, size - start)
            with database.write() as transaction:
                if start == 0:
                    transaction.session.add(
                        BatchRow(
                            seq=number,
                            id=f"{number:024x}",
                            name=f"batch {number}",
                            priority=1,
                            state="open",
                            created_at=_BEGIN + timedelta(hours=number),
                            size=size,
                            queued=waiting,
                            served=size - waiting,
                        )
                    )
                    transaction.session.flush()
                rest = size - start - waiting
                _fill_chunk(
                    transaction.session, draw, number, seq, count, rest, agents, towns, owner
                )
            seq += count


def _sizes(draw: random.Random, runs: int) -> list[int]:
    sizes = [runs // 5]
    while sum(sizes) < runs:
        sizes.append(min(int(10 ** draw.uniform(1, 4.3)), runs - sum(sizes)))
    first, *others = sizes
    return [*others[: len(others) // 2], first, *others[len(others) // 2 :]]


def _fill_chunk(
    session: Session,
    draw: random.Random,
    batch_seq: int,
    seq: int,
    count: int,
    rest: int,
    agents: list[str],
    towns: list[str],
    owner: str,
) -> None:
    """Writes runs; those after the first ``rest`` are queued."""
    rows: dict[Table, list[dict[str, Any]]] = {
        DocumentRow: [],
        RunRow: [],
        ReportRow: [],
        VerdictRow: [],
        AttemptRow: [],
        FoundRow: [],
    }
    counts: Counter[tuple[int, Facet]] = Counter()
    for index in range(count):
        seq += 1
        # Every scenario is run five times.
        name = (seq - 1) // 5
        text = json.dumps({"scenario": name, "padding": "x" * 600})
        sha256 = hashlib.sha256(str(name).encode()).hexdigest()
        if (seq - 1) % 5 == 0:
            rows[DocumentRow].append({"sha256": sha256, "body": text})
        status = RunStatus.QUEUED
        if index < rest:
            status = draw.choices([end for end, _ in _ENDS], [share for _, share in _ENDS])[0]
        verdicts = list(_verdicts(draw)) if status is RunStatus.FINISHED else []
        broken = [how for _, outcome, how in verdicts if outcome is Outcome.VIOLATED]
        found = {how[1] for how in broken}
        worst = next((member for member in Accountability if member in found), None)
        finished = status is RunStatus.FINISHED
        facet = Facet(
            agent=draw.choice(agents),
            town=draw.choice(towns),
            status=status,
            violated=bool(broken) if finished else None,
            accountability=worst,
        )
        counts[batch_seq, facet] += 1
        key = facet_key(facet)
        when = (_BEGIN + timedelta(seconds=30 * seq)).strftime("%Y-%m-%d %H:%M:%S.%f")
        over = status is not RunStatus.QUEUED
        rows[RunRow].append(
            {
                "seq": seq,
                "id": f"{seq:024x}",
                "revision": seq,
                "batch_seq": batch_seq,
                "item": index,
                "label": "",
                "document_sha256": sha256,
                "town": facet.town,
                "agent": facet.agent,
                "agent_override": facet.agent,
                "seed_override": None,
                "status": status,
                "cause": "" if finished or not over else "agent_raised",
                "created_at": when,
                "started_at": when if over else None,
                "ended_at": when if over else None,
                "cancel_requested": False,
                "attempts": int(over),
                "infrastructure_failures": 0,
                "crashes": 0,
                "interruptions": 0,
                "trace_sha256": "",
                "violations": len(broken) if finished else None,
                "at_fault_violations": sum(bool(how[0]) for how in broken) if finished else None,
                "observations": 0 if finished else None,
                "accountability": worst,
                "steps": 600 if finished else None,
                "sim_time_s": 30.0 if finished else None,
                "wall_time_s": 0.4 if finished else None,
                "facet": key,
            }
        )
        if not over:
            continue
        rows[AttemptRow].append(
            {
                "run_seq": seq,
                "number": 1,
                "owner_id": owner,
                "worker": "slot-0",
                "claimed_at": when,
                "started_at": when,
                "ended_at": when,
                "outcome": status,
                "cause": "",
                "signal": "",
                "log": "",
            }
        )
        rows[ReportRow].append({"run_seq": seq, "body": _report(f"{seq:024x}", status, finished)})
        rows[VerdictRow] += [
            {
                "run_seq": seq,
                "oracle": oracle,
                "ego": "ego_0",
                "outcome": outcome,
                "severity": "major",
                "at_fault": how[0],
                "accountability": how[1] if outcome is Outcome.VIOLATED else None,
                "time": 3.0,
                "counterpart": "",
                "batch_seq": batch_seq,
                "facet": key,
            }
            for oracle, outcome, how in verdicts
        ]
        # The verdicts of the report are always the same: the first one stands for all.
        rows[FoundRow] += [
            {
                "found_at": when,
                "run_seq": seq,
                "batch_seq": batch_seq,
                "place": 0,
                "oracle": oracle,
                "group_name": f"{oracle}|npc_vehicle, front|following",
                "agent": facet.agent,
                "town": facet.town,
                "at_fault": how[0],
                "accountability": how[1],
                "confirmation": "",
            }
            for oracle, outcome, how in verdicts
            if outcome is Outcome.VIOLATED
        ]
    connection = session.connection()
    for table, values in rows.items():
        if values:
            # By the driver: SQLAlchemy would take five times as long for a million rows.
            columns = ", ".join(values[0])
            places = ", ".join("?" * len(values[0]))
            connection.exec_driver_sql(
                f"INSERT INTO {table.__tablename__} ({columns}) VALUES ({places})",  # own names
                [tuple(row.values()) for row in values],
            )
    add_counts(session, counts)


def _verdicts(
    draw: random.Random,
) -> Iterator[tuple[str, Outcome, tuple[bool | None, Accountability | None]]]:
    if draw.random() < 0.12:
        for oracle in draw.sample(ORACLES[:6], draw.choice((1, 1, 1, 2, 3))):
            yield oracle, Outcome.VIOLATED, draw.choices(_FAULTS, (50, 5, 5, 30, 10))[0]
    if draw.random() < 0.3:
        yield "lane_keeping", Outcome.NOT_MEASURABLE, (None, None)


_TEMPLATES: dict[bool, str] = {}


def _report(run_id: str, status: RunStatus, finished: bool) -> str:
    if finished not in _TEMPLATES:
        verdicts = tuple(
            Verdict(
                oracle=oracle,
                ego="ego_0",
                outcome=Outcome.PASSED,
                message="The rule was kept.",
                evidence={"margin_m": 3.25, "limit": 10.0, "seen": [1, 2, 3]},
            )
            for oracle in ORACLES
        )
        _TEMPLATES[finished] = report_to_json(
            RunReport(
                run_id="RUN",
                status=RunStatus.FINISHED if finished else RunStatus.AGENT_FAILED,
                verdicts=verdicts if finished else (),
                metrics={f"metric_{number}": 1.5 for number in range(20)} if finished else {},
                failure=None
                if finished
                else RunFailure(cause="agent_raised", message="raised", log="line\n" * 40),
            )
        )
    text = _TEMPLATES[finished].replace('"RUN"', f'"{run_id}"')
    return text if finished else text.replace('"agent_failed"', f'"{status.value}"')
