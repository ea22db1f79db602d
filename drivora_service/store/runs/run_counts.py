"""Numbers of runs by the values of each filter, for lists with filters."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from sqlalchemy import Select, distinct, func, select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape
from drivora_service.store.runs.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.runs.facets import Facet, facet_of_row
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.runs.run_scope import RunScope, facet_passes, has_verdict, run_scope
from drivora_service.store.runs.run_tables import RunRow, VerdictRow


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfigurationCount(Shape):
    """The number of runs of an ADS with its parameters.

    Attributes:
        id: Value of the filter `configuration`.
        words: Name of the ADS with the parameters that differ from its defaults.
    """

    id: str
    words: str
    runs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RunCounts(Shape):
    """Numbers of runs that pass a filter, and by the values of each of its parts.

    The numbers by a part are those of the runs that pass all other parts: what a list would have
    with another value of this part. Values without runs are left out.

    Attributes:
        total: Runs that pass the whole filter.
        status: By status.
        agent: By agent.
        configurations: By agent with its parameters, in the order of the words; runs of versions
            that did not record it are left out.
        town: By road network.
        accountability: By the strongest accountability; runs without one are left out.
        oracle: By oracle with a verdict of `outcome` (and `at_fault`, if it is given).
        violated: With a violation.
        not_violated: Finished without one.
        failing: With a failure, by their own definitions.
        not_failing: Judged, and without one.
        at_fault: With a violation at an ego's fault; with `oracle`, of this oracle.
        not_at_fault: With violations, none at an ego's fault; with `oracle`, with a verdict that
            no ego was at fault.
    """

    total: int
    status: Mapping[RunStatus, int]
    agent: Mapping[str, int]
    configurations: tuple[ConfigurationCount, ...]
    town: Mapping[str, int]
    accountability: Mapping[Accountability, int]
    oracle: Mapping[str, int]
    violated: int
    not_violated: int
    failing: int
    not_failing: int
    at_fault: int
    not_at_fault: int


NO_RUNS = RunCounts(
    total=0,
    status={},
    agent={},
    configurations=(),
    town={},
    accountability={},
    oracle={},
    violated=0,
    not_violated=0,
    failing=0,
    not_failing=0,
    at_fault=0,
    not_at_fault=0,
)


FacetNumbers = Mapping[Facet, int]
"""Numbers of runs by their facet."""


def count_runs(session: Session, wanted: JobFilter) -> RunCounts:
    """Counts the runs that pass a filter, and those by the values of its parts."""
    scope = run_scope(session, wanted)
    if scope is None:
        return NO_RUNS
    facets = _facets(session)
    numbers = _numbers(session, facets, wanted, scope)
    by_fault = {
        fault: _numbers(session, facets, replace(wanted, at_fault=fault), scope)
        if wanted.oracle
        else numbers
        for fault in (True, False)
    }
    return RunCounts(
        total=_sum(numbers, wanted),
        status=_by(numbers, replace(wanted, statuses=frozenset()), _status),
        agent=_by(numbers, replace(wanted, agent=""), lambda facet: facet.agent),
        configurations=_by_configuration(numbers, replace(wanted, configuration_id="")),
        town=_by(numbers, replace(wanted, town=""), lambda facet: facet.town),
        accountability=_by(numbers, replace(wanted, accountability=None), _accountability),
        oracle=_by_oracle(session, facets, wanted, scope),
        violated=_sum(numbers, replace(wanted, violated=True)),
        not_violated=_sum(numbers, replace(wanted, violated=False)),
        failing=_sum(numbers, replace(wanted, failing=True)),
        not_failing=_sum(numbers, replace(wanted, failing=False)),
        at_fault=_sum(by_fault[True], replace(wanted, at_fault=True)),
        not_at_fault=_sum(by_fault[False], replace(wanted, at_fault=False)),
    )


def _facets(session: Session) -> dict[int, Facet]:
    query = select(FacetRow).where(FacetRow.runs > 0)
    return {row.key: facet_of_row(row) for row in session.scalars(query)}


def _numbers(
    session: Session, facets: Mapping[int, Facet], wanted: JobFilter, scope: RunScope
) -> FacetNumbers:
    """Counts the runs that pass the parts of a filter that facets do not have."""
    found = session.execute(_facet_numbers(wanted, scope))
    return {facets[key]: number for key, number in found if number}


def _facet_numbers(wanted: JobFilter, scope: RunScope) -> Select[int, int]:
    has_time = scope.first is not None or scope.end is not None
    if wanted.scenario_sha256:
        query = select(RunRow.facet, func.count()).where(
            RunRow.document_sha256 == wanted.scenario_sha256, *scope.of_runs()
        )
        if wanted.oracle:
            query = query.where(has_verdict(wanted))
        return query.group_by(RunRow.facet)
    if wanted.oracle:
        # A run has a verdict of an oracle for each ego.
        said = select(VerdictRow.facet, func.count(distinct(VerdictRow.run_seq))).where(
            VerdictRow.oracle == wanted.oracle,
            VerdictRow.outcome == wanted.outcome,
            *scope.of_verdicts(),
        )
        if wanted.at_fault is not None:
            said = said.where(VerdictRow.at_fault.is_(wanted.at_fault))
        return said.group_by(VerdictRow.facet)
    if has_time:
        of_facets = select(RunRow.facet, func.count()).where(*scope.of_runs())
        return of_facets.group_by(RunRow.facet)
    if scope.batch_seq is not None:
        return select(BatchFacetRow.facet, BatchFacetRow.runs).where(
            BatchFacetRow.batch_seq == scope.batch_seq, BatchFacetRow.runs > 0
        )
    return select(FacetRow.key, FacetRow.runs).where(FacetRow.runs > 0)


def _by_oracle(
    session: Session, facets: Mapping[int, Facet], wanted: JobFilter, scope: RunScope
) -> dict[str, int]:
    """Counts the runs with the wanted outcome of each oracle."""
    query = select(
        VerdictRow.oracle, VerdictRow.facet, func.count(distinct(VerdictRow.run_seq))
    ).where(VerdictRow.outcome == wanted.outcome, *scope.of_verdicts())
    if wanted.at_fault is not None:
        query = query.where(VerdictRow.at_fault.is_(wanted.at_fault))
    if wanted.scenario_sha256:
        of_scenario = select(RunRow.seq).where(
            RunRow.document_sha256 == wanted.scenario_sha256, *scope.of_runs()
        )
        query = query.where(VerdictRow.run_seq.in_(of_scenario))
    counts: Counter[str] = Counter()
    # Its fault is that of the verdict, not of the run.
    of_run = replace(wanted, at_fault=None)
    for oracle, key, number in session.execute(query.group_by(VerdictRow.oracle, VerdictRow.facet)):
        if facet_passes(facets[key], of_run):
            counts[oracle] += number
    return dict(sorted(counts.items()))


_V = TypeVar("_V", bound=str)


def _by(
    numbers: FacetNumbers, wanted: JobFilter, value: Callable[[Facet], _V | None]
) -> dict[_V, int]:
    counts: Counter[_V] = Counter()
    for facet, number in numbers.items():
        of_facet = value(facet)
        if of_facet is not None and facet_passes(facet, wanted):
            counts[of_facet] += number
    return dict(sorted(counts.items()))


def _by_configuration(numbers: FacetNumbers, wanted: JobFilter) -> tuple[ConfigurationCount, ...]:
    words = {facet.configuration_id: facet.configuration for facet in numbers}
    counts = _by(numbers, wanted, lambda facet: facet.configuration_id or None)
    found = [
        ConfigurationCount(id=one, words=words[one], runs=number) for one, number in counts.items()
    ]
    return tuple(sorted(found, key=lambda one: (one.words, one.id)))


def _sum(numbers: FacetNumbers, wanted: JobFilter) -> int:
    return sum(number for facet, number in numbers.items() if facet_passes(facet, wanted))


def _status(facet: Facet) -> RunStatus:
    return RunStatus(facet.status)


def _accountability(facet: Facet) -> Accountability | None:
    return None if facet.accountability is None else Accountability(facet.accountability)
