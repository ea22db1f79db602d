"""``drivora campaign validate``."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import JsonOption, fail, note, print_json
from drivora_service.errors import InvalidDocument

if TYPE_CHECKING:
    from collections.abc import Iterator


def validate(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A campaign, as YAML or JSON.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Checks a campaign and names every problem with its place; nothing is run."""
    with open_client(server, data_dir) as client:
        import json

        from drivora_service.cli.campaigns.campaign_files import read_campaign_file

        with exit_on_problems(file):
            valid = client.validate_campaign(json.dumps(read_campaign_file(file)))
    if as_json:
        print_json(valid.model_dump(mode="json"))
        return
    for remark in valid.notes:
        note(f"note: {remark}")
    print(f"{file}: valid; {valid.tester} on {valid.town}, {valid.genes} genes")


@contextmanager
def exit_on_problems(file: Path) -> Iterator[None]:
    """Prints what is wrong with a campaign file, each problem with its place."""
    try:
        yield
    except InvalidDocument as error:
        fail(f"{file}: {len(error.problems)} problem(s)")
        for problem in error.problems:
            typer.echo(f"  {problem.pointer or '/'}: {problem.message}", err=True)
        raise typer.Exit(ExitCode.USAGE_ERROR) from error
