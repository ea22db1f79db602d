"""Suites that were run: storing what was decided, and reading it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime

from pydantic_core import from_json
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.shapes import adapter, combine, to_json
from drivora_service.store.engine.ids import new_id
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.runs.run_records import Page
from drivora_service.store.suites.suite_records import (
    ScenarioHistory,
    ScenarioState,
    SuiteDecision,
    SuiteHistory,
    SuiteOutcome,
    SuiteRunRecord,
    SuiteRunSummary,
    SuiteSummary,
)
from drivora_service.store.suites.suite_tables import SuiteOutcomeRow, SuiteRunRow

_MOST_NAMED = 5


class SuiteRunRepository:
    """Reads and writes runs of suites."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, decision: SuiteDecision, outcomes: Sequence[SuiteOutcome]) -> str:
        """Stores a run of a suite; returns its id."""
        row = SuiteRunRow(
            id=new_id(),
            suite=decision.suite,
            agent=decision.agent,
            configuration_id=decision.configuration_id,
            created_at=datetime.now(UTC),
            fails=decision.fails,
            scenarios=decision.scenarios,
            passing=decision.passing,
            body=to_json(SuiteDecision, decision).decode(),
        )
        self._session.add(row)
        self._session.flush()
        self._session.add_all(
            SuiteOutcomeRow(
                run_seq=row.seq,
                place=place,
                scenario=one.scenario,
                state=one.state,
                failing=one.failing,
                judged=one.judged,
                score=one.score,
                run_id=one.run_id,
                failures=json.dumps(one.failures),
            )
            for place, one in enumerate(outcomes)
        )
        self._session.flush()
        return row.id

    def get(self, suite_run_id: str) -> SuiteRunRecord:
        """Returns a run of a suite.

        Raises:
            UnknownName: There is none of this id.
        """
        row = self._session.scalar(select(SuiteRunRow).where(SuiteRunRow.id == suite_run_id))
        if row is None:
            newest = select(SuiteRunRow.id).order_by(SuiteRunRow.seq.desc()).limit(_MOST_NAMED)
            raise UnknownName("run of a suite", suite_run_id, tuple(self._session.scalars(newest)))
        outcomes = self._outcomes([row.seq])
        return combine(SuiteRunRecord, _summary(row), outcomes=tuple(one for _, one in outcomes))

    def page(
        self,
        *,
        suite: str = "",
        agent: str = "",
        configuration_id: str = "",
        limit: int = 50,
        page_token: str = "",
    ) -> Page[SuiteRunSummary]:
        """Returns runs of suites, newest first.

        Args:
            suite: Only those of this suite; "": of any.
            agent: Only those of this ADS; "": of any.
            configuration_id: Only those of this ADS with its parameters; "": of any.
            limit: Greatest number of them.
            page_token: Token of the page.

        Raises:
            InvalidDocument: The token is not one of this list.
        """
        scope = f"suite runs {suite!r} {agent!r} {configuration_id!r}"
        query = select(SuiteRunRow).order_by(SuiteRunRow.seq.desc()).limit(limit + 1)
        if suite:
            query = query.where(SuiteRunRow.suite == suite)
        if agent:
            query = query.where(SuiteRunRow.agent == agent)
        if configuration_id:
            query = query.where(SuiteRunRow.configuration_id == configuration_id)
        if page_token:
            query = query.where(SuiteRunRow.seq < read_token(scope, page_token))
        rows = self._session.scalars(query).all()
        more = make_token(scope, rows[limit - 1].seq) if len(rows) > limit else ""
        return Page(items=tuple(map(_summary, rows[:limit])), next_page_token=more)

    def suites(self) -> tuple[SuiteSummary, ...]:
        """Returns all suites that were run, the last run first."""
        last = func.max(SuiteRunRow.seq)
        query = (
            select(SuiteRunRow.suite, func.count().label("runs"), last.label("last"))
            .group_by(SuiteRunRow.suite)
            .order_by(last.desc())
        )
        return tuple(
            SuiteSummary(
                suite=row.suite,
                runs=row.runs,
                last=_summary(self._session.get_one(SuiteRunRow, row.last)),
            )
            for row in self._session.execute(query)
        )

    def history(
        self, suite: str, *, agent: str = "", configuration_id: str = "", limit: int = 30
    ) -> SuiteHistory:
        """Returns the last runs of a suite, and what became of its scenarios in them.

        Args:
            suite: Name of the suite.
            agent: Only runs of this ADS; "": of any.
            configuration_id: Only runs of this ADS with its parameters; "": of any.
            limit: Number of runs, the last ones.

        Raises:
            UnknownName: It was never run.
        """
        query = select(SuiteRunRow).where(SuiteRunRow.suite == suite)
        if agent:
            query = query.where(SuiteRunRow.agent == agent)
        if configuration_id:
            query = query.where(SuiteRunRow.configuration_id == configuration_id)
        newest = self._session.scalars(query.order_by(SuiteRunRow.seq.desc()).limit(limit)).all()
        if not newest:
            raise UnknownName("suite", suite, tuple(one.suite for one in self.suites()))
        rows = list(reversed(newest))
        places = {row.seq: place for place, row in enumerate(rows)}
        found: dict[str, list[SuiteOutcome | None]] = {}
        order: dict[str, tuple[int, int]] = {}
        for (seq, place), outcome in self._read_outcomes(list(places)):
            line = found.setdefault(outcome.scenario, [None] * len(rows))
            line[places[seq]] = outcome
            # By the last run that had it: the greatest number of a run comes last.
            order[outcome.scenario] = (-seq, place)
        names = sorted(found, key=lambda name: (not _has_changed(found[name]), order[name]))
        return SuiteHistory(
            suite=suite,
            runs=tuple(map(_summary, rows)),
            scenarios=tuple(
                ScenarioHistory(scenario=name, outcomes=tuple(found[name])) for name in names
            ),
        )

    def _outcomes(self, seqs: Sequence[int]) -> list[tuple[int, SuiteOutcome]]:
        return [(seq, outcome) for (seq, _), outcome in self._read_outcomes(seqs)]

    def _read_outcomes(self, seqs: Sequence[int]) -> Iterable[tuple[tuple[int, int], SuiteOutcome]]:
        rows = self._session.scalars(
            select(SuiteOutcomeRow)
            .where(SuiteOutcomeRow.run_seq.in_(seqs))
            .order_by(SuiteOutcomeRow.run_seq, SuiteOutcomeRow.place)
        )
        for row in rows:
            yield (
                (row.run_seq, row.place),
                combine(
                    SuiteOutcome,
                    row,
                    state=ScenarioState(row.state),
                    failures=tuple(from_json(row.failures)),
                ),
            )


def _summary(row: SuiteRunRow) -> SuiteRunSummary:
    decision: SuiteDecision = adapter(SuiteDecision).validate_json(row.body)
    return combine(
        SuiteRunSummary, decision, id=row.id, created_at=row.created_at, revision=row.revision
    )


def _has_changed(outcomes: Sequence[SuiteOutcome | None]) -> bool:
    """Returns whether a scenario's state in the last run differs from that before."""
    states = [one.state for one in outcomes if one is not None]
    return outcomes[-1] is not None and len(states) > 1 and states[-1] is not states[-2]
