"""Signs that a database has lost its runs, of which only the files are left."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import select

from drivora_service.errors import StoreDamaged
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.database import Database
from drivora_service.store.engine.storage_faults import advise_restore
from drivora_service.store.runs.run_tables import RunRow
from drivora_service.store.traces.trace_folders import RunTraces, run_ids


@dataclass(frozen=True, slots=True, kw_only=True)
class LostRuns:
    """Files of runs or campaigns beside a database that has none.

    Attributes:
        place: Folder of the files.
        message: What was found and what to do.
    """

    place: str
    message: str


def find_lost_runs(
    database: Database, traces: RunTraces, campaigns: Path | None
) -> LostRuns | None:
    """Returns files whose runs or campaigns the database must have had; ``None`` if there are none.

    Such a database is new, or was opened without its write-ahead log, or is another one. Rows are
    written before files, and campaigns are never removed. The traces of removed runs may be left
    by a kill; where not a single run is left either, the two cannot be distinguished.

    Args:
        database: Read in one transaction.
        traces: Traces of runs; a storage that does not answer counts as empty.
        campaigns: Folder of the folders of campaigns; ``None``: not searched.
    """
    with database.read() as transaction:
        has_run = transaction.session.scalar(select(RunRow.seq).limit(1)) is not None
        has_campaign = transaction.session.scalar(select(CampaignRow.seq).limit(1)) is not None
    if not has_run and _has_trace(traces):
        return _lost_runs(database, "no run", "traces of runs are", traces.place)
    if campaigns is not None and not has_campaign and _has_folder(campaigns):
        return _lost_runs(database, "no campaign", "files of campaigns are", str(campaigns))
    return None


def refuse_lost_runs(database: Database, traces: RunTraces, campaigns: Path) -> None:
    """Refuses to work with a database that has lost its runs, see :func:`find_lost_runs`.

    Raises:
        StoreDamaged: It has; new runs would hide that.
    """
    lost = find_lost_runs(database, traces, campaigns)
    if lost is not None:
        raise StoreDamaged(lost.message)


def _lost_runs(database: Database, nothing: str, found: str, place: str) -> LostRuns:
    file = database.file
    if file is None:
        name = "the database"
        cause = "it was emptied, or DRIVORA_DATABASE_URL names another one"
        restore = "restore it from a backup, or correct DRIVORA_DATABASE_URL"
    else:
        name = str(file)
        cause = f"it was replaced, or its write-ahead log {file.name}-wal was removed"
        restore = f"put the log back first if you have it; else {advise_restore(file)}"
    message = (
        f"{name} holds {nothing}, but {found} in {place}: {cause}; {restore}. To give up what was "
        f"stored and begin anew, move {place} away"
    )
    return LostRuns(place=place, message=message)


def _has_trace(traces: RunTraces) -> bool:
    try:
        return next(run_ids(traces), None) is not None
    except OSError:
        # The probe of the storage reports it.
        return False


def _has_folder(campaigns: Path) -> bool:
    try:
        return any(folder.is_dir() and any(folder.iterdir()) for folder in campaigns.iterdir())
    except OSError:
        return False
