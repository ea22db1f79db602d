"""Campaigns with many evaluations, for ``benchmarks.million_runs``."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import insert
from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.verdict_json import verdict_to_json
from drivora_service.runs.report_encoding import report_to_json
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.campaign_tables import (
    CampaignRow,
    EvaluationRow,
    FailureKindRow,
    FailureRow,
)
from drivora_service.store.database import Database
from drivora_service.store.failures.failure_tables import FoundRow

CAMPAIGNS = 300
_BEGIN = datetime(2026, 1, 1, tzinfo=UTC)
_CHUNK = 5000
_RULES = ("following", "cut_in", "standing", "right_of_way", "signals", "across")


def fill_campaigns(database: Database, evaluations: int) -> None:
    """Adds campaigns; the tenth has half of all evaluations."""
    draw = random.Random(8)
    for seq in range(1, CAMPAIGNS + 1):
        size = evaluations // 2 if seq == 10 else evaluations // 2 // (CAMPAIGNS - 1)
        state = "running" if seq == 150 else "failed" if seq % 40 == 0 else "finished"
        with database.write() as transaction:
            transaction.session.add(_campaign(seq, state, size))
        kinds: dict[str, dict[str, Any]] = {}
        numbers = {"judged": 0, "invalid": 0, "failed": 0, "violating": 0, "at_fault": 0}
        for start in range(0, size, _CHUNK):
            chunk = range(start, min(size, start + _CHUNK))
            with database.write() as transaction:
                _fill_chunk(transaction.session, draw, seq, chunk, kinds, numbers)
        with database.write() as transaction:
            if kinds:
                counted = [kind | {"groups": len(kind["groups"])} for kind in kinds.values()]
                transaction.session.execute(insert(FailureKindRow), counted)
            row = transaction.session.get_one(CampaignRow, seq)
            row.judged, row.invalid, row.failed = (
                numbers["judged"],
                numbers["invalid"],
                numbers["failed"],
            )
            row.violating, row.at_fault = numbers["violating"], numbers["at_fault"]


def _campaign(seq: int, state: str, size: int) -> CampaignRow:
    return CampaignRow(
        seq=seq,
        id=f"c{seq:023x}",
        name=f"campaign {seq}",
        document=json.dumps({"padding": "x" * 2000}),
        tester="random",
        agent="idm",
        town="Town01",
        network_sha256="0" * 64,
        budget=size,
        versions="{}",
        state=state,
        created_at=_BEGIN,
        updated_at=_BEGIN,
        evaluations=size,
    )


def _fill_chunk(
    session: Session,
    draw: random.Random,
    campaign_seq: int,
    chunk: Sequence[int],
    kinds: dict[str, dict[str, Any]],
    numbers: dict[str, int],
) -> None:
    evaluations: list[dict[str, Any]] = []
    failures: list[dict[str, Any]] = []
    for number in chunk:
        # A quarter of the evaluations fail, as in a campaign with many failures.
        broken = list(_failures(draw, campaign_seq, number)) if draw.random() < 0.25 else []
        status = "judged" if broken or draw.random() < 0.97 else draw.choice(("invalid", "failed"))
        failures += broken
        for kind in {failure["kind"] for failure in broken}:
            _count(kinds, campaign_seq, number, kind, broken)
        numbers[status] += 1
        numbers["violating"] += bool(broken)
        numbers["at_fault"] += any(failure["at_fault"] for failure in broken)
        evaluations.append(
            {
                "campaign_seq": campaign_seq,
                "number": number,
                "generation": number // 50,
                "origin": "mutation",
                "parents": "[]",
                "genes": json.dumps([0.5] * 20),
                "status": status,
                "document_sha256": None,
                "violations": len(broken),
                "at_fault_violations": sum(bool(failure["at_fault"]) for failure in broken),
                "accountability": broken[0]["accountability"] if broken else None,
                "sim_time_s": 30.0,
                "wall_time_s": 0.4,
                "search_s": 0.01,
                "prepare_s": 0.01,
                "told_at": _BEGIN,
                "report": _REPORT,
                "violating": bool(broken),
            }
        )
    session.execute(insert(EvaluationRow), evaluations)
    if failures:
        session.execute(insert(FailureRow), failures)
        session.execute(insert(FoundRow), [_make_found_row(failure) for failure in failures])


def _failures(draw: random.Random, campaign_seq: int, number: int) -> Iterator[dict[str, Any]]:
    for place in range(draw.choice((1, 1, 2))):
        oracle = draw.choice(("collision", "off_road", "red_light"))
        at_fault = draw.choice((True, False, None))
        yield {
            "campaign_seq": campaign_seq,
            "number": number,
            "place": place,
            "oracle": oracle,
            "kind": f"{oracle}|road {int(draw.paretovariate(0.7)) % 60}",
            "at_fault": at_fault,
            "accountability": Accountability.AVOIDABLE if at_fault else Accountability.UNDETERMINED,
            "confirmation": Confirmation.CONFIRMED if draw.random() < 0.9 else Confirmation.FLAKY,
            "group": draw.randrange(8),
            "verdict": _VERDICT,
        }


def _make_found_row(failure: dict[str, Any]) -> dict[str, Any]:
    same = ("campaign_seq", "number", "place", "oracle", "at_fault", "accountability")
    return {name: failure[name] for name in same} | {
        "found_at": _BEGIN + timedelta(seconds=10 * failure["number"]),
        "group": f"{failure['oracle']}|npc_vehicle, front|{_RULES[failure['group'] % len(_RULES)]}",
        "agent": "idm",
        "town": "Town01",
        "confirmation": failure["confirmation"],
    }


def _count(
    kinds: dict[str, dict[str, Any]],
    campaign_seq: int,
    number: int,
    kind: str,
    broken: Sequence[dict[str, Any]],
) -> None:
    alike = [failure for failure in broken if failure["kind"] == kind]
    counts = kinds.setdefault(
        kind,
        {"campaign_seq": campaign_seq, "kind": kind, "first": number, "groups": set()}
        | dict.fromkeys(
            ("failures", "violations", "at_fault", "avoidable", "confirmed", "flaky"), 0
        ),
    )
    counts["groups"].update(failure["group"] for failure in alike)
    counts["failures"] += 1
    counts["violations"] += len(alike)
    counts["at_fault"] += any(failure["at_fault"] for failure in alike)
    counts["avoidable"] += any(
        failure["accountability"] is Accountability.AVOIDABLE for failure in alike
    )
    for confirmation in (Confirmation.CONFIRMED, Confirmation.FLAKY):
        counts[confirmation.value] += any(
            failure["confirmation"] is confirmation for failure in alike
        )


_VERDICT = verdict_to_json(
    Verdict(
        oracle="collision",
        ego="ego_0",
        outcome=Outcome.VIOLATED,
        severity=Severity.MAJOR,
        message="Collided with a vehicle at 5.9 m/s: the ego hit with its front.",
        at_fault=True,
        time=8.7,
        evidence={"speed": 5.9, "counterpart_role": "npc_vehicle", "padding": "x" * 200},
    )
)
_REPORT = report_to_json(
    RunReport(
        run_id="RUN",
        status=RunStatus.FINISHED,
        metrics={f"metric_{number}": 1.5 for number in range(180)},
    )
)
