"""``drivora networks``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import JsonOption, print_json, print_table, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms

app = typer.Typer(help="Road networks that scenarios may take place on.", no_args_is_help=True)


@app.command("list")
@with_forms
def list_networks(
    server: ServerOption = "", data_dir: DataDirOption = None, form: Form = TABLE
) -> None:
    """Lists the networks, shipped and imported."""
    with open_client(server, data_dir) as client:
        networks = client.networks().items
    if not form.is_table:
        form.print_content([one.model_dump(mode="json") for one in networks])
    else:
        for network in networks:
            say(network.name)


_UNITS = {"bounds": "bounds (m)", "net_offset": "net offset (m)", "drivable_km": "drivable (km)"}
"""Names of facts with their units."""


@app.command()
@with_forms
def show(
    name: Annotated[str, typer.Argument(help="A network of `drivora networks list`.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Describes a network."""
    with open_client(server, data_dir) as client:
        facts = client.network(name).model_dump(mode="json")
    if not form.is_table:
        form.print_content(facts)
    else:
        rows = ((_UNITS.get(key, key).replace("_", " "), _text(facts[key])) for key in facts)
        print_table("", ("fact", "value"), rows, wrap=("value",))


@app.command("import")
def import_network(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A .net.xml, .xodr or .osm file.")],
    name: Annotated[str, typer.Option(help="Name in the catalogue [default: the file's].")] = "",
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace an imported network of that name.")
    ] = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Imports a network for scenarios that are run here, or on a service."""
    chosen = name or file.name.partition(".")[0]
    if not server:
        _import_here(file, chosen, data_dir, replace=replace)
    with open_client(server, data_dir) as client:
        network = (
            client.import_network(file, chosen, replace=replace)
            if server
            else client.network(chosen)
        )
    if as_json:
        print_json(network.model_dump(mode="json"))
    else:
        say(
            f"imported {chosen}: {network.drivable_km:.1f} km of lanes, "
            f"{network.traffic_lights} traffic lights"
        )


def _import_here(file: Path, name: str, data_dir: Path | None, *, replace: bool) -> None:
    """Imports a network into the data folder; its user is trusted with larger files."""
    from drivora_service.cli.application.installation import settings_for
    from drivora_service.cli.terminal.private_files import private_files
    from drivora_service.networks.importing.network_importing import import_network

    folder = settings_for(data_dir).imported_networks_dir
    with private_files():
        import_network(file, name, folder, replace=replace)


def _text(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(f"{item:g}" for item in value)
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)
