"""Campaigns in figures and curves, and methods compared by them."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers.query_parameters import Points
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.comparisons import Figures
from drivora_service.shapes import combine
from drivora_service.store.campaigns.failure_columns import campaign_findings
from drivora_service.studies.comparison.campaign_comparison import Comparison, compare_stored
from drivora_service.studies.comparison.campaign_measures import MEASURES, measure
from drivora_service.studies.comparison.discovery_curves import CampaignDiscoveries, discoveries_of
from drivora_service.studies.coverage.coverage_memory import CoverageMemory
from drivora_service.studies.coverage.coverage_values import CampaignCoverage

router = resource_router("campaigns", Depends(reader))


@router.get(
    "/campaigns:compare",
    response_model=Comparison,
    responses=answers(recorded_examples.COMPARISON, 401, 403, 404, 422),
)
def compare_campaigns(
    request: Request,
    context: Context,
    campaign: Annotated[
        list[str],
        Query(
            min_length=1,
            max_length=1000,
            description="Ids, their first digits, names, patterns of names such as `study-*`, or "
            "`latest`; may be repeated.",
        ),
    ],
    baseline: Annotated[str, Query(max_length=200, description="Baseline method.")] = "random",
    by: Annotated[
        list[str] | None,
        Query(alias="measure", max_length=50, description="By what; may be repeated."),
    ] = None,
    equal_time: Annotated[
        bool,
        Query(description="Count what each had done after the time that the shortest one took."),
    ] = False,
) -> Response:
    """Compares methods by finished campaigns: medians, effect sizes, p-values."""
    from drivora_service.studies.campaign_lookup import choose_campaigns

    measures = tuple(measure(name) for name in dict.fromkeys(by)) if by else MEASURES
    comparison = compare_stored(
        context.database,
        choose_campaigns(context.database, campaign),
        context.catalogues,
        baseline=baseline,
        measures=measures,
        equal_time=equal_time,
    )
    return json_answer(request, Comparison, comparison)


@router.get(
    "/campaigns/{campaign_id:id}/figures",
    response_model=Figures,
    responses=answers(recorded_examples.FIGURES, 401, 403, 404),
)
def get_figures(request: Request, context: Context, campaign_id: str) -> Response:
    """Returns the figures of a campaign so far, by which campaigns are compared."""
    from drivora_service.studies.reports.campaign_report import read_report

    report = read_report(context.database, campaign_id, context.catalogues)
    return json_answer(request, Figures, combine(Figures, report))


@router.get(
    "/campaigns/{campaign_id:id}/discoveries",
    response_model=CampaignDiscoveries,
    responses=answers(recorded_examples.DISCOVERIES, 401, 403, 404, 422),
)
def get_discoveries(
    request: Request,
    context: Context,
    campaign_id: str,
    points: Points = 300,
    kinds: Annotated[int, Query(ge=0, le=100, description="Most frequent kinds with curves.")] = 12,
) -> Response:
    """Returns the failures of a campaign against simulations, so far."""
    with context.database.read() as transaction:
        found = campaign_findings(transaction.session, campaign_id)
    body = discoveries_of(campaign_id, found, points=points, kinds=kinds)
    return json_answer(request, CampaignDiscoveries, body)


@router.get(
    "/campaigns/{campaign_id:id}/coverage",
    response_model=CampaignCoverage,
    responses=answers(recorded_examples.COVERAGE, 401, 403, 404),
)
def get_coverage(request: Request, context: Context, campaign_id: str) -> Response:
    """Returns the roads, values of genes and kinds of scenarios that a campaign has tried.

    One request counts at most 1,000 evaluations that were not counted before; ask again while
    `counted` is less than `evaluations`.
    """
    from drivora_service.studies.coverage.campaign_coverage import CoverageCounts

    with context.database.read() as transaction:
        campaign = transaction.campaigns.get(campaign_id)
    memory: CoverageMemory = request.app.state.coverages
    coverage = memory.coverage(
        context.database,
        campaign_id,
        lambda: CoverageCounts(
            context.networks, lambda place: context.gene_spaces.of(campaign, place)
        ),
    )
    return json_answer(request, CampaignCoverage, coverage)
