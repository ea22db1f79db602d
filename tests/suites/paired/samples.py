"""Runs of batches for the tests of comparisons."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.runs.run_records import Batch, BatchState, Priority
from drivora_service.suites.paired.batch_pairing import BatchRuns
from drivora_service.suites.paired.paired_runs import DrivenScenario, PairedRun

_numbers = itertools.count()


def verdict(
    oracle: str = "collision",
    outcome: Outcome = Outcome.VIOLATED,
    *,
    at_fault: bool | None = True,
    **changes: Any,
) -> Verdict:
    return Verdict(
        oracle=oracle,
        ego="ego",
        outcome=outcome,
        message=changes.pop("message", f"{oracle} {outcome}"),
        at_fault=at_fault,
        **changes,
    )


def run(
    label: str = "",
    *,
    content: str = "",
    seed: int = 0,
    fails: Sequence[str] = (),
    passes: Sequence[str] = ("collision", "red_light"),
    metrics: Mapping[str, float | None] | None = None,
    agent: str = "idm",
    parameters: Mapping[str, Any] | None = None,
    **changes: Any,
) -> PairedRun:
    """A finished run that violates some oracles at fault and passes others."""
    verdicts = tuple(verdict(oracle) for oracle in fails)
    values: dict[str, Any] = {
        "id": f"run-{next(_numbers)}",
        "label": label,
        "scenario": DrivenScenario(content=content or label, seed=seed, town="tee-town"),
        "seed": seed,
        "status": RunStatus.FINISHED,
        "oracles": frozenset((*fails, *passes)),
        "verdicts": verdicts,
        "metrics": metrics or {},
        "agents": {"ego": AgentChoice(name=agent, parameters=parameters or {})},
        "agent": agent,
    }
    return PairedRun(**(values | changes))


def lost(label: str, status: RunStatus, cause: str = "", **changes: Any) -> PairedRun:
    """A run without a judgement."""
    return run(label, passes=(), status=status, cause=cause, agents={}, **changes)


def batch(runs: Sequence[PairedRun], *, name: str = "") -> BatchRuns:
    return BatchRuns(
        batch=Batch(
            id=f"batch-{next(_numbers)}",
            name=name,
            priority=Priority.CI,
            state=BatchState.OPEN,
            created_at=datetime(2026, 3, 2, tzinfo=UTC),
            size=len(runs),
        ),
        runs=tuple(runs),
    )
