"""Campaigns: searches for failures, their evaluations, and their failures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.failure_definition import (
    StatedDefinition,
    definition_of,
    state_definition,
)
from drivora_service.runs.run_report import RunFailure, RunStatus
from drivora_service.scenario.model import AgentChoice
from drivora_service.search.genes import GeneKind, GeneSpace, Part
from drivora_service.search.space.presets import PRESETS, SpacePreset
from drivora_service.shapes import combine
from drivora_service.store.campaigns import campaign_records
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    Confirmation,
    EvaluationRecord,
    EvaluationSummary,
    FailureKind,
    SeedFindings,
)
from drivora_service.store.campaigns.missing_results import MissingResult


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign(CampaignRecord):
    """A campaign, its findings and its definition.

    Attributes:
        definition: What it counts as failures.
        kinds: Failures by kind, first found first.
        seeds: Findings by seed scenario; empty if there is only one.
        missing_results: Why runs have no result, the most frequent reason first.
        notes: Warnings; in the answer to posting only.
        evaluations_url: Address of its evaluations.
        failures_url: Address of its failures.
        runs_url: Address of its runs; empty if no service runs it.
    """

    definition: StatedDefinition
    kinds: tuple[FailureKind, ...]
    seeds: tuple[SeedFindings, ...] = ()
    missing_results: tuple[MissingResult, ...] = ()
    notes: tuple[str, ...] = ()
    evaluations_url: str
    failures_url: str
    runs_url: str


class CampaignValidation(Schema):
    """A campaign that can be run."""

    valid: bool
    tester: str
    town: str
    seeds: int = Field(description="Seed scenarios.")
    genes: int = Field(
        description="Numbers that describe a candidate; the most, if seed scenarios differ."
    )
    notes: tuple[str, ...] = Field(description="Warnings.")


class SpacePresetInList(Schema):
    """A named space."""

    name: SpacePreset
    description: str = Field(description="What varies.")
    source: str = Field(description="Publication; empty for a space of our own.")
    options: dict[str, Any] = Field(
        description="Its values by option; those that differ from the default."
    )


class SpacePresetList(Schema):
    """All named spaces."""

    items: tuple[SpacePresetInList, ...]


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluation(EvaluationSummary):
    """A candidate at length.

    Attributes:
        genes: By block; empty if the network or the program has changed since.
        values: All genes, in their order.
        lineage: Its ancestors in order; the nearest generations if there are many.
        error: Why it has no result.
        failures: Verdicts that count as failures.
        verdicts: All verdicts of its run.
        scores: General objectives, to be minimised, by name; null: not measurable.
        metrics: Measured values by name; null: not measurable.
        features: Tables that the tester's feedback measured, by name.
        step_cost_us: Mean wall microseconds a step.
        agent_cost_us: Share of each ego's agent in that, by the ego's id.
        agents: Agent of each ego.
        configuration: The ADS of its campaign with the parameters that differ from its defaults.
        configuration_id: Short id of the ADS with all its parameters; empty if not recorded.
        privileged: Egos that saw more than the perception model lets through.
        versions: Versions of what took part in the run, by name.
        search_s: Processor seconds that the tester took for it.
        prepare_s: Processor seconds that repairing and checking it took.
        scenario_url: Address of its scenario; empty if it is no valid one.
        observations_url: Address of the recording of its second, identical run; empty unless it
            failed and was confirmed.
        run_url: Address of its run; empty unless the service made it and still has it.
    """

    genes: tuple[Block, ...]
    values: tuple[float, ...]
    lineage: tuple[EvaluationSummary, ...]
    error: RunFailure | None
    failures: tuple[Verdict, ...]
    verdicts: tuple[Verdict, ...]
    scores: Mapping[str, float | None]
    metrics: Mapping[str, float | None]
    features: Mapping[str, tuple[tuple[float, ...], ...]] = field(default_factory=dict)
    run_id: str
    run_status: RunStatus
    steps: int
    step_cost_us: float
    agent_cost_us: Mapping[str, float]
    agents: Mapping[str, AgentChoice]
    configuration: str
    configuration_id: str
    privileged: tuple[str, ...]
    trace_sha256: str
    versions: Mapping[str, Any]
    search_s: float
    prepare_s: float
    scenario_url: str
    observations_url: str
    run_url: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure(campaign_records.Failure):
    """A violation that a campaign found.

    Attributes:
        scenario_url: Address of the scenario.
        observations_url: Address of the recording of the identical run; empty until then, and if
            the second run was not identical.
    """

    scenario_url: str
    observations_url: str


def space_presets() -> SpacePresetList:
    """Returns the named spaces."""
    return SpacePresetList(
        items=tuple(
            SpacePresetInList(
                name=name,
                description=preset.description,
                source=preset.source,
                options=preset.changed_options,
            )
            for name, preset in PRESETS.items()
        )
    )


def campaign_of(
    campaign: CampaignRecord,
    kinds: tuple[FailureKind, ...],
    seeds: tuple[SeedFindings, ...],
    base: str,
    *,
    missing: tuple[MissingResult, ...] = (),
    notes: tuple[str, ...] = (),
) -> Campaign:
    """Returns a campaign with its addresses; ``base`` is the address of the API."""
    url = f"{base}/campaigns/{campaign.id}"
    return combine(
        Campaign,
        campaign,
        definition=state_definition((definition_of(campaign.document),)),
        kinds=kinds,
        seeds=seeds,
        missing_results=missing,
        notes=notes,
        evaluations_url=f"{url}/evaluations",
        failures_url=f"{url}/failures",
        runs_url=f"{base}/runs?batch={campaign.batch_id}" if campaign.batch_id else "",
    )


def evaluation_of(
    summary: EvaluationSummary,
    record: EvaluationRecord,
    lineage: tuple[EvaluationSummary, ...],
    space: GeneSpace | None,
    campaign: CampaignRecord,
    url: str,
    *,
    run_url: str,
    has_trace: bool,
) -> Evaluation:
    """Returns an evaluation at length; ``url`` is its own address."""
    report, measurement = record.report, record.report.measurement
    return combine(
        Evaluation,
        summary,
        record,
        report,
        genes=_blocks(space, record.proposal.values),
        values=tuple(record.proposal.values.tolist()),
        lineage=lineage,
        configuration=campaign.configuration,
        configuration_id=campaign.configuration_id,
        error=report.failure,
        failures=record.violations,
        features=dict(measurement.features) if measurement else {},
        run_status=report.status,
        scenario_url=f"{url}/scenario" if summary.scenario_sha256 else "",
        observations_url=f"{url}/observations" if has_trace else "",
        run_url=run_url,
    )


def failure_of(failure: campaign_records.Failure, url: str) -> Failure:
    """Returns a failure with its addresses; ``url`` is that of its campaign."""
    evaluation = f"{url}/evaluations/{failure.evaluation}"
    # The recording of a flaky failure is of a second run that drove otherwise.
    is_recorded = failure.trace and failure.confirmation is Confirmation.CONFIRMED
    return combine(
        Failure,
        failure,
        scenario_url=f"{evaluation}/scenario",
        observations_url=f"{evaluation}/observations" if is_recorded else "",
    )


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
