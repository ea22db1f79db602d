"""Failures against simulations: of one campaign, and of the repetitions of a study.

A simulation with several failures counts once: as avoidable if a careful and competent driver
avoids any of them that is the fault of an ego, else among the others.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from drivora_service.errors import UnknownName
from drivora_service.given_names import read_stored
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.campaigns.failure_columns import CampaignFindings, campaign_findings
from drivora_service.studies.study_documents import StudyDocument

if TYPE_CHECKING:
    from drivora_service.store.database import Database

Numbers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscoveryCurve(Shape):
    """Simulations with failures of one oracle or one kind.

    Attributes:
        name: Name of the oracle, or the kind.
        first: Simulations up to the first of them, itself included.
        first_evaluation: Number of its evaluation, from 0.
        avoidable: For each point of `at`, simulations so far with one that is the fault of an ego
            and avoidable.
        others: For each point of `at`, simulations so far with others only.
    """

    name: str
    first: int
    first_evaluation: int
    avoidable: tuple[int, ...]
    others: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignDiscoveries(Shape):
    """The failures of a campaign against simulations.

    Attributes:
        simulations: Simulations so far.
        budget: Simulations that it may make.
        first_failure: Simulations up to the first failure, itself included; null: none found.
        first_avoidable: Simulations up to the first failure that is the fault of an ego and
            avoidable; null: none found.
        flaky: Failures that an identical run did not repeat; they are left out.
        at: Numbers of simulations, ascending, from 0; every change, or evenly spaced ones if there
            are more than wanted.
        avoidable: For each point, simulations so far with a failure that is the fault of an ego and
            avoidable.
        others: For each point, simulations so far with other failures only.
        different: For each point, different kinds of failures so far.
        different_avoidable: For each point, different kinds so far of failures that are the fault
            of an ego and avoidable.
        oracles: Curves by oracle, the most frequent first.
        kinds: Curves of the most frequent kinds.
        kinds_left_out: Number of kinds that have no curve.
    """

    campaign_id: str
    simulations: int
    budget: int
    first_failure: int | None
    first_avoidable: int | None
    flaky: int
    at: tuple[int, ...]
    avoidable: tuple[int, ...]
    others: tuple[int, ...]
    different: tuple[int, ...]
    different_avoidable: tuple[int, ...]
    oracles: tuple[DiscoveryCurve, ...]
    kinds: tuple[DiscoveryCurve, ...]
    kinds_left_out: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Band(Shape):
    """Median and quartiles of repetitions, for each point of `at`."""

    low: tuple[float, ...]
    median: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MethodBands(Shape):
    """The failures of a method's repetitions on a scenario with an agent.

    Attributes:
        campaigns: Ids of the finished campaigns.
        at: Numbers of simulations, ascending, from 0 to those of the shortest repetition.
        avoidable: Simulations with a failure that is the fault of an ego and avoidable.
        failing: Simulations with any failure.
        different: Different kinds of failures.
        different_avoidable: Different kinds of failures that are the fault of an ego and avoidable.
        first_avoidable: Simulations of each repetition up to the first failure that is the fault of
            an ego and avoidable; null: none found.
    """

    scenario: str
    agent: str
    method: str
    campaigns: tuple[str, ...]
    at: tuple[int, ...]
    avoidable: Band
    failing: Band
    different: Band
    different_avoidable: Band
    first_avoidable: tuple[int | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyBands(Shape):
    """The bands of a study.

    Attributes:
        unfinished: Campaigns of the chosen places and methods that have not finished; they are left
            out.
        bands: By scenario, agent and method in the order of the study; those without a finished
            campaign are left out.
    """

    study_id: str
    unfinished: int
    bands: tuple[MethodBands, ...]


def discoveries_of(
    campaign_id: str, found: CampaignFindings, *, points: int, kinds: int
) -> CampaignDiscoveries:
    """Computes the curves of a campaign.

    Args:
        campaign_id: Id of the campaign.
        found: Its failures.
        points: Greatest number of points of a curve, at least 2.
        kinds: Greatest number of kinds with a curve.
    """
    at = _points(np.unique(found.simulation), found.simulations, points)
    avoidable, others = _split(found.simulation, found.avoidable)
    return CampaignDiscoveries(
        campaign_id=campaign_id,
        simulations=found.simulations,
        budget=found.budget,
        first_failure=_first(found.simulation),
        first_avoidable=_first(found.simulation[found.avoidable]),
        flaky=found.flaky,
        at=_whole(at),
        avoidable=_until(avoidable, at),
        others=_until(others, at),
        different=_until(_first_of_each_kind(found), at),
        different_avoidable=_until(_first_of_each_kind(found, only_avoidable=True), at),
        oracles=_curves(found, found.oracles, found.oracle, len(found.oracles), at),
        kinds=_curves(found, found.kinds, found.kind, kinds, at),
        kinds_left_out=max(0, len(found.kinds) - kinds),
    )


def study_bands(
    database: Database,
    study_id: str,
    *,
    methods: Collection[str] = (),
    scenarios: Collection[str] = (),
    agents: Collection[str] = (),
    points: int,
) -> StudyBands:
    """Computes the bands of the finished campaigns of a study.

    Args:
        database: Holds the study.
        study_id: Id of the study.
        methods: Names of methods; empty: all.
        scenarios: Names of scenarios; empty: all.
        agents: Names of agents; empty: all.
        points: Greatest number of points of a band, at least 2.

    Raises:
        UnknownName: There is no such study, method, scenario or agent.
    """
    unfinished = 0
    repeated: dict[tuple[str, str, str], dict[str, CampaignFindings]] = defaultdict(dict)
    with database.read() as transaction:
        study = transaction.studies.get(study_id)
        document = read_stored(StudyDocument, study.document)
        known = (document.scenario_labels, document.agent_labels, document.method_labels)
        wanted = tuple(
            _choose_names(what, names, labels)
            for what, names, labels in zip(
                ("scenario", "agent", "method"), (scenarios, agents, methods), known, strict=True
            )
        )
        for campaign_id, state, cell in transaction.studies.cells(study_id):
            place = (cell.scenario, cell.agent, cell.method)
            if not all(name in names for name, names in zip(place, wanted, strict=True)):
                continue
            if state is CampaignState.FINISHED:
                repeated[place][campaign_id] = campaign_findings(transaction.session, campaign_id)
            else:
                unfinished += 1
    order = [(s, a, m) for s in known[0] for a in known[1] for m in known[2]]
    return StudyBands(
        study_id=study_id,
        unfinished=unfinished,
        bands=tuple(_bands(place, repeated[place], points) for place in order if place in repeated),
    )


def _bands(
    place: tuple[str, str, str], repetitions: Mapping[str, CampaignFindings], points: int
) -> MethodBands:
    found = tuple(repetitions.values())
    last = min(one.simulations for one in found)
    changes = np.unique(np.concatenate([one.simulation for one in found]))
    at = _points(changes, last, points)
    scenario, agent, method = place
    return MethodBands(
        scenario=scenario,
        agent=agent,
        method=method,
        campaigns=tuple(repetitions),
        at=_whole(at),
        avoidable=_band([np.unique(one.simulation[one.avoidable]) for one in found], at),
        failing=_band([np.unique(one.simulation) for one in found], at),
        different=_band([_first_of_each_kind(one) for one in found], at),
        different_avoidable=_band(
            [_first_of_each_kind(one, only_avoidable=True) for one in found], at
        ),
        first_avoidable=tuple(_first(one.simulation[one.avoidable]) for one in found),
    )


def _band(events: Sequence[Numbers], at: Numbers) -> Band:
    counts = np.array([np.searchsorted(one, at, side="right") for one in events])
    low, median, high = np.quantile(counts, (0.25, 0.5, 0.75), axis=0)
    return Band(low=tuple(low.tolist()), median=tuple(median.tolist()), high=tuple(high.tolist()))


def _curves(
    found: CampaignFindings, names: Sequence[str], name: Numbers, most: int, at: Numbers
) -> tuple[DiscoveryCurve, ...]:
    """Returns the curves of the most frequent names; ``name`` has the place of each failure's."""
    counts = np.bincount(name, minlength=len(names))
    curves = []
    for place in np.argsort(-counts, kind="stable")[:most]:
        rows = np.flatnonzero(name == place)
        simulations = found.simulation[rows]
        avoidable, others = _split(simulations, found.avoidable[rows])
        curves.append(
            DiscoveryCurve(
                name=names[place],
                first=int(simulations[0]),
                first_evaluation=int(found.evaluation[rows[0]]),
                avoidable=_until(avoidable, at),
                others=_until(others, at),
            )
        )
    return tuple(curves)


