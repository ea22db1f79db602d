"""Methods compared by campaigns."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.studies.comparing import Comparison
from drivora_service.studies.comparison import Row
from drivora_service.studies.figures import CampaignFigures


class Figures(Schema):
    """A campaign in figures that campaigns can be compared by."""

    campaign: str = Field(description="Its id.")
    group: str = Field(description="The method: campaigns of one group are repetitions.")
    scenario: str = Field(description="Name of the seed scenario in this comparison.")
    seed: int
    simulations: int
    budget: int | None = Field(description="Simulations that it could make.")
    invalid_share: float = Field(description="Of all candidates, those that were no scenario.")
    failed_share: float = Field(description="Of the simulations, those without a result.")
    failing: int = Field(description="Simulations with a failure.")
    at_fault: int = Field(description="Simulations with one that an ego is responsible for.")
    avoidable: int = Field(description="Simulations with one at fault that could be avoided.")
    unavoidable: int = Field(description="Simulations at fault with none that could be avoided.")
    undetermined: int = Field(description="Simulations in which fault cannot be told.")
    kinds: int = Field(description="Different failures by key.")
    rules: int = Field(description="Different rules broken.")
    clusters: int | None = Field(description="Different failures by cluster.")
    situations: int | None = Field(description="Different failures by situation.")
    first_failure: int | None = Field(description="Simulations up to the first failure.")
    found: tuple[int, ...] = Field(description="Simulations up to each different failure.")
    gene_coverage: float = Field(description="Share of two-way combinations of genes tried.")
    network_coverage: float | None = Field(description="Share of the network driven on.")
    simulation_s: float = Field(description="Seconds that the runs took in their workers.")
    own_s: float = Field(description="Seconds that the method itself took.")
    own_share: float = Field(description="The latter over the former.")
    first_failure_s: float | None = Field(description="Seconds up to the first failure.")
    time_limit_s: float | None = Field(description="Seconds that count, at equal time.")


class CampaignFiguresView(Schema):
    """The figures of one campaign, finished or not."""

    figures: Figures | None = Field(
        description="null where what it searched is not there any more."
    )
    note: str = Field(description="Why they are not known; empty if they are.")


class Difference(Schema):
    """One method against the baseline, by one measure on one seed scenario."""

    measure: str
    title: str = Field(description="Of the measure, for people.")
    larger_is_better: bool
    scenario: str
    group: str
    repetitions: int
    baseline_repetitions: int
    median: float
    baseline_median: float
    a12: float = Field(description="Probability that a repetition is better than the baseline's.")
    low: float = Field(description="Lower end of its 95 % confidence interval.")
    high: float = Field(description="Upper end.")
    p: float = Field(description="Of the two-sided Mann-Whitney test.")
    p_holm: float = Field(description="Corrected for all differences by this measure.")
    judgement: str = Field(description="In words: better or worse and by how much, or undecided.")


class ComparisonView(Schema):
    """What came of comparing campaigns."""

    baseline: str
    budgets: dict[str, int] = Field(description="Simulations of each campaign, by scenario.")
    time_limits_s: dict[str, float] = Field(description="At equal time: seconds, by scenario.")
    notes: tuple[str, ...]
    differences: tuple[Difference, ...]
    campaigns: tuple[Figures, ...]


def comparison_view(comparison: Comparison) -> ComparisonView:
    """Gives a comparison as the API shows it."""
    return ComparisonView(
        baseline=comparison.baseline,
        budgets=comparison.budgets,
        time_limits_s=comparison.time_limits,
        notes=comparison.notes,
        differences=tuple(_difference(row) for row in comparison.rows),
        campaigns=tuple(figures_view(figures) for figures in comparison.figures),
    )


def _difference(row: Row) -> Difference:
    return Difference(
        measure=row.measure.name,
        title=row.measure.title,
        larger_is_better=row.measure.larger_is_better,
        scenario=row.scenario,
        group=row.group,
        repetitions=row.repetitions,
        baseline_repetitions=row.baseline_repetitions,
        median=row.median,
        baseline_median=row.baseline_median,
        a12=row.effect.a12,
        low=row.effect.low,
        high=row.effect.high,
        p=row.effect.p,
        p_holm=row.p_holm,
        judgement=row.judgement,
    )


def figures_view(figures: CampaignFigures) -> Figures:
    """Gives the figures of a campaign as the API shows them."""
    shown = set(Figures.model_fields)
    values: dict[str, Any] = {
        field.name: getattr(figures, field.name) for field in fields(figures) if field.name in shown
    }
    return Figures(**values, own_share=figures.own_share)
