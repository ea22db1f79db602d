"""Campaigns: storing them, changing their states, and reading them."""

from __future__ import annotations

import json
from collections.abc import Collection
from datetime import UTC, datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.errors import Conflict, UnknownName
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import (
    BestScore,
    CampaignCounts,
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    CampaignSummary,
    CampaignToRun,
    NewCampaign,
    StudyCell,
)
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.campaigns.seed_run_records import (
    SeedRun,
    seed_runs_from_json,
    seed_runs_to_json,
)
from drivora_service.store.engine.ids import new_id
from drivora_service.store.engine.merging import Branch, first_numbers
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.migration import refuse_other_schema
from drivora_service.store.runs.batch_repository import BatchRepository
from drivora_service.store.runs.run_records import BatchState, Page
from drivora_service.store.runs.run_tables import BatchRow

_TO_RUN = (CampaignState.QUEUED, CampaignState.RUNNING)

_MOST_NAMED = 5
"""Number of campaigns that an error names, newest first."""


class CampaignRepository:
    """Reads and writes campaigns; ``EvaluationRepository`` has their evaluations."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def create(self, campaign: NewCampaign) -> CampaignRecord:
        """Stores a queued campaign."""
        now, cell = datetime.now(UTC), campaign.cell
        configuration = campaign.configuration or AgentConfiguration(words=campaign.agent)
        row = CampaignRow(
            id=new_id(),
            name=campaign.name,
            document=campaign.document,
            tester=campaign.tester,
            agent=campaign.agent,
            configuration=configuration.words,
            configuration_id=configuration.id,
            town=campaign.town,
            network_sha256=campaign.network_sha256,
            budget=campaign.budget,
            versions=json.dumps(dict(campaign.versions), sort_keys=True),
            state=CampaignState.QUEUED,
            created_at=now,
            updated_at=now,
            study_id=campaign.study_id,
            study_scenario="" if cell is None else cell.scenario,
            study_agent="" if cell is None else cell.agent,
            study_method="" if cell is None else cell.method,
            repetition=0 if cell is None else cell.repetition,
        )
        self._session.add(row)
        self._session.flush()
        return _record(row)

    def get(self, campaign_id: str) -> CampaignRecord:
        """Returns a campaign.

        Raises:
            UnknownName: There is none of this id.
        """
        return _record(campaign_row(self._session, campaign_id))

    def page(
        self,
        *,
        states: Collection[CampaignState] = (),
        study_id: str = "",
        limit: int = 50,
        page_token: str = "",
    ) -> Page[CampaignSummary]:
        """Returns campaigns, newest first.

        Args:
            states: Only those in one of these states; none: all.
            study_id: Only those of this study; "": all.
            limit: Greatest number of campaigns.
            page_token: Token of the page.

        Raises:
            InvalidDocument: The token is not one of this list.
        """
        scope = f"campaigns {sorted(states)} {study_id}"
        last = read_token(scope, page_token) if page_token else None
        number = CampaignRow.seq
        of_study = (CampaignRow.study_id == study_id,) if study_id else ()
        branches = [
            Branch(number=number, conditions=(*of_study, CampaignRow.state == state))
            for state in sorted(states or (CampaignState if study_id else ()))
        ]
        numbers = first_numbers(
            self._session,
            branches or [Branch(number=number, conditions=())],
            limit=limit + 1,
            after=last,
            descending=True,
        )
        more = make_token(scope, numbers[limit - 1]) if len(numbers) > limit else ""
        rows = self._session.scalars(
            select(CampaignRow).where(CampaignRow.seq.in_(numbers[:limit]))
        )
        shown = sorted(rows, key=lambda row: row.seq, reverse=True)
        return Page(items=tuple(_summary(row) for row in shown), next_page_token=more)

    def to_run(self) -> tuple[CampaignToRun, ...]:
        """Returns the campaigns that the service must run, those already running first."""
        query = (
            select(CampaignRow.id, CampaignRow.state, CampaignRow.request)
            .where(CampaignRow.batch_id != "", CampaignRow.state.in_(_TO_RUN))
            # "running" sorts after "queued".
            .order_by(CampaignRow.state.desc(), CampaignRow.seq)
        )
        return tuple(
            CampaignToRun(id=id_, request=CampaignRequest(request))
            for id_, _state, request in self._session.execute(query)
        )

    def begin(
        self, campaign_id: str, *, only_queued: bool = False, claim: str = ""
    ) -> CampaignRecord:
        """Sets a campaign to running and clears its pending request.

        Args:
            campaign_id: Id of the campaign.
            only_queued: Whether to refuse a campaign that is not queued and to keep its pending
                request.
            claim: Id of the work that begins, see :meth:`require_claim`.

        Raises:
            UnknownName: There is none of this id.
            Conflict: It is over, or not queued; or a newer version has migrated the database.
        """
        refuse_other_schema(self._session)
        row = campaign_row(self._session, campaign_id)
        _refuse_if_over(row)
        if only_queued and row.state not in _TO_RUN:
            raise Conflict(f"campaign {campaign_id} is {row.state}, not queued")
        if not only_queued:
            row.request = CampaignRequest.NONE
        now = datetime.now(UTC)
        row.state, row.message = CampaignState.RUNNING, ""
        row.started_at = row.started_at or now
        row.updated_at = now
        row.ended_at = None
        row.claim = claim
        return _record(row)

    def require_claim(self, campaign_id: str, claim: str) -> None:
        """Refuses to write for a process that has lost the campaign to another one.

        The lock of a campaign is lost with the connection to the database, and the process that
        held it may not know.

        Args:
            campaign_id: Id of the campaign.
            claim: What its process gave :meth:`begin`.

        Raises:
            UnknownName: There is none of this id.
            Conflict: It has ended, or another process has begun it since.
        """
        if campaign_row(self._session, campaign_id).claim != claim:
            raise Conflict(f"another process has taken campaign {campaign_id} over")

    def keep_seed_runs(self, campaign_id: str, runs: tuple[SeedRun, ...]) -> None:
        """Stores the runs of the seed scenarios of a campaign, in place of those before.

        Raises:
            UnknownName: There is none of this id.
        """
        row = campaign_row(self._session, campaign_id)
        row.seed_runs = seed_runs_to_json(runs)

    def is_first_of_its_scene(self, campaign_id: str) -> bool:
        """Returns whether no campaign of its study before it has its seed scenario and its ADS.

        True for a campaign of no study.

        Raises:
            UnknownName: There is none of this id.
        """
        row = campaign_row(self._session, campaign_id)
        if not row.study_id:
            return True
        first = self._session.scalar(
            select(func.min(CampaignRow.seq)).where(
                CampaignRow.study_id == row.study_id,
                CampaignRow.study_scenario == row.study_scenario,
                CampaignRow.study_agent == row.study_agent,
            )
        )
        return first == row.seq

    def end(
        self, campaign_id: str, state: CampaignState, *, message: str = "", active_s: float = 0.0
    ) -> CampaignRecord:
        """Sets the state of a campaign that has ended or paused, and that of its runs.

        Args:
            campaign_id: Id of the campaign.
            state: Any but ``running``.
            message: Why it failed.
            active_s: Seconds of work since the last evaluation.

        Raises:
            UnknownName: There is none of this id.
        """
        row = campaign_row(self._session, campaign_id)
        now = datetime.now(UTC)
        row.state, row.message, row.request = state, message, CampaignRequest.NONE
        row.updated_at, row.claim = now, ""
        row.active_s += active_s
        if state.is_over or state is CampaignState.FAILED:
            row.ended_at = now
        self._end_runs(row)
        return _record(row)

    def ask_for(self, campaign_id: str, request: CampaignRequest) -> CampaignRecord:
        """Requests that a running campaign stop; one that does not run stops at once.

        A request that is already fulfilled changes nothing. The caller must know whether a campaign
        that is stored as running has a process that will follow the request.

        Raises:
            UnknownName: There is none of this id.
            Conflict: It is over, so that it cannot be paused.
        """
        row = campaign_row(self._session, campaign_id)
        if request is CampaignRequest.CANCEL and CampaignState(row.state).is_over:
            return _record(row)
        _refuse_if_over(row)
        if row.state == CampaignState.RUNNING:
            if row.request != CampaignRequest.CANCEL:
                row.request = request
            return _record(row)
        if request is CampaignRequest.CANCEL:
            return self.end(campaign_id, CampaignState.CANCELLED)
        return self.end(campaign_id, CampaignState.PAUSED, message=row.message)

    def queue_again(self, campaign_id: str) -> CampaignRecord:
        """Queues a campaign that is not running.

        Raises:
            UnknownName: There is none of this id.
            Conflict: It is over, or runs.
        """
        row = campaign_row(self._session, campaign_id)
        _refuse_if_over(row)
        if row.state == CampaignState.RUNNING:
            raise Conflict(f"campaign {campaign_id} is already running")
        row.state, row.message, row.request = CampaignState.QUEUED, "", CampaignRequest.NONE
        row.updated_at = datetime.now(UTC)
        row.ended_at = None
        return _record(row)

    def request_of(self, campaign_id: str) -> CampaignRequest:
        """Returns the pending request to a campaign.

        Raises:
            UnknownName: There is none of this id.
        """
        found = self._session.scalar(
            select(CampaignRow.request).where(CampaignRow.id == campaign_id)
        )
        if found is None:
            raise _unknown(self._session, campaign_id)
        return CampaignRequest(found)

    def _end_runs(self, row: CampaignRow) -> None:
        batch = self._session.scalar(select(BatchRow).where(BatchRow.id == row.batch_id))
        if batch is None:
            return
        if row.state == CampaignState.CANCELLED:
            BatchRepository(self._session).cancel(batch.id)
        elif batch.state == BatchState.OPEN and row.state != CampaignState.FINISHED:
            batch.state = BatchState.PAUSED


def campaign_row(session: Session, campaign_id: str) -> CampaignRow:
    """Returns the row of a campaign.

    Raises:
        UnknownName: There is none of this id.
    """
    row = session.scalar(select(CampaignRow).where(CampaignRow.id == campaign_id))
    if row is None:
        raise _unknown(session, campaign_id)
    return row


def _unknown(session: Session, wanted: str) -> UnknownName:
    """Returns the error for an unknown id, with similar ids."""
    ids = select(CampaignRow.id).order_by(CampaignRow.seq.desc()).limit(_MOST_NAMED + 1)
    found = session.scalars(ids.where(CampaignRow.name == wanted)).all()
    hint = "That is a name, and here an id is needed" if found else ""
    found = found or session.scalars(ids).all()
    more = ("…",) if len(found) > _MOST_NAMED else ()
    return UnknownName("campaign", wanted, (*found[:_MOST_NAMED], *more), hint)


def _refuse_if_over(row: CampaignRow) -> None:
    if CampaignState(row.state).is_over:
        raise Conflict(
            f"campaign {row.id} is {row.state}; start a new one. `drivora campaign show {row.id} "
            "--out DIR` writes what it has found"
        )


def _summary(row: CampaignRow) -> CampaignSummary:
    return combine(
        CampaignSummary,
        row,
        state=CampaignState(row.state),
        request=CampaignRequest(row.request),
        counts=combine(CampaignCounts, row),
        cell=_cell(row),
        seed_runs=seed_runs_from_json(row.seed_runs),
    )


def _cell(row: CampaignRow) -> StudyCell | None:
    if not row.study_id:
        return None
    return StudyCell(
        scenario=row.study_scenario,
        agent=row.study_agent,
        method=row.study_method,
        repetition=row.repetition,
    )


def _record(row: CampaignRow) -> CampaignRecord:
    return combine(
        CampaignRecord,
        _summary(row),
        row,
        best=best_scores(row),
        document=json.loads(row.document),
        versions=json.loads(row.versions),
    )


def best_scores(row: CampaignRow) -> dict[str, BestScore]:
    """Returns the best scores of a row."""
    return {
        name: BestScore(value=value, evaluation=number)
        for name, (value, number) in json.loads(row.best).items()
    }
