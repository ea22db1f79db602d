"""Campaigns: searches for failures, their evaluations, and what they found."""

from __future__ import annotations

import json
from datetime import datetime
from typing import Any

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.api.schemas.jobs import Failure, failure_of
from drivora_service.api.schemas.runs import AgentView, VerdictView, agent_views, verdict_view
from drivora_service.geometry.arrays import FloatArray
from drivora_service.oracles.accountability import Accountability
from drivora_service.runs.report import RunStatus
from drivora_service.search.genes import GeneKind, GeneSpace, Part
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    Confirmation,
    EvaluationRecord,
    EvaluationSummary,
    FailureKind,
    FailureRecord,
)


class Counts(Schema):
    """What a campaign has evaluated so far."""

    evaluations: int = Field(description="Candidates, simulated or not.")
    judged: int = Field(description="Those that were simulated and judged.")
    invalid: int = Field(description="Those that were no valid scenario; not simulated.")
    failed: int = Field(description="Those whose run had no result.")
    violating: int = Field(description="Those with at least one failure.")
    at_fault: int = Field(description="Those with a failure that an ego is responsible for.")
    avoidable: int | None = Field(
        description="Those with one that a careful and competent driver avoids; null where the "
        "campaign was judged before this was told."
    )
    unavoidable: int | None = Field(
        description="Those at fault where that driver does not avoid it either."
    )
    undetermined: int | None = Field(description="Those whose fault cannot be told.")


class CampaignSummary(Schema):
    """A campaign in a list, and how far it is."""

    id: str
    name: str
    state: CampaignState
    message: str = Field(description="Why it failed; empty otherwise.")
    request: CampaignRequest = Field(description="What is wanted of it while it runs.")
    tester: str
    agent: str
    town: str
    budget: int = Field(description="Simulations that it may make.")
    simulations: int = Field(description="Simulations so far.")
    counts: Counts
    rate: float | None = Field(description="Simulations a second of work.")
    left_s: float | None = Field(description="Seconds until the budget is spent, at that rate.")
    active_s: float = Field(description="Seconds of work, pauses left out.")
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    updated_at: datetime


class BestValue(Schema):
    """The least value of an objective so far."""

    value: float
    evaluation: int = Field(description="Number of the first evaluation with it.")


class Kind(Schema):
    """Failures of one key."""

    key: str = Field(description="Rule, place, and how the other stood to the ego.")
    failures: int = Field(description="Simulations that failed so, each once.")
    violations: int = Field(description="How often a rule was broken so in them.")
    at_fault: int = Field(description="Those with an ego at fault.")
    avoidable: int = Field(description="Those at fault that could be avoided.")
    confirmed: int = Field(description="Those that happened again in an identical run.")
    flaky: int = Field(description="Those that did not.")
    first: int = Field(description="Number of the first evaluation that showed it.")
    clusters: int | None = Field(description="Groups of similar ones; null until grouped.")


class Campaign(CampaignSummary):
    """A campaign, what it has found, and how it was made."""

    best: dict[str, BestValue] = Field(description="By the objectives of its tester's feedback.")
    kinds: tuple[Kind, ...] = Field(description="Failures by kind, first found first.")
    document: dict[str, Any] = Field(description="As it was posted, defaults filled in.")
    network_sha256: str
    versions: dict[str, str] = Field(description="What takes part in the search.")
    notes: tuple[str, ...] = Field(
        default=(), description="What its author may not expect; in the answer to posting only."
    )
    batch_id: str = Field(description="Batch of its runs; empty if the service does not run it.")
    evaluations_url: str
    failures_url: str
    runs_url: str = Field(description="Its runs; empty if the service does not run it.")


class CampaignValidation(Schema):
    """A campaign that can be run."""

    valid: bool
    tester: str
    town: str
    genes: int = Field(description="Numbers that describe a candidate.")
    notes: tuple[str, ...] = Field(description="What will happen that its author may not expect.")


