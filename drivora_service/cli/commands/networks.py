"""``drivora networks``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.catalogue_entries import entries_of_service
from drivora_service.cli.options import DataDirOption, ServerOption
from drivora_service.cli.output import JsonOption, print_json, print_table

if TYPE_CHECKING:
    from drivora_service.networks.road_network import RoadNetwork

app = typer.Typer(help="Road networks that scenarios may take place on.", no_args_is_help=True)


@app.command("list")
def list_networks(
    server: ServerOption = "", data_dir: DataDirOption = None, as_json: JsonOption = False
) -> None:
    """Lists the networks, shipped and imported."""
    if server:
        names = [network["name"] for network in entries_of_service(server, "/networks")]
    else:
        from drivora_service.cli.embedded import network_catalogue, settings_for

        names = list(network_catalogue(settings_for(data_dir)).names())
    if as_json:
        print_json(names)
    else:
        for name in names:
            typer.echo(name)


@app.command()
def show(
    name: Annotated[str, typer.Argument(help="A network of `drivora networks list`.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Describes a network."""
    if server:
        from drivora_service.cli.client import ServiceClient

        with ServiceClient(server) as client:
            facts = client.get(f"/networks/{name}")
    else:
        from drivora_service.cli.embedded import network_catalogue, settings_for

        facts = _facts(network_catalogue(settings_for(data_dir)).get(name))
    if as_json:
        print_json(facts)
    else:
        rows = ((key.replace("_", " "), _text(facts[key])) for key in facts)
        print_table("", ("fact", "value"), rows, wrap=("value",))


@app.command("import")
def import_network(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A .net.xml, .xodr or .osm file.")],
    name: Annotated[str, typer.Option(help="Name in the catalogue [default: the file's].")] = "",
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace an imported network of that name.")
    ] = False,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Imports a network for scenarios that are run here."""
    from drivora_service.cli.embedded import network_catalogue, settings_for
    from drivora_service.networks import importing

    settings = settings_for(data_dir)
    chosen = name or file.name.partition(".")[0]
    importing.import_network(file, chosen, settings.imported_networks_dir, replace=replace)
    facts = _facts(network_catalogue(settings).get(chosen))
    if as_json:
        print_json(facts)
    else:
        typer.echo(
            f"imported {chosen}: {facts['drivable_km']:.1f} km of lanes, "
            f"{facts['traffic_lights']} traffic lights"
        )


def _facts(network: RoadNetwork) -> dict[str, Any]:
    driven = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    return {
        "name": network.name,
        "sha256": network.sha256,
        "bounds": list(network.bounds),
        "net_offset": list(network.net_offset),
        "lanes": len(network.lanes),
        "drivable_km": round(sum(lane.length for lane in driven) / 1000.0, 3),
        "traffic_lights": len(network.programs),
        "has_sidewalks": any(lane.walkable and not lane.drivable for lane in network.lanes),
    }


def _text(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(f"{item:g}" for item in value)
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)
