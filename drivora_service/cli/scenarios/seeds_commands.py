"""``drivora seeds``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.scenarios.seeds_rate_command import rate
from drivora_service.cli.terminal.options import AgentParameterOption, DataDirOption
from drivora_service.cli.terminal.output import JsonOption, fail, note, print_json, say

app = typer.Typer(help="Seed scenarios: generated, imported, rated.", no_args_is_help=True)

OutOption = Annotated[Path, typer.Option(metavar="DIR", help="Folder to write to.")]


@app.command()
def generate(
    town: Annotated[str, typer.Option(help="Road network.")],
    num: Annotated[int, typer.Option(min=1, help="Scenarios wanted.")] = 10,
    min_length: Annotated[float, typer.Option(help="Shortest route, metres.")] = 50.0,
    max_length: Annotated[float, typer.Option(help="Longest route, metres.")] = 200.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random draws.")] = 0,
    agent: Annotated[str, typer.Option(help="Drives the egos.")] = "idm",
    agent_parameter: AgentParameterOption = None,
    out: OutOption = Path("scenario_datasets"),
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Generates scenarios of one ego on random routes: DIR/TOWN_0001.json and so on.

    Always terminates; if the network does not offer enough routes, exits with 3 and the reason.
    """
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.cli.application.installation import network_catalogue, settings_for
    from drivora_service.cli.scenarios.seed_agents import read_parameters_of, with_parameters
    from drivora_service.errors import ConfigurationError, InvalidDocument, NetworkError
    from drivora_service.scenario.documents import document_text
    from drivora_service.scenario.seed_generation import generate_seeds

    settings = settings_for(data_dir)
    network = network_catalogue(settings).get(town)
    agents = AgentCatalogue(folder=settings.agents_folder)
    agents.entry(agent)
    parameters = read_parameters_of(agents, agent, agent_parameter or ())
    try:
        seeds = generate_seeds(
            network,
            count=num,
            min_length=min_length,
            max_length=max_length,
            seed=seed,
            agent=agent,
        )
    except InvalidDocument as error:
        raise ConfigurationError(str(error)) from error
    out.mkdir(parents=True, exist_ok=True)
    written: list[str] = []
    short_of = ""
    try:
        for number, document in enumerate(seeds, start=1):
            path = out / f"{town}_{number:04d}.json"
            path.write_text(document_text(with_parameters(document, parameters)))
            written.append(str(path))
    except NetworkError as error:
        short_of = str(error)
    if as_json:
        print_json({"files": written, "wanted": num, "reason": short_of})
    else:
        say(f"{len(written)} scenarios in {out}")
    if short_of:
        fail(short_of)
        raise typer.Exit(ExitCode.NOT_DONE)


@app.command("import")
def import_seeds(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE…", help="Files of the original tool, Leaderboard routes."),
    ],
    agent: Annotated[str, typer.Option(help="Drives the egos.")] = "idm",
    out: OutOption = Path("scenario_datasets"),
    as_json: JsonOption = False,
) -> None:
    """Turns scenarios of other tools into OpenScenario documents: DIR/NAME.json."""
    from drivora_service.cli.scenarios.scenario_files import read_files
    from drivora_service.scenario.documents import document_text

    scenarios, unreadable = read_files(files, agent=agent)
    out.mkdir(parents=True, exist_ok=True)
    written: list[str] = []
    for scenario in scenarios:
        path = out / f"{scenario.name}.json"
        path.write_text(document_text(scenario.document))
        written.append(str(path))
        for remark in scenario.notes:
            note(f"{scenario.name}: {remark}")
    for file in unreadable:
        for problem in file.problems:
            fail(f"{file.path}: {problem.pointer or '/'}: {problem.message}")
    if as_json:
        print_json({"files": written, "unreadable": [str(file.path) for file in unreadable]})
    else:
        say(f"{len(written)} scenarios in {out}")
    if unreadable:
        raise typer.Exit(ExitCode.NOT_DONE)


app.command()(rate)
