"""``drivora runs``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.terminal.options import (
    ConfigurationOption,
    DataDirOption,
    ServerOption,
    location,
    parse_choice,
)
from drivora_service.cli.terminal.out_option import check_file
from drivora_service.cli.terminal.output import JsonOption, find_entry, print_shape, write_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from drivora_service.runs.run_report import RunStatus

app = typer.Typer(help="Runs that are stored.", no_args_is_help=True)

IdArgument = Annotated[str, typer.Argument(metavar="RUN", help="Id of a run.")]


@app.command("list")
def list_runs(
    batch: Annotated[str, typer.Option(metavar="ID", help="Of this batch.")] = "",
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
    as_json: JsonOption = False,
) -> None:
    """Lists runs, newest first."""
    with open_client(server, data_dir) as client:
        from drivora_service.cli.runs.run_output import print_runs
        from drivora_service.store.runs.run_records import JobFilter, RunSummary

        wanted = JobFilter(
            batch_id=batch,
            statuses=_statuses(status or ()),
            agent=agent,
            configuration_id=configuration,
            town=town,
            oracle=oracle,
            violated=violated,
        )
        runs = tuple(client.runs(wanted, limit=limit))
        if oracle and not runs:
            # Runs may have verdicts of an oracle that is not installed any more.
            find_entry("oracle", oracle, client.oracles().items)
    if as_json:
        print_shape(tuple[RunSummary, ...], runs)
    else:
        print_runs(runs)


@app.command()
def show(
    run_id: IdArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Shows a run with its verdicts."""
    with open_client(server, data_dir) as client:
        run = client.run(run_id)
    if as_json:
        print_shape(type(run), run)
    else:
        from drivora_service.cli.runs.run_output import ScenarioResult, print_result

        result = ScenarioResult(scenario=run.label or run.id, run=run)
        print_result(result, where=location(server, data_dir))


@app.command()
def scenario(
    run_id: IdArgument,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where to write it [default: print it].")
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Prints what a run has driven as a scenario, for `drivora run`."""
    check_file(out)
    with open_client(server, data_dir) as client:
        text = client.run_scenario(run_id)
    write_text(text, out)


def _statuses(names: Sequence[str]) -> frozenset[RunStatus]:
    from drivora_service.runs.run_report import RunStatus

    return frozenset(parse_choice(RunStatus, name, "--status") for name in names)
