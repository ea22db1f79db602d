"""Campaigns, their evaluations and failures, and their comparison."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from drivora_service.api_paths import PREFIX
from drivora_service.client.call import (
    Call,
    Document,
    Language,
    Listing,
    ObservationForm,
    act,
    document_bytes,
    get,
    make_listing,
    post,
)
from drivora_service.client.calls.runs import observation_query
from drivora_service.observations.trace_files.trace_rows import TraceRows

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import (
        Campaign,
        CampaignValidation,
        Evaluation,
        Failure,
        SpacePresetList,
    )
    from drivora_service.api.schemas.comparisons import Figures
    from drivora_service.store.campaigns.campaign_records import (
        CampaignState,
        CampaignSummary,
        EvaluationFilter,
        EvaluationSummary,
        FailureFilter,
    )
    from drivora_service.studies.comparison.campaign_comparison import Comparison
    from drivora_service.studies.comparison.discovery_curves import CampaignDiscoveries
    from drivora_service.studies.coverage.coverage_values import CampaignCoverage
    from drivora_service.studies.table_names import CampaignTableName, TableForm

_CAMPAIGN = f"{PREFIX}/campaigns/{{campaign_id}}"


def post_campaign(document: Document, *, language: Language = "json") -> Call[Campaign]:
    """Has the service run a campaign; returns it with notes.

    Raises:
        InvalidDocument: It cannot be run.
    """
    from drivora_service.api.schemas.campaigns import Campaign

    return post(f"{PREFIX}/campaigns", Campaign, document_bytes(document), language=language)


def validate_campaign(
    document: Document, *, language: Language = "json"
) -> Call[CampaignValidation]:
    """Checks a campaign as posting it would.

    Raises:
        InvalidDocument: It cannot be run.
    """
    from drivora_service.api.schemas.campaigns import CampaignValidation

    return post(
        f"{PREFIX}/campaigns:validate",
        CampaignValidation,
        document_bytes(document),
        language=language,
        only_checks=True,
    )


def space_presets() -> Call[SpacePresetList]:
    """Returns the named spaces that a campaign or a study can have."""
    from drivora_service.api.schemas.campaigns import SpacePresetList

    return get(f"{PREFIX}/campaigns:presets", SpacePresetList)


def campaigns(
    states: Collection[CampaignState] = (), *, study_id: str = "", limit: int | None = None
) -> Listing[CampaignSummary]:
    """Returns campaigns in any of some states, or all; newest first; at most ``limit``.

    Args:
        states: States of the campaigns; empty: any.
        study_id: Study of the campaigns; "": any, or none.
        limit: How many at most; ``None``: all.
    """
    from drivora_service.store.campaigns.campaign_records import CampaignSummary

    query = {"state": sorted(states), "study": study_id}
    return make_listing(f"{PREFIX}/campaigns", CampaignSummary, limit, query=query)


def campaign(campaign_id: str) -> Call[Campaign]:
    """Returns how far a campaign is and what it has found."""
    from drivora_service.api.schemas.campaigns import Campaign

    return get(_CAMPAIGN, Campaign, campaign_id=campaign_id)


def pause_campaign(campaign_id: str) -> Call[Campaign]:
    """Pauses a campaign after the evaluation that is being told.

    Raises:
        RequestConflict: It is over.
    """
    return _campaign_act("pause", campaign_id)


def cancel_campaign(campaign_id: str) -> Call[Campaign]:
    """Cancels a campaign permanently; what it has found stays.

    Raises:
        RequestConflict: It is finished.
    """
    return _campaign_act("cancel", campaign_id)


def resume_campaign(campaign_id: str) -> Call[Campaign]:
    """Resumes a campaign that was paused or has failed.

    Raises:
        RequestConflict: It runs or is over.
    """
    return _campaign_act("resume", campaign_id)


def evaluations(
    campaign_id: str,
    wanted: EvaluationFilter | None = None,
    *,
    newest_first: bool = False,
    limit: int | None = None,
) -> Listing[EvaluationSummary]:
    """Returns what a campaign has evaluated; at most ``limit``."""
    from drivora_service.store.campaigns.campaign_records import EvaluationFilter, EvaluationSummary

    wanted = wanted or EvaluationFilter()
    query = {
        "status": wanted.status,
        "violating": wanted.violating,
        "generation": wanted.generation,
        "order": "-number" if newest_first else None,
    }
    return make_listing(
        f"{_CAMPAIGN}/evaluations", EvaluationSummary, limit, query=query, campaign_id=campaign_id
    )


def evaluation(campaign_id: str, number: int) -> Call[Evaluation]:
    """Returns a candidate: its genes, its ancestors, and what came of it."""
    from drivora_service.api.schemas.campaigns import Evaluation

    return get(
        f"{_CAMPAIGN}/evaluations/{{number}}", Evaluation, campaign_id=campaign_id, number=number
    )


def evaluation_scenario(campaign_id: str, number: int) -> Call[str]:
    """Returns the scenario of a candidate as the text of a document that can be posted."""
    return get(
        f"{_CAMPAIGN}/evaluations/{{number}}/scenario",
        str,
        accept="application/json",
        campaign_id=campaign_id,
        number=number,
    )


def evaluation_observations(
    campaign_id: str,
    number: int,
    *,
    form: ObservationForm = ObservationForm.PARQUET,
    first: int = 0,
    last: int | None = None,
    rows: TraceRows = TraceRows.ALL,
    columns: Sequence[str] = (),
) -> Call[bytes]:
    """Returns what the second, identical run of a failing candidate recorded.

    Args:
        campaign_id: Id of the campaign.
        number: Number of the evaluation, from 0.
        form: As which file.
        first: First step, from 0.
        last: Last step, included; ``None``: the last one of all.
        rows: Whose rows; ``EGOS`` as Arrow only.
        columns: Columns besides ``step`` and ``actor``, as Arrow only; empty: all.

    Raises:
        NotFound: It was not run again.
    """
    return get(
        f"{_CAMPAIGN}/evaluations/{{number}}/observations",
        bytes,
        query=observation_query(first, last, rows, columns),
        accept=form,
        campaign_id=campaign_id,
        number=number,
    )


def evaluation_picture(
    campaign_id: str,
    number: int,
    *,
    moments: int | None = None,
    oracle: str = "",
    ego: str = "",
    step: int | None = None,
) -> Call[bytes]:
    """Returns a strip of moments of the second, identical run of a failing candidate as SVG.

    Args:
        campaign_id: Id of the campaign.
        number: Number of the evaluation, from 0.
        moments: Number of moments, 2 to 12; ``None``: as the service has it.
        oracle: The moments lead to a violation of this oracle; "": to the gravest.
        ego: With ``oracle``: of this ego.
        step: With ``oracle``: the violation that begins in this row of the trace; ``None``: the
            earliest.

    Raises:
        NotFound: It was not run again.
    """
    return get(
        f"{_CAMPAIGN}/evaluations/{{number}}/picture",
        bytes,
        query={"moments": moments, "oracle": oracle, "ego": ego, "step": step},
        campaign_id=campaign_id,
        number=number,
    )


def campaign_table(
    campaign_id: str,
    table: CampaignTableName,
    *,
    columns: Sequence[str] = (),
    after: int | None = None,
    form: TableForm | None = None,
) -> Call[bytes]:
    """Returns the evaluations or failures of a campaign as a file.

    Args:
        campaign_id: Id of the campaign.
        table: Which table.
        columns: Names of its columns; empty: all.
        after: Only evaluations of greater numbers; ``None``: all.
        form: As which file; ``None``: Parquet.
    """
    from drivora_service.studies.table_names import TableForm

    return get(
        f"{_CAMPAIGN}/tables/{{table}}",
        bytes,
        query={"column": tuple(columns), "after": after},
        accept=form or TableForm.PARQUET,
        campaign_id=campaign_id,
        table=table,
    )


def failures(
    campaign_id: str, wanted: FailureFilter | None = None, *, limit: int | None = None
) -> Listing[Failure]:
    """Returns the failures of a campaign in the order of their evaluations; at most ``limit``."""
    from drivora_service.api.schemas.campaigns import Failure
    from drivora_service.store.campaigns.campaign_records import FailureFilter

    wanted = wanted or FailureFilter()
    query = {
        "kind": wanted.kind,
        "oracle": wanted.oracle,
        "at_fault": wanted.at_fault,
        "accountability": wanted.accountability,
        "confirmation": wanted.confirmation,
    }
    return make_listing(
        f"{_CAMPAIGN}/failures", Failure, limit, query=query, campaign_id=campaign_id
    )


def figures(campaign_id: str) -> Call[Figures]:
    """Returns the figures of a campaign so far, by which campaigns are compared."""
    from drivora_service.api.schemas.comparisons import Figures

    return get(f"{_CAMPAIGN}/figures", Figures, campaign_id=campaign_id)


def coverage(campaign_id: str) -> Call[CampaignCoverage]:
    """Returns the roads, values of genes and kinds of scenarios that a campaign has tried.

    Ask again while ``counted`` is less than ``evaluations``.
    """
    from drivora_service.studies.coverage.coverage_values import CampaignCoverage

    return get(f"{_CAMPAIGN}/coverage", CampaignCoverage, campaign_id=campaign_id)


def discoveries(
    campaign_id: str, *, points: int | None = None, kinds: int | None = None
) -> Call[CampaignDiscoveries]:
    """Returns the failures of a campaign against simulations, so far.

    Args:
        campaign_id: Id of the campaign.
        points: Greatest number of points of a curve; ``None``: as the service has it.
        kinds: Greatest number of kinds with a curve; ``None``: as the service has it.
    """
    from drivora_service.studies.comparison.discovery_curves import CampaignDiscoveries

    return get(
        f"{_CAMPAIGN}/discoveries",
        CampaignDiscoveries,
        query={"points": points, "kinds": kinds},
        campaign_id=campaign_id,
    )


def compare_campaigns(
    campaigns: Sequence[str],
    *,
    baseline: str = "",
    measures: Sequence[str] = (),
    equal_time: bool = False,
) -> Call[Comparison]:
    """Compares methods by finished campaigns.

    Args:
        campaigns: Ids, names, or patterns of names.
        baseline: Method that the others are compared with; "": as the service has it.
        measures: Names of what they are compared by; empty: all.
        equal_time: Count what each had done after the time that the shortest one took.
    """
    from drivora_service.studies.comparison.campaign_comparison import Comparison

    query = {
        "campaign": tuple(campaigns),
        "baseline": baseline,
        "measure": tuple(measures),
        "equal_time": equal_time or None,
    }
    return get(f"{PREFIX}/campaigns:compare", Comparison, query=query)


def _campaign_act(action: str, campaign_id: str) -> Call[Campaign]:
    from drivora_service.api.schemas.campaigns import Campaign

    return act(f"{_CAMPAIGN}:{action}", Campaign, campaign_id=campaign_id)
