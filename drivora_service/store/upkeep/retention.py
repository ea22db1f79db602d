"""Removing runs and traces after retention times by kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from datetime import datetime, timedelta

import structlog
from sqlalchemy import select, update

from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.campaigns.campaign_tables import CampaignRow, FailureRow
from drivora_service.store.changes.revisions import revise_campaign
from drivora_service.store.database import Database
from drivora_service.store.engine.chunks import batched
from drivora_service.store.traces.trace_folders import FailureTraces, RunTraces
from drivora_service.store.upkeep.free_space import return_free_space
from drivora_service.store.upkeep.pruning import Chosen, Pruned, prune_chosen, remove_strays

_STRAY_AGE = timedelta(days=1)
_NOTHING = Pruned(runs=0, traces=0, freed_bytes=0)
_OVER = [state for state in CampaignState if state.is_over]

_log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Retention:
    """Retention times after the end of a run or campaign; ``None``: for ever.

    Attributes:
        passed_traces: Traces of runs that violated no oracle, were cancelled, invalid, or lost.
        passed_runs: Those runs themselves.
        failing_traces: Traces of all other runs.
        failing_runs: Those runs themselves.
        campaign_traces: Traces of the failures of campaigns that are over, but the first of each
            kind and of each group, which are kept.
    """

    passed_traces: timedelta | None = None
    passed_runs: timedelta | None = None
    failing_traces: timedelta | None = None
    failing_runs: timedelta | None = None
    campaign_traces: timedelta | None = None

    @property
    def keeps_everything(self) -> bool:
        """Whether nothing is ever removed."""
        return all(getattr(self, each.name) is None for each in fields(self))


def retain(
    database: Database,
    traces: RunTraces,
    campaign_traces: FailureTraces,
    retention: Retention,
    *,
    now: datetime,
    stopping: Callable[[], bool] = lambda: False,
) -> Pruned:
    """Removes expired runs and traces; a server may run meanwhile.

    Args:
        database: Holds the runs and campaigns.
        traces: Folder of the traces of runs.
        campaign_traces: Folder of the traces of failures.
        retention: Retention times.
        now: Time at which ages are measured.
        stopping: Called between two transactions; returns whether to stop early.
    """
    if retention.keeps_everything:
        return _NOTHING
    pruned = _NOTHING
    for chosen, age, only_traces in (
        (Chosen.PASSED, retention.passed_traces, True),
        (Chosen.PASSED, retention.passed_runs, False),
        (Chosen.FAILING, retention.failing_traces, True),
        (Chosen.FAILING, retention.failing_runs, False),
    ):
        if age is not None:
            pruned += prune_chosen(
                database,
                traces,
                chosen,
                ended_before=now - age,
                only_traces=only_traces,
                stopping=stopping,
            )
    if stopping():
        return pruned
    if retention.campaign_traces is not None:
        pruned += _prune_campaigns(database, campaign_traces, now - retention.campaign_traces)
    pruned += remove_strays(database, traces, written_before=now - _STRAY_AGE)
    returned = return_free_space(database)
    if pruned != _NOTHING:
        _log.info(
            "old_runs_removed",
            runs=pruned.runs,
            traces=pruned.traces,
            freed_mib=round((pruned.freed_bytes + returned) / 2**20, 1),
        )
    return pruned


def _prune_campaigns(
    database: Database, campaign_traces: FailureTraces, ended_before: datetime
) -> Pruned:
    with database.read() as transaction:
        campaigns = transaction.session.execute(
            select(CampaignRow.seq, CampaignRow.id).where(
                CampaignRow.state.in_(_OVER), CampaignRow.ended_at < ended_before
            )
        ).all()
    removed = freed = 0
    for seq, campaign_id in campaigns:
        kept = _drop_traces(database, seq)
        for name in campaign_traces.names(campaign_id):
            if name not in kept:
                freed += campaign_traces.remove(campaign_id, name)
                removed += 1
    return Pruned(runs=0, traces=removed, freed_bytes=freed)


def _drop_traces(database: Database, campaign_seq: int) -> set[str]:
    """Clears the traces that are not kept; returns the names of those that are."""
    with database.read() as transaction:
        failures = transaction.session.execute(
            select(
                FailureRow.number,
                FailureRow.oracle,
                FailureRow.kind,
                FailureRow.group,
                FailureRow.trace,
            )
            .where(FailureRow.campaign_seq == campaign_seq, FailureRow.trace != "")
            .order_by(FailureRow.number, FailureRow.place)
        ).all()
    first_of_kind: dict[str, int] = {}
    # Groups are numbered from 0 within each oracle.
    first_of_group: dict[tuple[str, int], int] = {}
    for row in failures:
        first_of_kind.setdefault(row.kind, row.number)
        if row.group is not None:
            first_of_group.setdefault((row.oracle, row.group), row.number)
    kept = {*first_of_kind.values(), *first_of_group.values()}
    for numbers in batched(sorted({row.number for row in failures} - kept), 200):
        with database.write() as transaction:
            transaction.session.execute(
                update(FailureRow)
                .where(FailureRow.campaign_seq == campaign_seq, FailureRow.number.in_(numbers))
                .values(trace="")
            )
            revise_campaign(transaction.session, campaign_seq)
    return {row.trace for row in failures if row.number in kept}
