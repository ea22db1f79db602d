"""Runs of a benchmark with a known answer."""

from __future__ import annotations

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.benchmarking.card import BenchmarkRun
from drivora_service.oracles.verdict import Answer, Outcome, Verdict
from drivora_service.runs.report import RunFailure, RunReport, RunStatus

AGENT = AgentEntry(
    name="made-up",
    kind=AgentKind.MODULE_BASED,
    description="drives as the test says",
    source="this test",
    licence="",
    privileged=True,
)


def violation(
    rule: str,
    *,
    at_fault: bool | None = None,
    avoidable: Answer | None = None,
    message: str = "",
) -> Verdict:
    return Verdict(
        oracle=rule,
        ego="ego_0",
        outcome=Outcome.VIOLATED,
        message=message or f"broke {rule}",
        at_fault=at_fault,
        avoidable=avoidable,
    )


def finished(
    number: int,
    *broken: Verdict,
    network: str = "tee-town",
    score: float | None = 100.0,
    comfort: float | None = 1.0,
    step_cost_us: float = 100.0,
    agent_cost_us: float | None = 40.0,
    sim_time_s: float = 30.0,
) -> BenchmarkRun:
    """A judged run; it arrived unless the destination is among what was broken."""
    arrived = Verdict(
        oracle="destination", ego="ego_0", outcome=Outcome.PASSED, message="Arrived after 30 s."
    )
    missed = any(verdict.oracle == "destination" for verdict in broken)
    return BenchmarkRun(
        network=network,
        number=number,
        report=RunReport(
            run_id=f"made-up-{network}-{number:02d}",
            status=RunStatus.FINISHED,
            verdicts=broken if missed else (arrived, *broken),
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
        report=RunReport(
            run_id=f"made-up-tee-town-{number:02d}",
            status=status,
            failure=RunFailure(cause=cause, message=message or f"it was {cause}"),
        ),
    )
