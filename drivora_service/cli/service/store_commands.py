"""``drivora store``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption
from drivora_service.cli.terminal.output import JsonOption, fail, print_json, say

if TYPE_CHECKING:
    from drivora_service.store.database import Database
    from drivora_service.store.traces.trace_folders import FailureTraces, RunTraces

app = typer.Typer(help="The database and the traces.", no_args_is_help=True)


@app.command()
def migrate(data_dir: DataDirOption = None, as_json: JsonOption = False) -> None:
    """Makes the database, or brings it to the schema of this version."""
    from drivora_service.store.migration import schema_version

    with _open_store(data_dir, makes_data=True) as (database, *_):
        version = schema_version(database.engine)
    if as_json:
        print_json({"schema": version})
    else:
        say(f"the database has schema {version}")


@app.command()
def backup(
    target: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of its own.")],
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Copies database and traces, also while a service runs; DIR is then a data folder."""
    from drivora_service.store.upkeep.backup import back_up

    with _open_store(data_dir) as (database, traces, campaign_traces):
        made = back_up(database, traces, target, campaign_traces=campaign_traces)
    if as_json:
        print_json(
            {"runs": made.runs, "traces": made.traces, "missing_traces": made.missing_traces}
        )
    else:
        say(f"copied {made.runs} runs and {made.traces} traces to {target}")
    if made.missing_traces:
        fail(f"{len(made.missing_traces)} traces were missing; `drivora store verify` lists them")
        raise typer.Exit(ExitCode.NOT_DONE)


@app.command()
def verify(
    hashes: Annotated[
        bool, typer.Option("--hashes", help="Read every trace and compare its hash.")
    ] = False,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Looks for contradictions in what is stored; exits with 1 if there is any."""
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.observations.trace_files.trace_file import read_trace
    from drivora_service.observations.trace_files.trace_hash import trace_sha256
    from drivora_service.store.upkeep.store_verification import verify as verify_store

    def hash_trace(path: Path) -> str:
        return trace_sha256(read_trace(path))

    with _open_store(data_dir) as (database, traces, campaign_traces):
        found = verify_store(
            database,
            traces,
            campaigns=settings_for(data_dir).campaigns_dir,
            campaign_traces=campaign_traces,
            hash_trace=hash_trace if hashes else None,
        )
        findings = tuple(found)
    if as_json:
        print_json([{"kind": f.kind, "subject": f.subject, "message": f.message} for f in findings])
    else:
        for finding in findings:
            fail(f"{finding.kind}: {finding.subject}: {finding.message}")
        say(f"{len(findings)} contradictions")
    if findings:
        raise typer.Exit(ExitCode.GATE_FAILED)


@app.command()
def prune(
    older_than: Annotated[
        float | None,
        typer.Option(
            "--older-than",
            min=0.0,
            metavar="DAYS",
            help="Age in days; left out: what the DRIVORA_RETAIN_… settings say.",
        ),
    ] = None,
    keep_violated: Annotated[
        bool, typer.Option("--keep-violated", help="Keep runs with a violation.")
    ] = False,
    only_traces: Annotated[
        bool, typer.Option("--only-traces", help="Keep the runs, remove their traces.")
    ] = False,
    compact: Annotated[
        bool,
        typer.Option("--compact", help="Then rewrite the database without free space."),
    ] = False,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Removes runs that ended long ago, with their traces, permanently."""
    from datetime import UTC, datetime, timedelta

    from drivora_service.cli.application.installation import settings_for
    from drivora_service.errors import ConfigurationError
    from drivora_service.retention_settings import retention
    from drivora_service.store.upkeep.free_space import refuse_rewriting, rewrite_database
    from drivora_service.store.upkeep.lost_runs import refuse_lost_runs
    from drivora_service.store.upkeep.pruning import prune as prune_store
    from drivora_service.store.upkeep.retention import retain

    settings = settings_for(data_dir)
    kept = retention(settings)
    now = datetime.now(UTC)
    if older_than is None and (keep_violated or only_traces or kept.keeps_everything):
        raise ConfigurationError(
            "the age of the runs to remove is missing; give --older-than DAYS, or set "
            "DRIVORA_RETAIN_PASSED_RUNS_DAYS or another DRIVORA_RETAIN_… setting"
        )
    with _open_store(data_dir) as (database, traces, campaign_traces):
        # What would be removed is the last evidence of the runs.
        refuse_lost_runs(database, traces, settings.campaigns_dir)
        if compact:
            refuse_rewriting(database)
        if older_than is None:
            pruned = retain(database, traces, campaign_traces, kept, now=now)
        else:
            pruned = prune_store(
                database,
                traces,
                ended_before=now - timedelta(days=older_than),
                keep_violated=keep_violated,
                only_traces=only_traces,
            )
        if compact:
            rewrite_database(database)
    if as_json:
        print_json(
            {"runs": pruned.runs, "traces": pruned.traces, "freed_bytes": pruned.freed_bytes}
        )
    else:
        freed = f"{pruned.freed_bytes / 2**20:.1f} MiB"
        say(f"removed {pruned.runs} runs and {pruned.traces} traces ({freed})")


@contextmanager
def _open_store(
    data_dir: Path | None, *, makes_data: bool = False
) -> Iterator[tuple[Database, RunTraces, FailureTraces]]:
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.cli.terminal.private_files import keep_files_private
    from drivora_service.store.command_database import CommandDatabase
    from drivora_service.trace_settings import trace_places

    keep_files_private()
    settings = settings_for(data_dir)
    database = CommandDatabase(
        settings.data_dir, settings.resolved_database_url, makes_data=makes_data
    )
    try:
        places = trace_places(settings)
        yield database(), places.of_runs(), places.of_failures()
    finally:
        database.close()
