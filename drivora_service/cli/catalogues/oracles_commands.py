"""``drivora oracles``."""

from __future__ import annotations

from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.terminal.options import ServerOption
from drivora_service.cli.terminal.output import (
    find_entry,
    print_table,
    say,
)
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.short_values import short_value

app = typer.Typer(help="The oracles that runs are judged by.", no_args_is_help=True)


@app.command("list")
@with_forms
def list_oracles(server: ServerOption = "", form: Form = TABLE) -> None:
    """Lists the oracles in the order of judging."""
    with open_client(server, None) as client:
        oracles = client.oracles().items
    if not form.is_table:
        form.print_content([one.model_dump(mode="json") for one in oracles])
        return
    print_table(
        "",
        ("name", "package", "usable", "description"),
        (
            (
                oracle.name,
                oracle.package or oracle.file or "built in",
                "yes" if oracle.installed else f"no: {oracle.reason}",
                oracle.description,
            )
            for oracle in oracles
        ),
        wrap=("usable", "description"),
    )


@app.command()
@with_forms
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of an oracle.")],
    server: ServerOption = "",
    form: Form = TABLE,
) -> None:
    """Shows an oracle with its thresholds."""
    with open_client(server, None) as client:
        oracle = find_entry("oracle", name, client.oracles().items)
    if not form.is_table:
        form.print_content(oracle.model_dump(mode="json"))
        return
    say(f"{oracle.name}: {oracle.description or oracle.reason}")
    if oracle.formula:
        say(f"Formula: {oracle.formula}\nSource: {oracle.source}")
    if oracle.thresholds:
        print_table(
            "",
            ("threshold", "value (SI units)"),
            ((key, short_value(value)) for key, value in oracle.thresholds.items()),
            wrap=("value (SI units)",),
        )