class Evaluation(Schema):
    """A candidate in a list, and what came of it."""

    number: int = Field(description="In the order of asking, from 0.")
    generation: int
    origin: str = Field(description="How it was made: initial, mutation, crossover and the like.")
    parents: tuple[int, ...] = Field(description="Evaluations that it was made from.")
    status: EvaluationStatus
    scenario_sha256: str = Field(description="Empty if it is no valid scenario.")
    violations: int = Field(description="Failures.")
    at_fault_violations: int = Field(description="Those an ego is responsible for.")
    accountability: Accountability | None = Field(
        description="The strongest of its failures; null without one."
    )
    failure_keys: tuple[str, ...] = Field(description="Kind of each failure.")
    objectives: dict[str, float | None] = Field(
        description="Of the tester's feedback, to be minimised; null: not measurable."
    )
    cause: str = Field(description="Why it has no result; empty if it has.")
    sim_time_s: float
    wall_time_s: float
    told_at: datetime = Field(description="When the tester was told.")


class Gene(Schema):
    """A number of a candidate."""

    name: str
    value: float
    low: float
    high: float
    unit: str
    kind: GeneKind


class Block(Schema):
    """The genes of one actor, of the weather or of the lights."""

    name: str
    part: Part
    genes: tuple[Gene, ...]


class EvaluationDetail(Evaluation):
    """A candidate at length."""

    genes: tuple[Block, ...] = Field(
        description="By block; empty if the network or the program has changed since."
    )
    values: tuple[float, ...] = Field(description="All genes, in their order.")
    lineage: tuple[Evaluation, ...] = Field(
        description="What it descends from, in order; the nearest generations if there are many."
    )
    error: Failure | None
    failures: tuple[VerdictView, ...] = Field(description="Verdicts that count as failures.")
    verdicts: tuple[VerdictView, ...] = Field(description="All verdicts of its run.")
    scores: dict[str, float | None] = Field(description="General objectives, to be minimised.")
    metrics: dict[str, float | None] = Field(description="null: not measurable.")
    features: dict[str, tuple[tuple[float, ...], ...]] = Field(
        description="Tables that the tester's feedback measured, by name."
    )
    run_id: str
    run_status: RunStatus
    steps: int
    step_cost_us: float
    agent_cost_us: dict[str, float] = Field(
        description="What each ego's agent took of a step, by the ego's id."
    )
    agents: dict[str, AgentView] = Field(description="The agent of each ego.")
    privileged: tuple[str, ...] = Field(
        description="Egos that saw everything, not only what the perception model lets through."
    )
    trace_sha256: str
    versions: dict[str, Any] = Field(description="What took part in the run.")
    search_s: float = Field(description="Seconds that the tester took for it.")
    prepare_s: float = Field(description="Seconds that repairing and checking it took.")
    scenario_url: str = Field(description="Empty if it is no valid scenario.")
    observations_url: str = Field(description="Of its second run; empty unless it failed.")
    run_url: str = Field(description="Its run, where the service made it and still has it.")


class FailureView(Schema):
    """A violation that a campaign found."""

    evaluation: int = Field(description="Number of the evaluation.")
    place: int = Field(description="Among the failures of that evaluation, from 0.")
    key: str = Field(description="Its kind.")
    confirmation: Confirmation = Field(description="Whether it happened again in an identical run.")
    cluster: int | None = Field(
        description="Number of the group of similar failures of its rule; null until grouped."
    )
    verdict: VerdictView
    scenario_url: str
    observations_url: str = Field(description="Of the identical run; empty until then.")


def campaign_summary(record: CampaignRecord) -> CampaignSummary:
    """Gives a campaign as lists show it."""
    return CampaignSummary(**_fields(record))


def campaign_view(
    record: CampaignRecord,
    kinds: tuple[FailureKind, ...],
    base: str,
    *,
    notes: tuple[str, ...] = (),
) -> Campaign:
    """Gives a campaign as its own address shows it; ``base`` is the address of the API."""
    url = f"{base}/campaigns/{record.id}"
    return Campaign(
        **_fields(record),
        best={
            name: BestValue(value=best.value, evaluation=best.number)
            for name, best in record.best.items()
        },
        kinds=tuple(
            Kind(
                key=kind.key,
                failures=kind.failures,
                violations=kind.violations,
                at_fault=kind.at_fault,
                avoidable=kind.avoidable,
                confirmed=kind.confirmed,
                flaky=kind.flaky,
                first=kind.first,
                clusters=kind.clusters,
            )
            for kind in kinds
        ),
        document=json.loads(record.document),
        network_sha256=record.network_sha256,
        versions=dict(record.versions),
        notes=notes,
        batch_id=record.batch_id,
        evaluations_url=f"{url}/evaluations",
        failures_url=f"{url}/failures",
        runs_url=f"{base}/runs?batch={record.batch_id}" if record.batch_id else "",
    )


