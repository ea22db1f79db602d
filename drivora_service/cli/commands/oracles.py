"""``drivora oracles``."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from drivora_service.cli.catalogue_entries import entries_of_service, entry_named
from drivora_service.cli.options import ServerOption
from drivora_service.cli.output import JsonOption, print_json, print_table

app = typer.Typer(help="The rules that runs are judged by.", no_args_is_help=True)


@app.command("list")
def list_oracles(server: ServerOption = "", as_json: JsonOption = False) -> None:
    """Lists the oracles in the order of judging."""
    oracles = _oracles(server)
    if as_json:
        print_json(oracles)
        return
    print_table(
        "",
        ("name", "package", "usable", "description"),
        (
            (
                oracle["name"],
                oracle["package"] or "built in",
                "yes" if oracle["installed"] else f"no: {oracle['reason']}",
                oracle["description"],
            )
            for oracle in oracles
        ),
        wrap=("usable", "description"),
    )


@app.command()
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of an oracle.")],
    server: ServerOption = "",
    as_json: JsonOption = False,
) -> None:
    """Shows an oracle with its thresholds."""
    oracle = entry_named("oracle", name, _oracles(server))
    if as_json:
        print_json(oracle)
        return
    print(f"{oracle['name']}: {oracle['description'] or oracle['reason']}")
    if oracle["thresholds"]:
        print_table(
            "",
            ("threshold", "value (SI units)"),
            ((key, json.dumps(value)) for key, value in oracle["thresholds"].items()),
            wrap=("value (SI units)",),
        )


def _oracles(server: str) -> list[dict[str, Any]]:
    if server:
        return entries_of_service(server, "/oracles")
    from drivora_service.oracles.catalogue import OracleCatalogue

    catalogue = OracleCatalogue()
    # The printed form is that of the HTTP API.
    return [
        {
            "name": entry.name,
            "description": entry.description,
            "thresholds": dict(entry.thresholds),
            "package": entry.package,
            "installed": not entry.reason,
            "reason": entry.reason,
        }
        for entry in map(catalogue.entry, catalogue.names())
    ]
