"""Campaigns as commands print them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from drivora_service.cli.output import number, print_table
from drivora_service.oracles.accountability import IN_WORDS, accountability
from drivora_service.oracles.verdict_json import verdict_to_json
from drivora_service.runs.encoding import report_to_json
from drivora_service.store.campaign_records import (
    CampaignCounts,
    CampaignRecord,
    CampaignSummary,
    EvaluationRecord,
    Failure,
    FailureKind,
)

_SHOWN = 40
"""Evaluations of a lineage that people are shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignFindings:
    """A campaign with what it has found.

    Attributes:
        is_running: Whether a process works on it.
    """

    record: CampaignRecord
    is_running: bool
    kinds: tuple[FailureKind, ...]
    failures: tuple[Failure, ...]


def campaign_result(found: CampaignFindings) -> dict[str, Any]:
    """Returns the printed form of a campaign; the keys are a contract with scripts."""
    return {
        **summary(found.record, running=found.is_running),
        "kinds": [asdict(kind) for kind in found.kinds],
        "failures": [failure_result(failure) for failure in found.failures],
    }


def summary(record: CampaignSummary, *, running: bool) -> dict[str, Any]:
    """Returns the printed form of a campaign in a list."""
    return {
        "id": record.id,
        "name": record.name,
        "state": state_of(record, running=running),
        "message": record.message,
        "tester": record.tester,
        "agent": record.agent,
        "town": record.town,
        "budget": record.budget,
        "simulations": record.counts.simulations,
        **asdict(record.counts),
        "rate": record.rate,
        "left_s": record.left_s,
        "active_s": record.active_s,
        "created_at": record.created_at.isoformat(),
        "ended_at": None if record.ended_at is None else record.ended_at.isoformat(),
    }


def state_of(record: CampaignSummary, *, running: bool) -> str:
    """Names the state of a campaign; one whose process was killed is interrupted."""
    state = str(record.state)
    return "interrupted" if state == "running" and not running else state


def failure_result(failure: Failure) -> dict[str, Any]:
    """Returns the printed form of a failure."""
    return {
        "evaluation": failure.evaluation,
        "key": failure.kind,
        "at_fault": failure.verdict.at_fault,
        "accountability": str(accountability(failure.verdict)),
        "confirmation": str(failure.confirmation),
        "group": failure.group,
        "trace": failure.trace,
        "verdict": json.loads(verdict_to_json(failure.verdict)),
    }


def evaluation_result(record: EvaluationRecord) -> dict[str, Any]:
    """Returns the printed form of an evaluation."""
    return {
        "number": record.number,
        "origin": record.proposal.origin,
        "generation": record.proposal.generation,
        "parents": list(record.proposal.parents),
        "status": str(record.status),
        "genes": record.proposal.values.tolist(),
        "scenario_sha256": record.document_sha256,
        "failure_kinds": list(record.failure_kinds),
        "search_s": record.search_s,
        "prepare_s": record.prepare_s,
        "report": json.loads(report_to_json(record.report)),
    }


def print_campaigns(records: Sequence[tuple[CampaignSummary, bool]]) -> None:
    """Prints a row a campaign, each with whether a process works on it."""
    print_table(
        "",
        ("id", "name", "state", "tester", "runs", "failing"),
        (
            (
                record.id,
                record.name,
                state_of(record, running=running),
                record.tester,
                f"{record.counts.simulations}/{record.budget}",
                str(record.counts.violating),
            )
            for record, running in records
        ),
        cut=("name",),
    )


def print_campaign(found: CampaignFindings) -> None:
    """Prints one campaign at length."""
    record = found.record
    counts = record.counts
    print(f"Campaign {record.id} ({record.name}): {state_of(record, running=found.is_running)}")
    if record.message:
        print(f"  {record.message}")
    print(f"  {record.tester} against {record.agent} on {record.town}")
    print(
        f"  {counts.simulations} of {record.budget} simulations in {record.active_s:.0f} s "
        f"({number(record.rate, 2)} a second); {counts.invalid} candidates invalid, "
        f"{counts.failed} runs without a result"
    )
    print(f"  {counts.violating} failing ({_accountable(counts)})")
    if found.kinds:
        print_table(
            "Failures",
            (
                "kind",
                "runs",
                "violations",
                "at fault",
                "avoidable",
                "confirmed",
                "flaky",
                "groups",
                "first",
            ),
            (
                (
                    kind.kind.replace("|", " | "),
                    str(kind.failures),
                    str(kind.violations),
                    str(kind.at_fault),
                    str(kind.avoidable),
                    str(kind.confirmed),
                    str(kind.flaky),
                    "-" if kind.groups is None else str(kind.groups),
                    f"#{kind.first}",
                )
                for kind in found.kinds
            ),
        )


def _accountable(counts: CampaignCounts) -> str:
    parts = [f"{counts.at_fault} at fault"]
    if counts.avoidable is not None:
        parts.append(f"{counts.avoidable} of them avoidable, {counts.unavoidable} not")
    if counts.undetermined:
        parts.append(f"{counts.undetermined} undetermined")
    return "; ".join(parts)


def print_evaluation(lineage: Sequence[EvaluationRecord]) -> None:
    """Prints an evaluation, the last of its lineage, and the nearest of its ancestors."""
    record = lineage[-1]
    print(f"Evaluation {record.number}: {record.status}")
    for ego in record.report.privileged:
        print(f"  {ego} sees everything, not only what the perception model lets through")
    if record.report.failure is not None:
        print(f"  {record.report.failure.cause}: {record.report.failure.message}")
    for verdict in record.violations:
        words = IN_WORDS[accountability(verdict)]
        fault = f", {words}" if words else ""
        print(f"  {verdict.oracle} at {number(verdict.time)} s{fault}: {verdict.message}")
    if record.report.measurement is not None:
        objectives = record.report.measurement.objectives.items()
        print("  " + ", ".join(f"{name} {number(value, 3)}" for name, value in objectives))
    print_table(
        "Lineage",
        ("evaluation", "generation", "origin", "parents", "status", "failures"),
        (
            (
                f"#{member.number}",
                str(member.proposal.generation),
                member.proposal.origin,
                ", ".join(f"#{parent}" for parent in member.proposal.parents) or "-",
                str(member.status),
                str(len(member.violations)),
            )
            for member in lineage[-_SHOWN:]
        ),
        wrap=("parents",),
    )
    if len(lineage) > _SHOWN:
        print(f"{len(lineage) - _SHOWN} earlier ancestors; --json prints them as well")
