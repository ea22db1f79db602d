"""``drivora schema``."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.output import fail, say
from drivora_service.errors import ConfigurationError


class Document(StrEnum):
    """Documents with a schema."""

    SCENARIO = "scenario"
    CAMPAIGN = "campaign"
    STUDY = "study"
    SUITE = "suite"
    GATE = "gate"
    LAWS = "laws"


def schema(
    document: Annotated[Document, typer.Argument(help="Document of the schema.")] = (
        Document.SCENARIO
    ),
    check: Annotated[
        bool, typer.Option("--check", help="Exit with 1 if a written schema is not current.")
    ] = False,
    write: Annotated[bool, typer.Option("--write", help="Write the schema files again.")] = False,
) -> None:
    """Prints the JSON Schema of the OpenScenario document, or of another document."""
    from drivora_service.campaigns.document import campaign_schema as campaign_schema
    from drivora_service.oracles.laws import law_schema as laws_schema
    from drivora_service.scenario import scenario_schema as scenario_schema
    from drivora_service.studies import study_schema as study_schema
    from drivora_service.suites import suite_schema as suite_schema

    if check and write:
        raise ConfigurationError("give one of --check and --write")
    schemas = {
        Document.SCENARIO: (scenario_schema.schema_text, scenario_schema.schema_path),
        Document.CAMPAIGN: (campaign_schema.schema_text, campaign_schema.schema_path),
        Document.STUDY: (study_schema.schema_text, study_schema.schema_path),
        Document.SUITE: (suite_schema.suite_schema_text, suite_schema.suite_schema_path),
        Document.GATE: (suite_schema.gate_schema_text, suite_schema.gate_schema_path),
        Document.LAWS: (laws_schema.schema_text, laws_schema.schema_path),
    }
    if not check and not write:
        text_of, _ = schemas[document]
        say(text_of(), ends_line=False)
        return
    stale = False
    for text_of, path_of in schemas.values():
        text, path = text_of(), path_of()
        if write:
            path.write_text(text)
            say(f"wrote {path.name}")
        elif path.is_file() and path.read_text() == text:
            say(f"{path.name} is current")
        else:
            fail(f"{path.name} is not current; `make schema` writes it again")
            stale = True
    if stale:
        raise typer.Exit(ExitCode.GATE_FAILED)
