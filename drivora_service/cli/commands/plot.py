"""``drivora plot``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.options import DataDirOption, ServerOption
from drivora_service.cli.output import JsonOption, print_json
from drivora_service.errors import ConfigurationError

if TYPE_CHECKING:
    from drivora_service.settings import Settings


class ColorBy(StrEnum):
    """What the colour of the egos' trails says."""

    ACTOR = "actor"
    TIME = "time"


def plot(
    run: Annotated[
        str,
        typer.Argument(metavar="RUN|TRACE", help="Id of a run, or a trace file (.parquet)."),
    ],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Picture, .svg or .png [default: RUN.svg]."),
    ] = None,
    color_by: Annotated[
        ColorBy, typer.Option(help="What the colour of the egos' trails says.")
    ] = ColorBy.ACTOR,
    rule: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Mark violations of this rule only; may be repeated."),
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
    """Draws a run from above: roads, trails, signals, and where each verdict fell."""
    from drivora_service.cli.drawing import draw_trace
    from drivora_service.cli.embedded import settings_for

    settings = settings_for(data_dir)
    target = out or Path(f"{Path(run).name.partition('.')[0]}.svg")
    if target.suffix.lower() not in (".svg", ".png"):
        raise ConfigurationError(f"a picture is .svg or .png, not {target.name!r}")
    if moments is not None and color_by is ColorBy.TIME:
        raise ConfigurationError(
            "--color-by time colours the trails of a whole run: leave it out with --moments"
        )
    path = _downloaded(server, run, target) if server else _trace_path(run, settings)
    try:
        draw_trace(
            path, settings, target, color_by=color_by.value, rules=rule or (), moments=moments
        )
    finally:
        if server:
            path.unlink()
    if as_json:
        print_json({"picture": str(target)})
    else:
        typer.echo(str(target))


def _trace_path(run: str, settings: Settings) -> Path:
    path = Path(run)
    if path.suffix == ".parquet" and path.is_file():
        return path
    from drivora_service.store.database import open_database
    from drivora_service.store.traces import TraceFolder

    database = open_database(settings.resolved_database_url)
    try:
        with database.read() as transaction:
            record = transaction.jobs.get(run)
    finally:
        database.close()
    return TraceFolder(settings.traces_dir).path(record.id)


def _downloaded(server: str, run: str, target: Path) -> Path:
    from drivora_service.cli.client import ServiceClient

    with ServiceClient(server) as client:
        content = client.download(
            f"/runs/{run}/observations", accept="application/vnd.apache.parquet"
        )
    target.parent.mkdir(parents=True, exist_ok=True)
    path = target.with_suffix(".trace.tmp")
    path.write_bytes(content)
    return path
