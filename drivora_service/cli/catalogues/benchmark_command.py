"""``drivora agents benchmark``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption, ServerOption, WorkersOption
from drivora_service.cli.terminal.out_option import check_folder, convert_write_errors
from drivora_service.cli.terminal.output import JsonOption, fail, note, print_json
from drivora_service.cli.terminal.run_progress import run_progress

_MOST_RUNS = 100


def benchmark(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME…", help="Agents of `drivora agents list` [default: all of them]."
        ),
    ] = None,
    runs: Annotated[
        int | None,
        typer.Option(
            min=1, max=_MOST_RUNS, help="Scenarios on each of three networks [default: 10]."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write a table, a card and a picture of each there."),
    ] = None,
    workers: WorkersOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Runs agents in the same fixed scenarios and prints the card of each.

    An agent that is not installed is listed with the reason. Runs that an agent fails are part of
    its card; exits with 3 if any failed for another reason.
    """
    check_folder(out)
    with open_client(server, data_dir, works=True, makes_data=True, workers=workers) as client:
        from drivora_service.benchmarking.card_courses import RUNS, benchmark_scenarios
        from drivora_service.benchmarking.card_files import cards_content, write_cards
        from drivora_service.cli.application.installation import network_catalogue, settings_for
        from drivora_service.cli.catalogues import card_runs

        settings = settings_for(data_dir)
        number = RUNS if runs is None else runs
        entered = card_runs.find_entrants(client, names or ())
        scenarios = (
            [*benchmark_scenarios(network_catalogue(settings), number)] if entered.present else []
        )
        with run_progress([one.name for one in entered.present], total=len(scenarios)) as count:
            cards = card_runs.benchmark(
                client, entered.present, scenarios, on_run=lambda agent: count(agent.name)
            )
        pictures = {}
        if out is not None:
            pictures = card_runs.draw_cards(client, cards, out, settings)
    if as_json:
        print_json(cards_content(cards, entered.absent, runs=number))
    else:
        card_runs.print_cards(cards, entered.absent)
    if out is not None:
        with convert_write_errors(out):
            written = write_cards(cards, entered.absent, out, runs=number, pictures=pictures)
        for path in (*written, *pictures.values()):
            note(str(path))
    not_done = sum(card.failed_otherwise for card in cards)
    if not_done:
        fail(f"{not_done} run(s) could not be done, for reasons that are not the agents'")
        raise typer.Exit(ExitCode.NOT_DONE)
