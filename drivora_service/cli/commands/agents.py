"""``drivora agents``."""

from __future__ import annotations

import typer

from drivora_service.cli.options import ServerOption
from drivora_service.cli.output import JsonOption, print_json, print_table

app = typer.Typer(help="The ADSs that can drive an ego.", no_args_is_help=True)


@app.command("list")
def list_agents(server: ServerOption = "", as_json: JsonOption = False) -> None:
    """Lists the agents."""
    if server:
        from drivora_service.cli.client import ServiceClient

        with ServiceClient(server) as client:
            agents = client.get("/agents")["items"]
    else:
        from dataclasses import asdict

        from drivora_service.agents.catalogue import AgentCatalogue

        agents = [asdict(entry) for entry in AgentCatalogue().entries()]
    if as_json:
        print_json(agents)
        return
    print_table(
        "",
        ("name", "kind", "usable", "licence", "description"),
        (
            (
                agent["name"],
                agent["kind"],
                "yes" if agent["installed"] else f"no: {agent['reason']}",
                agent["licence"],
                agent["description"],
            )
            for agent in agents
        ),
    )
