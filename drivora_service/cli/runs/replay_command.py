"""``drivora replay``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import (
    DataDirOption,
    ServerOption,
    WorkersOption,
    location,
)
from drivora_service.cli.terminal.out_option import check_folder
from drivora_service.cli.terminal.output import JsonOption, print_json
from drivora_service.cli.terminal.run_progress import run_progress
from drivora_service.errors import ConfigurationError

if TYPE_CHECKING:
    from drivora_service.suites.replay.replay_records import Replay


def replay(
    runs: Annotated[list[str] | None, typer.Argument(metavar="[RUN…]", help="Ids of runs.")] = None,
    batch: Annotated[str, typer.Option(metavar="ID", help="All runs of this batch.")] = "",
    campaign: Annotated[
        str, typer.Option(metavar="ID", help="The runs of all failures of this campaign.")
    ] = "",
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write both traces of each run that diverges there."),
    ] = None,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Runs stored runs again and compares them: hash and frames, bit for bit.

    A run that diverges is reported at its first frame, actor and signal, with the versions that
    are others than those of the stored run. Exits with 1 if any run diverged, and with 3 if any
    could not be run again.
    """
    if not (runs or batch or campaign):
        raise ConfigurationError("name the runs to replay, or give --batch or --campaign")
    check_folder(out)
    where = location(server, data_dir)
    with open_client(server, data_dir, works=True, workers=workers) as client:
        from drivora_service.cli.runs.replay_running import choose_runs, read_originals, replay_runs

        chosen = choose_runs(client, runs or (), batch=batch, campaign=campaign)
        originals = read_originals(client, chosen)
        with _progress(len(chosen)) as step:
            done = replay_runs(
                client,
                originals,
                name=_name(chosen, batch, campaign),
                out=out,
                where=where,
                on_replay=step,
            )
    from drivora_service.suites.replay.replay_records import Replay, ReplayOutcome

    if as_json:
        from drivora_service.shapes import adapter

        print_json({"runs": adapter(list[Replay]).dump_python(done, mode="json")})
    else:
        from drivora_service.cli.runs.replay_output import print_replays

        print_replays(done)
    outcomes = {one.outcome for one in done}
    if ReplayOutcome.NOT_REPLAYED in outcomes:
        raise typer.Exit(ExitCode.NOT_DONE)
    if ReplayOutcome.DIVERGED in outcomes:
        raise typer.Exit(ExitCode.GATE_FAILED)


def _name(chosen: tuple[str, ...], batch: str, campaign: str) -> str:
    """Returns the name of the batch of the new runs: what is replayed."""
    if campaign:
        return f"drivora replay of campaign {campaign}"
    if batch:
        return f"drivora replay of batch {batch}"
    return f"drivora replay of {chosen[0]}" if len(chosen) == 1 else "drivora replay"


@contextmanager
def _progress(total: int) -> Iterator[Callable[[Replay], None]]:
    """Shows progress on standard error while replays end, if there are several."""
    if total < 2:
        yield lambda _replay: None
        return
    with run_progress(["replays"], total=total) as count:
        yield lambda _replay: count("replays")
