"""``drivora schema``."""

from __future__ import annotations

from typing import Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.output import fail
from drivora_service.errors import ConfigurationError


def schema(
    check: Annotated[
        bool, typer.Option("--check", help="Exit with 1 if the written schema is not current.")
    ] = False,
    write: Annotated[bool, typer.Option("--write", help="Write the schema file again.")] = False,
) -> None:
    """Prints the JSON Schema of the OpenScenario document."""
    from drivora_service.scenario.schema import schema_path, schema_text

    if check and write:
        raise ConfigurationError("give one of --check and --write")
    text, path = schema_text(), schema_path()
    if check:
        if not path.is_file() or path.read_text() != text:
            fail(f"{path.name} is not current; `make schema` writes it again")
            raise typer.Exit(ExitCode.GATE_FAILED)
        typer.echo(f"{path.name} is current")
    elif write:
        path.write_text(text)
        typer.echo(f"wrote {path.name}")
    else:
        typer.echo(text, nl=False)
