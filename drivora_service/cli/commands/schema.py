"""``drivora schema``."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.output import fail
from drivora_service.errors import ConfigurationError


class Document(StrEnum):
    """Documents with a schema."""

    SCENARIO = "scenario"
    CAMPAIGN = "campaign"
    STUDY = "study"


def schema(
    document: Annotated[Document, typer.Argument(help="Document of the schema.")] = (
        Document.SCENARIO
    ),
    check: Annotated[
        bool, typer.Option("--check", help="Exit with 1 if a written schema is not current.")
    ] = False,
    write: Annotated[bool, typer.Option("--write", help="Write the schema files again.")] = False,
) -> None:
    """Prints the JSON Schema of the OpenScenario document, of the campaign or of the study."""
    from drivora_service.campaigns import schema as campaign_schema
    from drivora_service.scenario import schema as scenario_schema
    from drivora_service.studies import schema as study_schema

    if check and write:
        raise ConfigurationError("give one of --check and --write")
    schemas = {
        Document.SCENARIO: scenario_schema,
        Document.CAMPAIGN: campaign_schema,
        Document.STUDY: study_schema,
    }
    if not check and not write:
        typer.echo(schemas[document].schema_text(), nl=False)
        return
    stale = False
    for module in schemas.values():
        text, path = module.schema_text(), module.schema_path()
        if write:
            path.write_text(text)
            typer.echo(f"wrote {path.name}")
        elif path.is_file() and path.read_text() == text:
            typer.echo(f"{path.name} is current")
        else:
            fail(f"{path.name} is not current; `make schema` writes it again")
            stale = True
    if stale:
        raise typer.Exit(ExitCode.GATE_FAILED)
