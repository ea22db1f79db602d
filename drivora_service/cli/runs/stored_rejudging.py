"""Judging the traces of stored runs again: those of a data folder, or of a service."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from drivora_service.cli.runs.rejudging import Rejudge, Rejudged
from drivora_service.client import Client
from drivora_service.errors import NotFound, RequestConflict, TraceDamaged
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.checked_trace import read_checked_trace
from drivora_service.observations.trace_files.stored_trace import StoredTrace
from drivora_service.oracles.oracles_version import judged_by_current
from drivora_service.oracles.verdicts.verdict_json import verdict_content
from drivora_service.plugin_table import describe_missing_packages
from drivora_service.runs.run_report import RunStatus
from drivora_service.settings import Settings
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.evaluation_runs import EvaluationId
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.runs.run_records import JobFilter

_DATABASE = "drivora.sqlite3"


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run whose trace is to be judged.

    Attributes:
        id: Its id.
        file: The trace file by which it was chosen; ``None``: by its id.
    """

    id: str
    file: Path | None = None


def find_data_folder(path: Path, settings: Settings) -> Path | None:
    """Returns the data folder that a path is, or lies in with the service's traces.

    ``None`` if it is none, or has other files: what commands write elsewhere is of no store.
    """
    place = path.resolve()
    for folder in (place, *place.parents):
        has_database = (folder / _DATABASE).is_file()
        # The database of this one is that of a server.
        is_configured = bool(settings.database_url) and folder == settings.data_dir.resolve()
        if has_database or is_configured:
            parts = place.relative_to(folder).parts
            return folder if not parts or parts[0] in ("traces", "campaigns") else None
    return None


def find_stored_runs(client: Client, folder: Path, path: Path) -> tuple[StoredRun, ...]:
    """Returns the runs whose traces are at a path, and those whose traces should be there.

    Args:
        client: Client of the application of the data folder.
        folder: The data folder.
        path: It, or a file or folder in it.
    """
    place = path.resolve()
    files = [place] if place.is_file() else sorted(place.rglob("*.parquet"))
    found: dict[str, StoredRun] = {}
    for file in files:
        run_id = _run_of(file.relative_to(folder).parts)
        if run_id:
            found.setdefault(run_id, StoredRun(run_id, file))
    if place.is_dir():
        for run_id in _expected_runs(client, place.relative_to(folder).parts):
            found.setdefault(run_id, StoredRun(run_id))
    return tuple(found.values())


def rejudge_runs(client: Client, runs: Sequence[StoredRun], judge: Rejudge) -> Iterator[Rejudged]:
    """Judges the recorded traces of stored runs, and compares with the stored verdicts."""
    with TemporaryDirectory(prefix="drivora-") as scratch:
        for run in runs:
            yield _rejudge_run(client, run, judge, Path(scratch))


def _rejudge_run(client: Client, wanted: StoredRun, judge: Rejudge, scratch: Path) -> Rejudged:
    named = Rejudged(
        name=wanted.id,
        trace=wanted.id if wanted.file is None else str(wanted.file),
        run_id=wanted.id,
    )
    try:
        run = client.run(wanted.id)
    except NotFound as error:
        if wanted.file is None:
            return _not_judged(named, str(error))
        return _not_judged(named, "no stored run has this trace", is_error=False)
    if not run.trace_sha256:
        # Such as the second run of a flaky failure, or a run that has not ended.
        why = f"no recording of it is stored; the run is {run.status.replace('_', ' ')}"
        return _not_judged(named, why, is_error=wanted.file is None)
    file = scratch / f"{run.id}.parquet"
    stored = StoredTrace(run_id=run.id, path=file, sha256=run.trace_sha256)

    def read() -> Trace:
        try:
            client.save_run_observations(file, run.id)
            # Older services send what they have.
            return read_checked_trace(stored)
        except (NotFound, RequestConflict) as error:
            raise TraceDamaged(str(error)) from error
        finally:
            file.unlink(missing_ok=True)

    is_finished = run.status is RunStatus.FINISHED
    # Other than those here: the service may have other ones.
    by_others = is_finished and not judged_by_current(run.versions)
    named = replace(named, by_other_oracles=by_others)
    before = [verdict_content(one) for one in run.verdicts] if is_finished else None
    judged = judge.judge(named, read, before, note="judged; the stored run has no verdicts")
    if judged.not_installed:
        missing = describe_missing_packages(run.versions, "it")
        return replace(judged, note=missing)
    return judged


def _not_judged(named: Rejudged, why: str, *, is_error: bool = True) -> Rejudged:
    return Rejudged(
        name=named.name,
        trace=named.trace,
        run_id=named.run_id,
        error=why if is_error else "",
        note="" if is_error else f"not judged: {why}",
    )


def _run_of(parts: tuple[str, ...]) -> str:
    """Returns the id of the run of a trace file in a data folder; "" of other files."""
    if parts[-1].startswith("."):
        return ""
    match parts:
        case ("traces", *_, name):
            return name.removesuffix(".parquet")
        case ("campaigns", campaign_id, "traces", name) if name.partition(".")[0].isdecimal():
            return EvaluationId(campaign_id, int(name.partition(".")[0])).run_id
    return ""


def _expected_runs(client: Client, parts: tuple[str, ...]) -> Iterator[str]:
    """Yields the ids of the runs whose traces a folder of the service should have."""
    if len(parts) == 0 or parts == ("traces",):
        yield from (run.id for run in client.runs(JobFilter()) if run.trace_sha256)
    if len(parts) == 0 or parts[0] == "campaigns":
        campaign_id = parts[1] if len(parts) > 1 else ""
        wanted = FoundFilter(campaign_id=campaign_id, confirmation=Confirmation.CONFIRMED)
        yield from (one.run_id for one in client.found_failures(wanted) if one.is_recorded)
