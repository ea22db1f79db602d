"""``drivora testers``."""

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
from drivora_service.cli.terminal.parameter_output import print_parameters

app = typer.Typer(help="The methods that can search for failures.", no_args_is_help=True)


@app.command("list")
@with_forms
def list_testers(server: ServerOption = "", form: Form = TABLE) -> None:
    """Lists the testers."""
    with open_client(server, None) as client:
        testers = client.testers().items
    if not form.is_table:
        form.print_content([one.model_dump(mode="json") for one in testers])
        return
    print_table(
        "",
        ("name", "method", "in generations", "usable", "description"),
        (
            (
                tester.name,
                tester.title,
                "yes" if tester.generational else "no",
                "yes" if tester.installed else f"no: {tester.reason}",
                tester.description,
            )
            for tester in testers
        ),
        wrap=("usable", "description"),
    )


@app.command()
@with_forms
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a tester.")],
    server: ServerOption = "",
    form: Form = TABLE,
) -> None:
    """Shows a tester with its parameters."""
    with open_client(server, None) as client:
        tester = find_entry("tester", name, client.testers().items)
    if not form.is_table:
        form.print_content(tester.model_dump(mode="json"))
        return
    if not tester.installed:
        say(f"{tester.name} cannot be used: {tester.reason}")
        return
    say(f"{tester.title} ({tester.name}): {tester.description}")
    say(f"Source: {tester.source}. Measured by: {tester.feedback}")
    print_parameters(tester.parameters)
