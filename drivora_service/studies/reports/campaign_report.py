"""The report of one campaign."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.campaigns.document.searched_space import SearchedSpace, searched_spaces_of
from drivora_service.errors import CampaignError, InvalidDocument, NetworkError, SearchError
from drivora_service.given_names import read_stored
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignState,
    Confirmation,
    EvaluationRecord,
    Failure,
    SeedFindings,
)
from drivora_service.store.campaigns.missing_results import MissingResult
from drivora_service.store.database import Database
from drivora_service.studies.campaign_figures import CampaignFigures, Subject, figures_of
from drivora_service.studies.comparison.campaign_comparison import (
    check_genes,
    network_coverage,
    networks_of,
    read_confirmed_evaluations,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureGroup:
    """Similar failures of one kind.

    Attributes:
        kind: Oracle, place, and relation of the other actor to the ego.
        number: Number of the group within the oracle; ``None`` until failures are grouped.
        failures: Failures in the order of their evaluations.
    """

    kind: str
    number: int | None
    failures: tuple[Failure, ...]

    @property
    def example(self) -> Failure:
        """The first confirmed failure with a trace, else the first failure."""
        for failure in self.failures:
            if failure.confirmation is Confirmation.CONFIRMED and failure.trace:
                return failure
        return self.failures[0]

    def count(self, confirmation: Confirmation) -> int:
        """Returns the number of failures with this confirmation."""
        return sum(failure.confirmation is confirmation for failure in self.failures)

    @property
    def at_fault(self) -> int:
        """Number of failures for which the ego is known to be responsible."""
        return sum(bool(failure.verdict.at_fault) for failure in self.failures)

    @property
    def avoidable(self) -> int:
        """Number of those that a careful and competent driver avoids."""
        return sum(
            accountability(failure.verdict) is Accountability.AVOIDABLE for failure in self.failures
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignReport:
    """A campaign and its results.

    Attributes:
        figures: ``None`` if its gene space is no longer known; ``note`` says why.
        groups: Groups of failures, in the order in which they were found.
        seeds: Findings by seed scenario; empty if there is only one.
        missing: Why runs have no result, the most frequent reason first.
        privileged: Egos with full observations, not limited by the perception model.
    """

    record: CampaignRecord
    document: CampaignDocument
    figures: CampaignFigures | None
    groups: tuple[FailureGroup, ...]
    note: str
    privileged: tuple[str, ...] = ()
    seeds: tuple[SeedFindings, ...] = ()
    missing: tuple[MissingResult, ...] = ()


def read_report(database: Database, campaign_id: str, catalogues: Catalogues) -> CampaignReport:
    """Reads the report of a stored campaign, finished or not.

    Raises:
        UnknownName: There is no such campaign.
    """
    with database.read() as transaction:
        record = transaction.campaigns.get(campaign_id)
        failures = transaction.evaluations.failures(campaign_id)
        seeds = transaction.campaign_views.seeds(campaign_id)
        missing = transaction.campaign_views.missing_results(campaign_id=campaign_id)
    document = read_stored(CampaignDocument, record.document)
    groups = group(failures)
    figures, note = None, ""
    privileged: set[str] = set()
    try:
        searched = searched_spaces_of(record, catalogues)
        confirmed = read_confirmed_evaluations(database, record.id, document.definition)
        evaluations = check_genes(confirmed, searched, record)
        privileged.update(ego for one in evaluations for ego in one.report.privileged)
        figures = _figures(database, record, document, searched, groups, evaluations)
    except (CampaignError, InvalidDocument, NetworkError, SearchError) as error:
        note = str(error)
    return CampaignReport(
        record=record,
        document=document,
        figures=figures,
        groups=groups,
        note=note,
        privileged=tuple(sorted(privileged)),
        seeds=seeds,
        missing=missing,
    )


def group(failures: Sequence[Failure]) -> tuple[FailureGroup, ...]:
    """Returns the failures by kind and group."""
    found: dict[tuple[str, int | None], list[Failure]] = defaultdict(list)
    for failure in failures:
        found[failure.kind, failure.group].append(failure)
    return tuple(
        FailureGroup(kind=kind, number=number, failures=tuple(members))
        for (kind, number), members in found.items()
    )


def _figures(
    database: Database,
    record: CampaignRecord,
    document: CampaignDocument,
    searched: Sequence[SearchedSpace],
    groups: Sequence[FailureGroup],
    records: Sequence[EvaluationRecord],
) -> CampaignFigures:
    numbers = {
        (one.failures[0].verdict.oracle, one.number) for one in groups if one.number is not None
    }
    are_grouped = record.state is CampaignState.FINISHED
    subject = Subject(
        campaign=record.id, method=record.tester, scenario=record.town, seed=document.seed
    )
    figures = figures_of(
        subject,
        records,
        [one.space for one in searched],
        definition=document.definition,
        groups=len(numbers) if are_grouped else None,
        budget=record.budget,
    )
    if not figures.simulations:
        return figures
    covered = network_coverage(database, record.id, networks_of(searched))
    return replace(figures, network_coverage=covered)
