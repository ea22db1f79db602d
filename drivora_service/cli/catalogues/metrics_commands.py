"""``drivora metrics``."""

from __future__ import annotations

from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.terminal.options import ServerOption
from drivora_service.cli.terminal.output import (
    JsonOption,
    find_entry,
    print_shape,
    print_table,
)

app = typer.Typer(
    help="The metrics of runs, and the objectives that searches minimise.", no_args_is_help=True
)


@app.command("list")
def list_metrics(server: ServerOption = "", as_json: JsonOption = False) -> None:
    """Lists all that the `feedback` of a campaign can name, and is better for the ADS if it is."""
    with open_client(server, None) as client:
        measures = client.describe_metrics().items
    if as_json:
        from drivora_service.oracles.oracle_descriptions import MeasureDescription

        print_shape(tuple[MeasureDescription, ...], measures)
        return
    print_table(
        "",
        ("name", "kind", "unit", "better", "of", "definition"),
        (
            (one.name, one.kind, one.unit, one.better, one.feedback or one.source, one.definition)
            for one in measures
        ),
        wrap=("of", "definition"),
    )


@app.command()
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a metric or objective.")],
    server: ServerOption = "",
    as_json: JsonOption = False,
) -> None:
    """Shows a metric or an objective."""
    with open_client(server, None) as client:
        measure = find_entry("metric", name, client.describe_metrics().items)
    if as_json:
        print_shape(type(measure), measure)
        return
    print(f"{measure.name}: {measure.definition}")
    for key in ("kind", "unit", "better", "feedback", "several_egos", "threshold", "source"):
        value = getattr(measure, key)
        if value:
            print(f"{key.replace('_', ' ').capitalize()}: {value}")
