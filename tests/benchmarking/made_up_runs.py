"""Runs of a benchmark with a known answer."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.benchmarking.benchmark_run import BenchmarkRun
from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.runs.run_report import RunFailure, RunStatus
from drivora_service.store.runs.run_records import RunRecord

AGENT = AgentEntry(
    name="made-up",
    kind=AgentKind.MODULE_BASED,
    description="drives as the test says",
    source="this test",
    licence="",
    privileged=True,
)


def violation(
    oracle: str,
    *,
    at_fault: bool | None = None,
    avoidable: Answer | None = None,
    message: str = "",
) -> Verdict:
    return Verdict(
        oracle=oracle,
        ego="ego_0",
        outcome=Outcome.VIOLATED,
        message=message or f"broke {oracle}",
        at_fault=at_fault,
        avoidable=avoidable,
    )


def finished(
    number: int,
    *violated: Verdict,
    network: str = "tee-town",
    score: float | None = 100.0,
    comfort: float | None = 1.0,
    step_cost_us: float = 100.0,
    agent_cost_us: float | None = 40.0,
    sim_time_s: float = 30.0,
) -> BenchmarkRun:
    """A judged run; it arrived unless the destination is among the violated oracles."""
    arrived = Verdict(
        oracle="destination", ego="ego_0", outcome=Outcome.PASSED, message="Arrived after 30 s."
    )
    missed = any(verdict.oracle == "destination" for verdict in violated)
    return BenchmarkRun(
        network=network,
        number=number,
        record=_record(
            RunStatus.FINISHED,
            verdicts=violated if missed else (arrived, *violated),
            metrics={
                "driving_score": score,
                "route_completion": 60.0 if missed else 100.0,
                "comfort": comfort,
            },
            trace_sha256="0" * 64,
            steps=600,
            sim_time_s=sim_time_s,
            step_cost_us=step_cost_us,
            agent_cost_us={} if agent_cost_us is None else {"ego_0": agent_cost_us},
        ),
    )


def failed(number: int, status: RunStatus, cause: str, message: str = "") -> BenchmarkRun:
    return BenchmarkRun(
        network="tee-town",
        number=number,
        record=_record(
            status,
            cause=cause,
            error=RunFailure(cause=cause, message=message or f"it was {cause}"),
        ),
    )


def _record(status: RunStatus, **results: Any) -> RunRecord:
    """Returns the record of a run with the given results."""
    unknown: dict[str, Any] = dict.fromkeys(
        ("started_at", "ended_at", "violations", "at_fault_violations", "observations", "failures")
    )
    unknown |= dict.fromkeys(("accountability", "steps", "sim_time_s", "wall_time_s", "seed"))
    empty = dict.fromkeys(("id", "cause", "label", "batch_id", "scenario_sha256"), "")
    return RunRecord(
        status=status,
        item=0,
        town="",
        agent="made-up",
        configuration="made-up",
        configuration_id="",
        created_at=datetime(2026, 1, 1, tzinfo=UTC),
        cancel_requested=False,
        attempts=1,
        revision=0,
        **{"trace_sha256": "", **unknown, **empty, **results},
    )