def evaluation_view(summary: EvaluationSummary) -> Evaluation:
    """Gives an evaluation as lists show it."""
    return Evaluation(**_evaluation_fields(summary))


def evaluation_detail(
    summary: EvaluationSummary,
    record: EvaluationRecord,
    lineage: tuple[EvaluationSummary, ...],
    space: GeneSpace | None,
    url: str,
    *,
    run_url: str,
    has_trace: bool,
) -> EvaluationDetail:
    """Gives an evaluation as its own address ``url`` shows it."""
    report = record.report
    return EvaluationDetail(
        **_evaluation_fields(summary),
        genes=_blocks(space, record.proposal.values),
        values=tuple(record.proposal.values.tolist()),
        lineage=tuple(evaluation_view(ancestor) for ancestor in lineage),
        error=failure_of(report),
        failures=tuple(verdict_view(verdict) for verdict in record.violations),
        verdicts=tuple(verdict_view(verdict) for verdict in report.verdicts),
        scores=dict(report.scores),
        metrics=dict(report.metrics),
        features=dict(report.measurement.features) if report.measurement else {},
        run_id=report.run_id,
        run_status=report.status,
        steps=report.steps,
        step_cost_us=report.step_cost_us,
        agent_cost_us=dict(report.agent_cost_us),
        agents=agent_views(report.agents),
        privileged=report.privileged,
        trace_sha256=report.trace_sha256,
        versions=dict(report.versions),
        search_s=record.search_s,
        prepare_s=record.prepare_s,
        scenario_url=f"{url}/scenario" if summary.scenario_sha256 else "",
        observations_url=f"{url}/observations" if has_trace else "",
        run_url=run_url,
    )


def failure_view(record: FailureRecord, url: str) -> FailureView:
    """Gives a failure; ``url`` is the address of its campaign."""
    evaluation = f"{url}/evaluations/{record.number}"
    return FailureView(
        evaluation=record.number,
        place=record.place,
        key=record.key,
        confirmation=record.confirmation,
        cluster=record.cluster,
        verdict=verdict_view(record.verdict),
        scenario_url=f"{evaluation}/scenario",
        observations_url=f"{evaluation}/observations" if record.trace else "",
    )


def _fields(record: CampaignRecord) -> dict[str, Any]:
    counts = record.counts
    return {
        "id": record.id,
        "name": record.name,
        "state": record.state,
        "message": record.message,
        "request": record.request,
        "tester": record.tester,
        "agent": record.agent,
        "town": record.town,
        "budget": record.budget,
        "simulations": counts.simulations,
        "counts": Counts(
            evaluations=counts.evaluations,
            judged=counts.judged,
            invalid=counts.invalid,
            failed=counts.failed,
            violating=counts.violating,
            at_fault=counts.at_fault,
            avoidable=counts.avoidable,
            unavoidable=counts.unavoidable,
            undetermined=counts.undetermined,
        ),
        "rate": record.rate,
        "left_s": record.left_s,
        "active_s": record.active_s,
        "created_at": record.created_at,
        "started_at": record.started_at,
        "ended_at": record.ended_at,
        "updated_at": record.updated_at,
    }


def _evaluation_fields(summary: EvaluationSummary) -> dict[str, Any]:
    return {
        "number": summary.number,
        "generation": summary.generation,
        "origin": summary.origin,
        "parents": summary.parents,
        "status": summary.status,
        "scenario_sha256": summary.scenario_sha256,
        "violations": summary.violations,
        "at_fault_violations": summary.at_fault_violations,
        "accountability": summary.accountability,
        "failure_keys": summary.failure_keys,
        "objectives": dict(summary.objectives),
        "cause": summary.cause,
        "sim_time_s": summary.sim_time_s,
        "wall_time_s": summary.wall_time_s,
        "told_at": summary.told_at,
    }


def _blocks(space: GeneSpace | None, values: FloatArray) -> tuple[Block, ...]:
    if space is None or len(space) != len(values):
        return ()
    return tuple(
        Block(
            name=block.name,
            part=block.part,
            genes=tuple(
                Gene(
                    name=gene.name,
                    value=float(value),
                    low=gene.low,
                    high=gene.high,
                    unit=gene.unit,
                    kind=gene.kind,
                )
                for gene, value in zip(block.genes, values[block.slice], strict=True)
            ),
        )
        for block in space.blocks
    )