def _split(simulations: Numbers, avoidable: NDArray[np.bool_]) -> tuple[Numbers, Numbers]:
    """Returns the simulations with an avoidable failure, and those with others only."""
    with_avoidable = np.unique(simulations[avoidable])
    return with_avoidable, np.setdiff1d(np.unique(simulations), with_avoidable, assume_unique=True)


def _first_of_each_kind(found: CampaignFindings, *, only_avoidable: bool = False) -> Numbers:
    """Returns the simulations up to the first failure of each kind, ascending."""
    rows = found.avoidable if only_avoidable else np.ones(len(found.kind), dtype=np.bool_)
    # The first of equal ones, which are in the order of their evaluations.
    _, first = np.unique(found.kind[rows], return_index=True)
    return np.sort(found.simulation[rows][first])


def _points(changes: Numbers, last: int, most: int) -> Numbers:
    at = np.unique(np.concatenate(([0], changes[changes <= last], [last])))
    if len(at) > most:
        at = np.unique(np.linspace(0, last, most).round().astype(np.int64))
    return at


def _until(events: Numbers, at: Numbers) -> tuple[int, ...]:
    return _whole(np.searchsorted(events, at, side="right"))


def _whole(numbers: Numbers) -> tuple[int, ...]:
    return tuple(numbers.tolist())


def _first(simulations: Numbers) -> int | None:
    return int(simulations[0]) if len(simulations) else None


def _choose_names(what: str, names: Collection[str], known: Sequence[str]) -> Collection[str]:
    for name in names:
        if name not in known:
            raise UnknownName(f"{what} of the study", name, tuple(known))
    return names or known
