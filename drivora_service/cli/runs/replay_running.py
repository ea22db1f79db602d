"""Replays of stored runs, in this process or on a service."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from drivora_service.cli.runs.file_running import note_batch_on_stop, problems_of_item
from drivora_service.cli.terminal.out_option import convert_write_errors
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.client import Client
from drivora_service.errors import (
    InvalidDocument,
    NotFound,
    Problem,
    RequestConflict,
    TraceDamaged,
)
from drivora_service.observations.trace_files.checked_trace import read_checked_trace
from drivora_service.observations.trace_files.stored_trace import StoredTrace
from drivora_service.plugin_table import describe_missing_packages
from drivora_service.scenario.documents import document_text, parse_document
from drivora_service.store.engine.chunks import batched
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.runs.run_records import JobFilter, Priority, RunRecord
from drivora_service.suites.replay.replay_comparing import (
    Original,
    Recording,
    compare,
    explain_not_replayable,
    make_not_replayed,
)
from drivora_service.suites.replay.replay_records import Replay, ReplayOutcome

_RUNS_OF_BATCH = 500
"""A service limits the size of a request, and scenarios may be large."""


def choose_runs(
    client: Client, runs: Sequence[str], *, batch: str, campaign: str
) -> tuple[str, ...]:
    """Returns the ids of the runs to replay, each once.

    Args:
        client: Client of the application or service that stores them.
        runs: Ids of runs.
        batch: Id of a batch, all runs of which are chosen; "": none.
        campaign: Id of a campaign, whose failures are chosen; "": none.

    Raises:
        NotFound: There is no such batch or campaign.
    """
    chosen = [*runs]
    if batch:
        client.batch(batch)
        chosen += [run.id for run in client.runs(JobFilter(batch_id=batch), oldest_first=True)]
    if campaign:
        client.campaign(campaign)
        found = [one.run_id for one in client.found_failures(FoundFilter(campaign_id=campaign))]
        chosen += reversed(found)
    return tuple(dict.fromkeys(chosen))


def read_originals(client: Client, runs: Sequence[str]) -> list[Original]:
    """Reads the runs that are to be replayed.

    Raises:
        NotFound: There is no run of one of the ids.
    """
    networks: dict[str, tuple[str, str]] = {}
    originals = []
    for run in map(client.run, runs):
        network_sha256 = ""
        if run.campaign_id and not run.trace_sha256:
            if run.campaign_id not in networks:
                campaign = client.campaign(run.campaign_id)
                networks[run.campaign_id] = (campaign.town, campaign.network_sha256)
            town, sha256 = networks[run.campaign_id]
            network_sha256 = sha256 if town == run.town else ""
        originals.append(Original(run=run, network_sha256=network_sha256))
    return originals


def replay_runs(
    client: Client,
    originals: Sequence[Original],
    *,
    name: str,
    out: Path | None,
    where: str,
    on_replay: Callable[[Replay], None],
) -> list[Replay]:
    """Runs the scenarios of stored runs again and compares, in the order of the runs.

    Args:
        client: Client of the application or service that stores the runs and runs them again.
        originals: The runs.
        name: Name of the batch of the new runs.
        out: Folder for the recordings of runs that diverge; ``None``: they are not written.
        where: Options with which other commands find the new runs.
        on_replay: Called with each replay, in any order.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    replays: dict[str, Replay] = {}

    def tell(replay: Replay) -> None:
        replays[replay.run.id] = replay
        on_replay(replay)

    for chunk in batched(originals, _RUNS_OF_BATCH):
        documents: dict[str, str] = {}
        posted: list[Original] = []
        for original in chunk:
            reason = explain_not_replayable(original) or _read_document(client, original, documents)
            if reason:
                tell(make_not_replayed(original, reason))
            else:
                posted.append(original)
        if posted:
            _replay_batch(client, posted, documents, name=name, out=out, where=where, tell=tell)
    return [replays[original.run.id] for original in originals]


def _read_document(client: Client, original: Original, documents: dict[str, str]) -> str:
    """Reads the scenario of a run; returns why it cannot be run, or ""."""
    run = original.run
    try:
        documents[run.id] = document_text(parse_document(client.run_scenario(run.id)))
    except NotFound:
        return "its scenario is not stored: it was an invalid candidate"
    except InvalidDocument as error:
        return f"its scenario cannot be read by this version: {_in_words(error.problems)}"
    return ""


def _replay_batch(
    client: Client,
    originals: Sequence[Original],
    documents: Mapping[str, str],
    *,
    name: str,
    out: Path | None,
    where: str,
    tell: Callable[[Replay], None],
) -> None:
    try:
        submission = client.post_batch(
            [documents[original.run.id] for original in originals],
            labels=[f"replay of {original.run.id}" for original in originals],
            seeds=[original.run.seed for original in originals],
            name=name,
            priority=Priority.INTERACTIVE,
        )
    except InvalidDocument as error:
        for place, original in enumerate(originals):
            problems = problems_of_item(error.problems, place)
            tell(make_not_replayed(original, _describe_refusal(problems, original)))
        return
    for item in submission.items:
        if item.problems:
            listed = [
                Problem(pointer=p.pointer, code=p.code, message=p.message) for p in item.problems
            ]
            original = originals[item.item]
            tell(make_not_replayed(original, _describe_refusal(listed, original)))
    with (
        note_batch_on_stop(submission.batch.id, where),
        TemporaryDirectory(prefix="drivora-") as scratch,
    ):
        files = Path(scratch) / "original.parquet", Path(scratch) / "replayed.parquet"
        for again in client.wait_for_batch(submission.batch.id):
            original = originals[again.item]
            before, after = (
                _fetch_recording(client, run, whose, file)
                for run, whose, file in (
                    (original.run, "the run", files[0]),
                    (again, "the replay", files[1]),
                )
            )
            replay = compare(original, again, before, after)
            if out is not None and replay.outcome is ReplayOutcome.DIVERGED:
                replay = replace(replay, files=tuple(_copy_recordings(files, out, replay.run.id)))
            tell(replay)


def _fetch_recording(client: Client, run: RunRecord, whose: str, file: Path) -> Recording:
    """Fetches and reads the recording of a run, whose file is left where it was wanted."""
    file.unlink(missing_ok=True)
    if not run.trace_sha256:
        return Recording(lack=f"{whose} has no recording")
    stored = StoredTrace(run_id=run.id, path=file, sha256=run.trace_sha256)
    try:
        client.save_run_observations(file, run.id)
        # Older services send what they have.
        return Recording(trace=read_checked_trace(stored))
    except NotFound:
        return Recording(lack=f"the recording of {whose} was removed")
    except (RequestConflict, TraceDamaged) as error:
        file.unlink(missing_ok=True)
        return Recording(lack=f"the recording of {whose} is damaged: {error}", is_damaged=True)


def _copy_recordings(files: Sequence[Path], out: Path, name: str) -> list[str]:
    """Copies the recordings that exist into a folder; returns their places."""
    kept = []
    for file in files:
        if file.is_file():
            target = out / f"{name}.{file.stem}.trace.parquet"
            with convert_write_errors(target):
                shutil.copyfile(file, target)
                give_to_user(target)
            kept.append(str(target))
    return kept


def _describe_refusal(problems: Sequence[Problem], original: Original) -> str:
    missing = describe_missing_packages(original.run.versions, "it")
    said = f"{missing}; " if missing else ""
    return f"its scenario cannot be run here: {said}{_in_words(problems)}"


def _in_words(problems: Sequence[Problem]) -> str:
    return "; ".join(f"{p.pointer}: {p.message}" if p.pointer else p.message for p in problems)
