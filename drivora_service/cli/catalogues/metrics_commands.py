"""``drivora metrics``."""

from __future__ import annotations

from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.terminal.options import ServerOption
from drivora_service.cli.terminal.output import find_entry, print_table, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms

app = typer.Typer(
    help="The metrics of runs, and the objectives that searches minimise.", no_args_is_help=True
)


@app.command("list")
@with_forms
def list_metrics(server: ServerOption = "", form: Form = TABLE) -> None:
    """Lists all that the `feedback` of a campaign can name, and is better for the ADS if it is."""
    with open_client(server, None) as client:
        measures = client.describe_metrics().items
    if not form.is_table:
        from drivora_service.oracles.oracle_descriptions import MeasureDescription

        form.print_shape(tuple[MeasureDescription, ...], measures, id_field="name")
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
@with_forms
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a metric or objective.")],
    server: ServerOption = "",
    form: Form = TABLE,
) -> None:
    """Shows a metric or an objective."""
    with open_client(server, None) as client:
        measure = find_entry("metric", name, client.describe_metrics().items)
    if not form.is_table:
        form.print_shape(type(measure), measure, id_field="name")
        return
    say(f"{measure.name}: {measure.definition}")
    for key in ("kind", "unit", "better", "feedback", "several_egos", "threshold", "source"):
        value = getattr(measure, key)
        if value:
            say(f"{key.replace('_', ' ').capitalize()}: {value}")
