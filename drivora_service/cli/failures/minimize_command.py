"""``drivora minimize``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import RunArgument, id_of
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.interruption import say_interrupted
from drivora_service.cli.terminal.options import DataDirOption, ServerOption, WorkersOption
from drivora_service.cli.terminal.out_option import check_file, check_folder
from drivora_service.cli.terminal.output import fail, note
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.errors import RequestConflict
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.api.schemas.minimizations import Minimization
    from drivora_service.client import Client


@with_forms
def minimize(
    run: RunArgument,
    oracle: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Oracle whose violation is followed [default: that of the gravest violation].",
        ),
    ] = "",
    budget: Annotated[
        int | None,
        typer.Option(
            min=1, max=100_000, help="Simulations that the search may need [default: 500]."
        ),
    ] = None,
    radius: Annotated[
        float | None,
        typer.Option(
            min=0.001,
            metavar="METRES",
            help="Distance within which a violation is at the same place [default: 10].",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE|DIR",
            help="Write the smallest scenario there (.json); into a folder also the report, and a "
            "picture of both runs side by side.",
        ),
    ] = None,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Searches the smallest scenario that fails in the same way as a run that fails.

    The same way: the same oracle, ego, responsibility and avoidability, at the same place. Exits
    with 1 if the budget ended before all single reductions were tried without success, and with
    3 if the failure does not come again. After an interrupt the same command goes on where it was.
    """
    is_file = out is not None and out.suffix == ".json"
    (check_file if is_file else check_folder)(out)
    with open_client(server, data_dir, works=True, workers=workers) as client:
        minimization = _run_minimization(
            client,
            id_of(client, run, IdKind.RUN),
            oracle=oracle,
            budget=budget,
            radius=radius,
            is_on_service=bool(server),
        )
        if out is not None and minimization.document is not None:
            from drivora_service.cli.failures.minimization_files import write_document, write_folder

            if is_file:
                write_document(minimization, out)
            else:
                write_folder(client, minimization, out, data_dir=None if server else data_dir)
    _show(minimization, form)


def _run_minimization(
    client: Client,
    run: str,
    *,
    oracle: str,
    budget: int | None,
    radius: float | None,
    is_on_service: bool,
) -> Minimization:
    """Starts a minimisation, follows it to its end, and returns it."""
    from drivora_service.cli.failures.minimization_output import minimization_display

    try:
        minimization = client.minimize(run, oracle=oracle, radius_m=radius, budget=budget)
    except RequestConflict as error:
        fail(str(error))
        raise typer.Exit(ExitCode.USAGE_ERROR) from error
    note(f"minimisation {minimization.id}")
    try:
        with minimization_display(minimization) as show:
            return client.wait_for_minimization(minimization.id, on_progress=show)
    except KeyboardInterrupt as error:
        say_interrupted(
            "the service continues it"
            if is_on_service
            else "its simulations are kept; the same command goes on where it was"
        )
        raise typer.Exit(ExitCode.INTERRUPTED) from error


def _show(minimization: Minimization, form: Form) -> None:
    from drivora_service.cli.failures.minimization_output import print_minimization
    from drivora_service.store.minimizations.minimization_records import MinimizationState

    if not form.is_table:
        form.print_shape(type(minimization), minimization)
    elif minimization.before is not None:
        print_minimization(minimization)
    if minimization.state is not MinimizationState.FINISHED:
        fail(minimization.message or f"the minimisation is {minimization.state}")
        raise typer.Exit(ExitCode.NOT_DONE)
    if not minimization.one_minimal:
        note("the budget ended before every single reduction was tried; raise --budget")
        raise typer.Exit(ExitCode.NOT_MINIMAL)
