"""``drivora testers``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.catalogue_entries import entries_of_service, entry_named
from drivora_service.cli.options import ServerOption
from drivora_service.cli.output import JsonOption, print_json, print_table
from drivora_service.cli.parameters import parameter_contents, print_parameters
from drivora_service.errors import SearchError

if TYPE_CHECKING:
    from drivora_service.search.catalogue import TesterCatalogue

app = typer.Typer(help="The methods that can search for failures.", no_args_is_help=True)


@app.command("list")
def list_testers(server: ServerOption = "", as_json: JsonOption = False) -> None:
    """Lists the testers."""
    testers = _testers(server)
    if as_json:
        print_json(testers)
        return
    print_table(
        "",
        ("name", "method", "in generations", "usable", "description"),
        (
            (
                tester["name"],
                tester["title"],
                "yes" if tester["generational"] else "no",
                "yes" if tester["installed"] else f"no: {tester['reason']}",
                tester["description"],
            )
            for tester in testers
        ),
        wrap=("usable", "description"),
    )


@app.command()
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a tester.")],
    server: ServerOption = "",
    as_json: JsonOption = False,
) -> None:
    """Shows a tester with its parameters."""
    tester = entry_named("tester", name, _testers(server))
    if as_json:
        print_json(tester)
        return
    print(f"{tester['title']} ({tester['name']}): {tester['description']}")
    print(f"Source: {tester['source']}. Measured by: {tester['feedback']}")
    print_parameters(tester["parameters"])


def _testers(server: str) -> list[dict[str, Any]]:
    if server:
        return entries_of_service(server, "/testers")
    from drivora_service.search.catalogue import TesterCatalogue

    catalogue = TesterCatalogue()
    return [_tester(catalogue, name) for name in catalogue.names()]


def _tester(catalogue: TesterCatalogue, name: str) -> dict[str, Any]:
    """Returns the printed form of a tester, which is that of the HTTP API."""
    from drivora_service.parameters import describe_parameters

    try:
        plugin = catalogue.plugin(name)
    except SearchError as error:
        return {
            "name": name,
            "title": name,
            "description": "",
            "source": "",
            "generational": False,
            "feedback": "",
            "parameters": [],
            "installed": False,
            "reason": str(error),
        }
    return {
        "name": plugin.name,
        "title": plugin.title,
        "description": plugin.description,
        "source": plugin.source,
        "generational": plugin.is_generational,
        "feedback": plugin.feedback.name,
        "parameters": parameter_contents(describe_parameters(plugin.parameters)),
        "installed": True,
        "reason": "",
    }
