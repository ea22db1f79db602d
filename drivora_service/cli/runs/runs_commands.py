"""``drivora runs``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import (
    BatchOption,
    ConfigurationOption,
    RunArgument,
    id_of,
)
from drivora_service.cli.terminal.options import (
    DataDirOption,
    ServerOption,
    location,
    parse_choice,
)
from drivora_service.cli.terminal.out_option import check_file
from drivora_service.cli.terminal.output import find_entry, write_text
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from drivora_service.runs.run_report import RunStatus

app = typer.Typer(help="Runs that are stored.", no_args_is_help=True)


@app.command("list")
@with_forms
def list_runs(
    batch: BatchOption = "",
    status: Annotated[
        list[str] | None,
        typer.Option(metavar="STATUS", help="With this status; may be repeated."),
    ] = None,
    agent: Annotated[str, typer.Option(metavar="NAME", help="Driven by this agent.")] = "",
    configuration: ConfigurationOption = "",
    town: Annotated[str, typer.Option(metavar="NAME", help="On this road network.")] = "",
    oracle: Annotated[str, typer.Option(metavar="NAME", help="That violated this oracle.")] = "",
    violated: Annotated[
        bool | None,
        typer.Option("--violated/--clean", help="With, or without, any violation."),
    ] = None,
    limit: Annotated[int, typer.Option(min=1, max=10_000, help="How many.")] = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Lists runs, newest first."""
    with open_client(server, data_dir) as client:
        from drivora_service.cli.runs.run_output import print_runs
        from drivora_service.store.runs.run_records import JobFilter, RunSummary

        wanted = JobFilter(
            batch_id=id_of(client, batch, IdKind.BATCH),
            statuses=_statuses(status or ()),
            agent=agent,
            configuration_id=id_of(client, configuration, IdKind.CONFIGURATION),
            town=town,
            oracle=oracle,
            violated=violated,
        )
        runs = tuple(client.runs(wanted, limit=limit))
        if oracle and not runs:
            # Runs may have verdicts of an oracle that is not installed any more.
            find_entry("oracle", oracle, client.oracles().items)
    if form.is_table:
        print_runs(runs)
    else:
        form.print_shape(tuple[RunSummary, ...], runs)


@app.command()
@with_forms
def show(
    run: RunArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows a run with its verdicts."""
    with open_client(server, data_dir) as client:
        found = client.run(id_of(client, run, IdKind.RUN))
    if not form.is_table:
        form.print_shape(type(found), found)
        return
    from drivora_service.cli.runs.run_output import ScenarioResult, print_result

    result = ScenarioResult(scenario=found.label or found.id, run=found)
    print_result(result, where=location(server, data_dir))


@app.command()
def scenario(
    run: RunArgument,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where to write it [default: print it].")
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Prints what a run has driven as a scenario, for `drivora run`."""
    check_file(out)
    with open_client(server, data_dir) as client:
        text = client.run_scenario(id_of(client, run, IdKind.RUN))
    write_text(text, out)


def _statuses(names: Sequence[str]) -> frozenset[RunStatus]:
    from drivora_service.runs.run_report import RunStatus

    return frozenset(parse_choice(RunStatus, name, "--status") for name in names)
