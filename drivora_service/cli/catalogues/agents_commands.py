"""``drivora agents``."""

from __future__ import annotations

from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.catalogues.benchmark_command import benchmark
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import (
    find_entry,
    note,
    print_table,
    say,
)
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.cli.terminal.parameter_output import print_parameters

app = typer.Typer(help="ADSs that can drive an ego.", no_args_is_help=True)
app.command()(benchmark)


@app.command("list")
@with_forms
def list_agents(
    server: ServerOption = "", data_dir: DataDirOption = None, form: Form = TABLE
) -> None:
    """Lists the agents."""
    with open_client(server, data_dir) as client:
        agents = client.agents().items
    if not form.is_table:
        form.print_content([one.model_dump(mode="json") for one in agents])
        return
    print_table(
        "",
        ("name", "kind", "usable", "licence", "source"),
        (
            (
                agent.name,
                agent.kind,
                "yes" if agent.installed else "no",
                agent.licence or "none stated",
                agent.source,
            )
            for agent in agents
        ),
        cut=("licence", "source"),
    )
    for agent in agents:
        if not agent.installed:
            say(f"{agent.name} cannot be used yet: {agent.reason}")
    say("Description and parameters of an agent: `drivora agents show NAME`")


@app.command()
@with_forms
def show(
    name: Annotated[str, typer.Argument(help="An agent of `drivora agents list`.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows an agent with its parameters."""
    with open_client(server, data_dir) as client:
        agent = find_entry("agent", name, client.agents().items)
    if not form.is_table:
        form.print_content(agent.model_dump(mode="json"))
        return
    say(f"{agent.name} ({agent.kind}): {agent.description}")
    say(f"From: {agent.source}. Licence: {agent.licence or 'none stated'}")
    say(f"Version: {agent.version or 'none stated'}")
    if agent.privileged:
        say("It sees everything, not only what the perception model lets through")
    if not agent.installed:
        say(f"It cannot be used yet: {agent.reason}")
    if agent.parameters is None:
        say("It does not say which parameters it takes: they are not checked before a run")
    elif agent.parameters:
        print_parameters(agent.parameters)
    else:
        say("It takes no parameters")


@app.command()
def install(
    name: Annotated[str, typer.Argument(help="An agent of `drivora agents list`.")],
    again: Annotated[
        bool, typer.Option("--again", help="Install it even if it is installed.")
    ] = False,
    data_dir: DataDirOption = None,
) -> None:
    """Fetches what an agent needs: an environment of its own, or files of other packages."""
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.cli.application.installation import settings_for

    settings = settings_for(data_dir)
    catalogue = AgentCatalogue(folder=settings.agents_folder)
    entry = catalogue.entry(name)
    note(f"{entry.name}: {entry.source}; licence: {entry.licence or 'none stated'}")
    done = catalogue.install(name, again=again)
    reason = catalogue.entry(name).reason
    if reason:
        note(f"{name} still cannot be used: {reason}")
    elif done:
        say(f"installed {name} in {settings.agents_folder}")
    else:
        say(f"{name} needs nothing more to be installed")
