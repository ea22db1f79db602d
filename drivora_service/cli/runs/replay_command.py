"""``drivora replay``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import id_of, ids_of
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import (
    DataDirOption,
    ServerOption,
    WorkersOption,
    location,
)
from drivora_service.cli.terminal.out_option import check_folder
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.cli.terminal.run_progress import run_progress
from drivora_service.errors import ConfigurationError
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.suites.replay.replay_records import Replay


@with_forms
def replay(
    runs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[RUN…]",
            help="Runs (id, first digits of it, name, or latest), or CAMPAIGN-EVALUATION.",
        ),
    ] = None,
    batch: Annotated[
        str,
        typer.Option(
            metavar="BATCH",
            help="All runs of this batch (id, first digits of it, name, or latest).",
        ),
    ] = "",
    campaign: Annotated[
        str,
        typer.Option(
            metavar="CAMPAIGN",
            help="The runs of all failures of this campaign (id, first digits of it, name, or "
            "latest).",
        ),
    ] = "",
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write both traces of each run that diverges there."),
    ] = None,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
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

        batch = id_of(client, batch, IdKind.BATCH)
        campaign = id_of(client, campaign, IdKind.CAMPAIGN)
        chosen = choose_runs(
            client, ids_of(client, runs or (), IdKind.RUN), batch=batch, campaign=campaign
        )
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

    if not form.is_table:
        from drivora_service.shapes import adapter

        told = adapter(list[Replay]).dump_python(done, mode="json")
        form.print_content({"runs": told}, told, id_field="replay.id")
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
