"""``drivora plot``."""

from __future__ import annotations

import tempfile
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import id_of
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import JsonOption, print_json, say
from drivora_service.errors import ConfigurationError
from drivora_service.store.id_records import IdKind


class ColorBy(StrEnum):
    """Meaning of the colours of the egos' trails."""

    ACTOR = "actor"
    TIME = "time"


def plot(
    run: Annotated[
        str,
        typer.Argument(
            metavar="RUN|TRACE",
            help="A run (id, first digits of it, name, or latest), CAMPAIGN-EVALUATION, or a "
            "trace file (.parquet).",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Picture, .svg or .png [default: RUN.svg]."),
    ] = None,
    color_by: Annotated[
        ColorBy, typer.Option(help="Meaning of the colours of the egos' trails.")
    ] = ColorBy.ACTOR,
    oracle: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Mark violations of this oracle only; may be repeated."),
    ] = None,
    moments: Annotated[
        int | None,
        typer.Option(
            min=2,
            max=12,
            help="Draw a strip of so many moments that lead to the gravest violation, around its "
            "ego, rather than the whole run.",
        ),
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Draws a run from above: roads, trails, signals, and the place of each violation."""
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.cli.terminal.out_option import check_file
    from drivora_service.cli.terminal.trace_drawing import draw_trace

    settings = settings_for(data_dir)
    if out is not None and out.suffix.lower() not in (".svg", ".png"):
        raise ConfigurationError(f"a picture is .svg or .png, not {out.name!r}")
    if moments is not None and color_by is ColorBy.TIME:
        raise ConfigurationError(
            "--color-by time colours the trails of a whole run: leave it out with --moments"
        )

    check_file(out)

    def draw(trace: Path, name: str) -> Path:
        target = out or Path(f"{name}.svg")
        check_file(target)
        draw_trace(
            trace, settings, target, color_by=color_by.value, oracles=oracle or (), moments=moments
        )
        return target

    trace = Path(run)
    if trace.suffix == ".parquet" and trace.is_file():
        target = draw(trace, trace.name.partition(".")[0])
    elif trace.suffix == ".parquet":
        raise ConfigurationError(f"no such file: {run}")
    elif "/" in run:
        raise ConfigurationError(
            f"{run}: neither a trace file (.parquet) nor a run; `drivora runs list` shows the runs"
        )
    else:
        with (
            # With --server the data folder is for imported networks.
            open_client(server, None if server else data_dir) as client,
            tempfile.TemporaryDirectory(prefix="drivora-") as scratch,
        ):
            trace = Path(scratch) / "run.trace.parquet"
            run_id = id_of(client, run, IdKind.RUN)
            client.save_run_observations(trace, run_id)
            target = draw(trace, run_id)
    if as_json:
        print_json({"picture": str(target)})
    else:
        say(str(target))
