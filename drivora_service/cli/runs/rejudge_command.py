"""``drivora rejudge``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import ids_of
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import JsonOption, print_json, print_table, say
from drivora_service.errors import ConfigurationError
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.cli.runs.rejudging import Rejudge, Rejudged
    from drivora_service.settings import Settings


def rejudge(
    traces: Annotated[
        list[str],
        typer.Argument(
            metavar="TRACE…|FOLDER|RUN",
            help="Trace files (.parquet), folders of them, data folders or folders in them, or "
            "runs (id, first digits of it, name, or latest), or CAMPAIGN-EVALUATION.",
        ),
    ],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Judges recorded traces by the current oracles and prints the changes.

    Earlier verdicts are those of the stored run, or of the report beside a trace
    (NAME.report.json). A trace that has not the stored hash is damaged, and is not judged. Exits
    with 1 if a verdict changed, and with 3 if a trace is damaged or could not be judged, also by
    an oracle that is not installed any more.
    """
    done = list(_rejudge(traces, server, data_dir))
    if as_json:
        _print_content(done)
    else:
        _print_rows(done)
    if any(one.error or one.not_installed for one in done):
        raise typer.Exit(ExitCode.NOT_DONE)
    if any(one.is_changed for one in done):
        raise typer.Exit(ExitCode.GATE_FAILED)


def _rejudge(things: Sequence[str], server: str, data_dir: Path | None) -> Iterator[Rejudged]:
    """Judges what was named, the service's own files with the stored hashes and verdicts."""
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.cli.runs.rejudging import find_traces
    from drivora_service.cli.runs.stored_rejudging import (
        StoredRun,
        find_data_folder,
        find_stored_runs,
        rejudge_runs,
    )

    settings = settings_for(data_dir)
    paths: list[Path] = []
    stored: dict[Path, list[Path]] = {}
    run_ids: list[str] = []
    for thing in dict.fromkeys(things):
        path = Path(thing)
        if not path.exists():
            if "/" in thing or path.suffix == ".parquet":
                raise ConfigurationError(f"there is no file {path}")
            run_ids.append(thing)
        elif (folder := find_data_folder(path, settings)) is not None:
            stored.setdefault(folder, []).append(path)
        else:
            paths.append(path)
    judge = _judge(settings)
    for file in find_traces(paths):
        yield judge.file(file)
    for folder, inside in stored.items():
        with open_client("", folder) as client:
            found = {
                run.id: run for path in inside for run in find_stored_runs(client, folder, path)
            }
            yield from rejudge_runs(client, tuple(found.values()), _judge(settings_for(folder)))
    if run_ids:
        # With --server the data folder is for imported networks.
        with open_client(server, None if server else data_dir) as client:
            chosen = ids_of(client, run_ids, IdKind.RUN)
            yield from rejudge_runs(client, tuple(map(StoredRun, chosen)), judge)


def _judge(settings: Settings) -> Rejudge:
    from drivora_service.cli.application.installation import network_catalogue, oracle_catalogue
    from drivora_service.cli.runs.rejudging import Rejudge

    return Rejudge(network_catalogue(settings), oracle_catalogue(settings))


def _print_content(done: Sequence[Rejudged]) -> None:
    from drivora_service.oracles.verdicts.verdict_json import verdict_content

    runs = [
        {
            "trace": one.trace,
            "run": one.run_id,
            "error": one.error,
            "damaged": one.is_damaged,
            "note": one.note,
            "by_other_oracles": one.by_other_oracles,
            "compared": one.compared,
            "changes": [
                {"oracle": c.oracle, "ego": c.ego, "before": c.before, "after": c.after}
                for c in one.changes
            ],
            "verdicts": [verdict_content(verdict) for verdict in one.verdicts],
        }
        for one in done
    ]
    print_json({"runs": runs})


def _print_rows(done: Sequence[Rejudged]) -> None:
    from drivora_service.oracles.verdicts.verdict_changes import NOT_INSTALLED

    rows = [
        (one.name, change.oracle, change.ego, change.before, change.after)
        for one in done
        for change in one.changes
    ]
    if rows:
        columns = ("run", "oracle", "ego", "before", "after")
        print_table("", columns, rows, wrap=("before", "after"))
        counts = Counter(oracle for _, oracle, _, _, after in rows if after != NOT_INSTALLED)
        by_oracle = [(oracle, str(count)) for oracle, count in counts.most_common()]
        if by_oracle:
            print_table("Changed verdicts by oracle", ("oracle", "changed"), by_oracle)
    for one in done:
        if one.error or one.note:
            say(f"{one.trace}: {one.error or one.note}")
    compared = sum(one.compared for one in done)
    changed = sum(one.is_changed for one in done)
    damaged = sum(one.is_damaged for one in done)
    say(f"Traces: {len(done)}; compared: {compared}; changed: {changed}; damaged: {damaged}")
    missing = Counter(oracle for one in done for oracle in one.not_installed)
    for oracle, count in sorted(missing.items()):
        say(f"Oracle {oracle} is not installed; traces that it judged before: {count}")
    if others := sum(one.by_other_oracles for one in done):
        say(f"Judged before by another version of the oracles: {others}")
