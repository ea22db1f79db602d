"""``drivora batches``."""

from __future__ import annotations

from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import BatchArgument, id_of
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.store.id_records import IdKind

app = typer.Typer(help="Batches: runs that were started together.", no_args_is_help=True)


@app.command("list")
@with_forms
def list_batches(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="How many.")] = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Lists batches, newest first."""
    with open_client(server, data_dir) as client:
        from drivora_service.api.schemas.batches import Batch

        batches = tuple(client.batches(limit=limit))
    if form.is_table:
        from drivora_service.cli.batches.batch_tables import print_batches

        print_batches(batches)
    else:
        form.print_shape(tuple[Batch, ...], batches)


@app.command()
@with_forms
def show(
    batch: BatchArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows how far a batch is, and how many of its runs have failures."""
    with open_client(server, data_dir) as client:
        found = client.batch(id_of(client, batch, IdKind.BATCH))
    if form.is_table:
        from drivora_service.cli.batches.batch_tables import print_batch

        print_batch(found)
    else:
        form.print_shape(type(found), found)
