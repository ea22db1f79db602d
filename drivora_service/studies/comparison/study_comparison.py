"""The campaigns of a study against one another: by method, and by agent."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.errors import CampaignError, Conflict, UnknownName
from drivora_service.given_names import read_stored
from drivora_service.oracles.verdicts.failure_definition import DEFAULT_DEFINITION
from drivora_service.shapes import Shape, combine
from drivora_service.store.campaigns.campaign_records import CampaignRecord, CampaignState
from drivora_service.studies.campaign_figures import CampaignFigures, Subject, duration_s
from drivora_service.studies.comparison.baseline_rates import baseline_notes
from drivora_service.studies.comparison.campaign_comparison import (
    compute_comparison_figures,
    read_confirmed_evaluations,
)
from drivora_service.studies.comparison.campaign_measures import (
    SIGNIFICANT,
    Difference,
    Measure,
    compare_campaigns,
    measure,
)
from drivora_service.studies.comparison.compared_subjects import Compared
from drivora_service.studies.comparison.start_notes import start_notes
from drivora_service.studies.study_documents import StudyDocument

if TYPE_CHECKING:
    from drivora_service.campaigns.document.campaign_catalogues import Catalogues
    from drivora_service.store.database import Database

HEADLINES = ("avoidable", "first_avoidable", "avoidable_kinds", "avoidable_situations", "failing")
"""Measures of a study, unless others are chosen."""

_RANDOM = "random"


class By(StrEnum):
    """What is compared."""

    METHOD = "method"
    AGENT = "agent"


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyFigures(CampaignFigures):
    """A campaign of a study in figures.

    Attributes:
        agent: Name of the ADS in the study.
    """

    agent: str


@dataclass(frozen=True, slots=True, kw_only=True)
class OverviewRow(Shape):
    """A method, or an agent, against the baseline, by one measure in all places of the study.

    A place is a scenario with an agent where methods are compared, and a scenario with a method
    where agents are.

    Attributes:
        by: What is compared.
        measure: Name of the measure.
        title: Display name of the measure.
        name: The method or agent.
        median: Median of all its campaigns.
        baseline_median: Median of all campaigns of the baseline.
        a12: Mean over the places of the probability that a repetition is *better* than one of the
            baseline.
        places: Number of places.
        better: Places where it is better, p corrected by Holm for all rows of the measure.
        worse: Places where it is worse.
        undecided: Places where the difference may be chance.
    """

    by: By
    measure: str
    title: str
    larger_is_better: bool
    name: str
    baseline: str
    median: float
    baseline_median: float
    a12: float
    places: int
    better: int
    worse: int
    undecided: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyComparison(Shape):
    """The comparison of a study.

    Attributes:
        baseline_method: The method that the others are compared with.
        baseline_agent: The agent that the others are compared with.
        time_limits_s: Seconds of one worker within which evaluations count, by scenario with agent,
            as ``by_method`` names them; empty unless methods are compared at equal time.
        notes: Remarks for the reader.
        overview: All places together: by method, then by agent.
        by_method: Methods on each scenario with each agent, which ``scenario`` names.
        by_agent: Agents on each scenario with each method; ``method`` is the agent. Empty at equal
            time.
        campaigns: Figures of each finished campaign.
    """

    study_id: str
    name: str
    baseline_method: str
    baseline_agent: str
    time_limits_s: Mapping[str, float]
    notes: tuple[str, ...]
    overview: tuple[OverviewRow, ...]
    by_method: tuple[Difference, ...]
    by_agent: tuple[Difference, ...]
    campaigns: tuple[StudyFigures, ...]


def compare_study(
    database: Database,
    study_id: str,
    catalogues: Catalogues,
    *,
    baseline_method: str = "",
    baseline_agent: str = "",
    measures: Sequence[Measure] = (),
    equal_time: bool = False,
) -> StudyComparison:
    """Compares the finished campaigns of a study.

    Failures that an identical run did not repeat are left out. The figures of a campaign do not
    depend on the others, but for the limit of equal time.

    Args:
        database: Holds the study.
        study_id: Id of the study.
        catalogues: Catalogues for the names in its campaigns.
        baseline_method: Method that the others are compared with; "": `random`, or the first one.
        baseline_agent: Agent that the others are compared with; "": the first one.
        measures: Measures to compare by; empty: :data:`HEADLINES`.
        equal_time: Leave out the evaluations of each campaign after the seconds (of one worker, the
            method's own time included) that the shortest campaign on the same scenario with the
            same agent took. Agents are not compared then: the time of a run is theirs.

    Raises:
        UnknownName: There is no such study, method or agent.
        Conflict: No two finished campaigns can be compared yet.
        CampaignError: A campaign does not fit the program.
        InvalidDocument: A name in a campaign is no longer available.
    """
    with database.read() as transaction:
        study = transaction.studies.get(study_id)
        ids = transaction.studies.campaign_ids(study_id, (CampaignState.FINISHED,))
        records = [transaction.campaigns.get(campaign_id) for campaign_id in ids]
    document = read_stored(StudyDocument, study.document)
    methods, agents = document.method_labels, document.agent_labels
    method = baseline_method or (_RANDOM if _RANDOM in methods else methods[0])
    agent = baseline_agent or agents[0]
    for kind, wanted, known in (("method", method, methods), ("agent", agent, agents)):
        if wanted not in known:
            raise UnknownName(f"{kind} of the study", wanted, known)
    chosen = tuple(measures) or tuple(measure(name) for name in HEADLINES)
    figures = tuple(_figures(database, document, records, catalogues, equal_time=equal_time))
    by_method = _compare_with_baseline(
        figures, lambda f: replace(f, scenario=_place(f.scenario, f.agent)), method, chosen
    )
    by_agent = _compare_with_baseline(
        () if equal_time else figures,
        lambda f: replace(f, scenario=f"{f.scenario}, {f.method}", method=f.agent),
        agent,
        chosen,
    )
    if not by_method and not by_agent:
        raise Conflict(
            f"study {study_id} has nothing to compare: {len(records)} of "
            f"{sum(study.campaigns.values())} campaigns have finished, and two repetitions of two "
            f"{'methods' if equal_time else 'methods or two agents'} on one scenario are needed"
        )
    left = sum(study.campaigns.values()) - len(records)
    return StudyComparison(
        study_id=study_id,
        name=study.name,
        baseline_method=method,
        baseline_agent=agent,
        time_limits_s={
            _place(one.scenario, one.agent): one.time_limit_s
            for one in figures
            if one.time_limit_s is not None
        },
        notes=(
            *((f"{left} campaigns have not finished and are left out",) if left else ()),
            *start_notes([_subject(record, document) for record in records]),
            *baseline_notes(figures, method, lambda f: _place(f.scenario, f.agent)),
        ),
        overview=(
            *_overview(By.METHOD, by_method, figures, lambda f: f.method, chosen),
            *_overview(By.AGENT, by_agent, figures, lambda f: f.agent, chosen),
        ),
        by_method=by_method,
        by_agent=by_agent,
        campaigns=figures,
    )


def _figures(
    database: Database,
    document: StudyDocument,
    records: Sequence[CampaignRecord],
    catalogues: Catalogues,
    *,
    equal_time: bool,
) -> Iterator[StudyFigures]:
    """Yields the figures of campaigns, scenario by scenario."""
    # Imported here: importing this module shall not import the testers and the clustering.
    from drivora_service.campaigns.document.searched_space import searched_spaces_of

    for scenario in document.scenario_labels:
        here = [r for r in records if r.cell is not None and r.cell.scenario == scenario]
        if not here:
            continue
        searched = searched_spaces_of(here[0], catalogues)
        limits = _shortest(database, here) if equal_time else {}
        for record in here:
            campaign = _subject(record, document)
            evaluations = read_confirmed_evaluations(
                database, record.id, campaign.document.definition
            )
            agent = _agent(record)
            figures = compute_comparison_figures(
                database, campaign, evaluations, searched, limits.get(agent)
            )
            yield combine(StudyFigures, figures, agent=agent)


def _shortest(database: Database, records: Sequence[CampaignRecord]) -> Mapping[str, float]:
    """Returns the seconds of the shortest of the campaigns with each agent."""
    shortest: dict[str, float] = {}
    for record in records:
        # Read again later: the evaluations of hundreds of campaigns do not fit in memory at once.
        took = duration_s(read_confirmed_evaluations(database, record.id, DEFAULT_DEFINITION))
        shortest[_agent(record)] = min(took, shortest.get(_agent(record), took))
    return shortest


def _agent(record: CampaignRecord) -> str:
    return "" if record.cell is None else record.cell.agent


def _place(scenario: str, agent: str) -> str:
    return f"{scenario}, {agent}"


def _subject(record: CampaignRecord, document: StudyDocument) -> Compared:
    cell = record.cell
    if cell is None:
        raise CampaignError(f"campaign {record.id} is of no study")
    return Compared(
        record=record,
        document=read_stored(CampaignDocument, record.document),
        subject=Subject(
            campaign=record.id,
            method=cell.method,
            scenario=cell.scenario,
            seed=document.seed + cell.repetition - 1,
        ),
    )


def _compare_with_baseline(
    figures: Sequence[StudyFigures],
    placed: Callable[[StudyFigures], StudyFigures],
    baseline: str,
    measures: Sequence[Measure],
) -> tuple[Difference, ...]:
    """Compares with a baseline wherever both have repetitions.

    Args:
        figures: Figures of campaigns.
        placed: Returns figures with the place in ``scenario``, and what is compared in ``method``.
        baseline: What the others are compared with.
        measures: Measures to compare by.
    """
    by_place: dict[str, list[StudyFigures]] = {}
    for one in map(placed, figures):
        by_place.setdefault(one.scenario, []).append(one)
    comparable: list[StudyFigures] = []
    for here in by_place.values():
        repeated = [
            name
            for name in dict.fromkeys(one.method for one in here)
            if sum(one.method == name for one in here) > 1
        ]
        if baseline in repeated and len(repeated) > 1:
            comparable += [one for one in here if one.method in repeated]
    return compare_campaigns(comparable, baseline, measures) if comparable else ()


def _overview(
    by: By,
    differences: Sequence[Difference],
    figures: Sequence[StudyFigures],
    name_of: Callable[[StudyFigures], str],
    measures: Sequence[Measure],
) -> Iterator[OverviewRow]:
    for chosen in measures:
        rows = [row for row in differences if row.measure == chosen.name]
        for name in dict.fromkeys(row.method for row in rows):
            own = [row for row in rows if row.method == name]
            significant = [row.a12 > 0.5 for row in own if row.p_holm < SIGNIFICANT]
            yield OverviewRow(
                by=by,
                measure=chosen.name,
                title=chosen.title,
                larger_is_better=chosen.larger_is_better,
                name=name,
                baseline=own[0].baseline,
                median=_median(chosen, (f for f in figures if name_of(f) == name)),
                baseline_median=_median(
                    chosen, (f for f in figures if name_of(f) == own[0].baseline)
                ),
                a12=statistics.fmean(row.a12 for row in own),
                places=len(own),
                better=sum(significant),
                worse=len(significant) - sum(significant),
                undecided=len(own) - len(significant),
            )


def _median(chosen: Measure, figures: Iterable[StudyFigures]) -> float:
    values = [chosen.value(one) for one in figures]
    return statistics.median(value for value in values if value is not None)
