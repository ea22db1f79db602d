"""Comparing stored campaigns."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.errors import CampaignError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.runs.run_report import RunReport
from drivora_service.scenario.canonical import from_canonical
from drivora_service.search.tester import EvaluationStatus
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    Confirmation,
    EvaluationRecord,
)
from drivora_service.store.database import Database
from drivora_service.studies.campaign_figures import (
    CampaignFigures,
    duration_s,
    figures_of,
    within_time,
)
from drivora_service.studies.comparison.baseline_rates import baseline_notes
from drivora_service.studies.comparison.campaign_measures import (
    MEASURES,
    Difference,
    Measure,
    check_comparable,
    compare_campaigns,
)
from drivora_service.studies.comparison.compared_subjects import Compared, make_compared_campaigns
from drivora_service.studies.comparison.start_notes import start_notes
from drivora_service.studies.coverage.law_coverage import law_verdicts
from drivora_service.studies.found_counts import uncounted_violations

if TYPE_CHECKING:
    from drivora_service.campaigns.document.searched_space import SearchedSpace

_PAGE = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison(Shape):
    """The comparison of campaigns.

    Attributes:
        baseline: The method that the others are compared with.
        budgets: Simulations that each campaign may make, by scenario.
        time_limits_s: Seconds of one worker within which evaluations count, by scenario; empty
            unless campaigns are compared at equal time.
        notes: Remarks for the reader.
        differences: One for each measure, scenario and method but the baseline.
        campaigns: Figures of each campaign, in the order of the campaigns.
    """

    baseline: str
    budgets: Mapping[str, int]
    time_limits_s: Mapping[str, float]
    notes: tuple[str, ...]
    differences: tuple[Difference, ...]
    campaigns: tuple[CampaignFigures, ...]


def compare_stored(
    database: Database,
    records: Sequence[CampaignRecord],
    catalogues: Catalogues,
    *,
    baseline: str = "random",
    measures: Sequence[Measure] = MEASURES,
    equal_time: bool = False,
) -> Comparison:
    """Compares stored campaigns.

    Failures that an identical run did not repeat are left out. The figures of a campaign do not
    depend on the others, but for the limit of equal time.

    Args:
        database: Holds the campaigns.
        records: The campaigns; see :func:`choosing.choose_campaigns`.
        catalogues: Catalogues for their names.
        baseline: Name of the method that the others are compared with.
        measures: Measures to compare by.
        equal_time: Leave out the evaluations of each campaign after the seconds (of one worker, the
            method's own time included) that the shortest campaign on the same scenario took.

    Raises:
        CampaignError: They cannot be compared; says why.
        InvalidDocument: A name in a campaign is no longer available.
    """
    # Imported here: importing this module shall not import the testers and the clustering.
    from drivora_service.campaigns.document.searched_space import searched_spaces_of

    campaigns = make_compared_campaigns(records, catalogues.testers)
    check_comparable([campaign.subject for campaign in campaigns], baseline)
    by_scenario: dict[str, list[Compared]] = defaultdict(list)
    for campaign in campaigns:
        by_scenario[campaign.subject.scenario].append(campaign)
    figures: dict[str, CampaignFigures] = {}
    limits: dict[str, float] = {}
    for scenario, here in by_scenario.items():
        evaluations = [
            read_confirmed_evaluations(database, c.record.id, c.document.definition) for c in here
        ]
        if equal_time:
            limits[scenario] = min(duration_s(one) for one in evaluations)
        searched = searched_spaces_of(here[0].record, catalogues)
        for campaign, own in zip(here, evaluations, strict=True):
            figures[campaign.record.id] = compute_comparison_figures(
                database, campaign, own, searched, limits.get(scenario)
            )
    ordered = tuple(figures[campaign.record.id] for campaign in campaigns)
    return Comparison(
        baseline=baseline,
        campaigns=ordered,
        differences=compare_campaigns(ordered, baseline, measures),
        budgets={name: here[0].record.budget for name, here in by_scenario.items()},
        time_limits_s=limits,
        notes=(
            *_notes(campaigns),
            *start_notes(campaigns),
            *baseline_notes(ordered, baseline, lambda f: f.scenario),
        ),
    )


def read_confirmed_evaluations(
    database: Database, campaign_id: str, definition: FailureDefinition
) -> tuple[EvaluationRecord, ...]:
    """Returns the evaluations of a campaign, without failures that were not repeated.

    Little of the runs' reports is kept, such as their durations and which laws they violated:
    hundreds of campaigns must fit in memory.

    Args:
        database: Holds the campaign.
        campaign_id: Id of the campaign.
        definition: What it counts: the violations that it looks at and does not count are kept in
            the reports.
    """
    journal = StoreJournal(database, campaign_id)
    flaky = {f.evaluation for f in journal.failures() if f.confirmation is Confirmation.FLAKY}
    kept = []
    for record in journal.evaluations():
        stands = record.number not in flaky
        report = RunReport(
            run_id=record.report.run_id,
            status=record.report.status,
            verdicts=(
                *law_verdicts(record.report.verdicts),
                *(uncounted_violations(record.report.verdicts, definition) if stands else ()),
            ),
            egos_sha256=record.report.egos_sha256,
            wall_time_s=record.report.wall_time_s,
            privileged=record.report.privileged,
        )
        kept.append(
            replace(
                record,
                report=report,
                violations=record.violations if stands else (),
                failure_kinds=record.failure_kinds if stands else (),
                strongest=record.strongest if stands else None,
            )
        )
    return tuple(kept)


def network_coverage(
    database: Database,
    campaign_id: str,
    networks: Sequence[RoadNetwork],
    *,
    until: int | None = None,
) -> float:
    """Returns the share of its networks, taken together, that a campaign's simulations used.

    Args:
        database: Holds their scenarios.
        campaign_id: Id of the campaign.
        networks: Its road networks.
        until: Number of the last evaluation that counts; ``None``: all count.
    """
    from drivora_service.studies.coverage.road_coverage import RoadCoverage, covered_share

    coverages = {network.name: RoadCoverage(network) for network in networks}
    after = -1
    while True:
        with database.read() as transaction:
            page = transaction.evaluations.documents(campaign_id, after=after, limit=_PAGE)
        scenarios = [
            from_canonical(text) for number, text in page if until is None or number <= until
        ]
        for town, coverage in coverages.items():
            coverage.add([one for one in scenarios if one.map_region.town == town])
        if len(page) < _PAGE:
            return covered_share(tuple(coverages.values()))
        after = page[-1][0]


def compute_comparison_figures(
    database: Database,
    campaign: Compared,
    records: Sequence[EvaluationRecord],
    searched: Sequence[SearchedSpace],
    limit: float | None,
) -> CampaignFigures:
    """Returns the figures of a campaign in a comparison.

    Args:
        database: Holds the scenarios of its evaluations.
        campaign: The campaign.
        records: Its evaluations.
        searched: What it searched, seed by seed.
        limit: Seconds of one worker after which evaluations do not count; ``None``: all count.
    """
    from drivora_service.campaigns.search.failure_grouping import Grouping

    counted = records if limit is None else within_time(records, limit)
    return figures_of(
        campaign.subject,
        check_genes(counted, searched, campaign.record),
        [one.space for one in searched],
        definition=campaign.document.definition,
        groups=Grouping().count([verdict for one in counted for verdict in one.violations]),
        network_coverage=network_coverage(
            database,
            campaign.record.id,
            networks_of(searched),
            until=counted[-1].number if counted else -1,
        ),
        time_limit_s=limit,
        budget=campaign.record.budget,
    )


def networks_of(searched: Sequence[SearchedSpace]) -> tuple[RoadNetwork, ...]:
    """Returns the road networks of several spaces, each once."""
    return tuple({one.network.name: one.network for one in searched}.values())


def check_genes(
    records: Sequence[EvaluationRecord],
    searched: Sequence[SearchedSpace],
    campaign: CampaignRecord,
) -> Sequence[EvaluationRecord]:
    """Returns the evaluations, after a check that their genes are those of the current space.

    Raises:
        CampaignError: They are not.
    """
    for record in records:
        if record.status is not EvaluationStatus.INVALID and not searched[
            record.seed_number
        ].space.within(record.proposal.values):
            raise CampaignError(
                f"evaluation {record.number} of campaign {campaign.id} has other genes than the "
                "same campaign would have now: the program has changed since. Compare it with the "
                f"version that it was made with ({campaign.versions.get('drivora', 'unknown')})"
            )
    return records


def _notes(campaigns: Sequence[Compared]) -> tuple[str, ...]:
    versions: dict[str, set[str]] = defaultdict(set)
    for campaign in campaigns:
        for name, version in campaign.record.versions.items():
            versions[name].add(version)
    return tuple(
        f"the campaigns were made with different versions of {name}: {', '.join(sorted(found))}"
        for name, found in versions.items()
        if len(found) > 1
    )
