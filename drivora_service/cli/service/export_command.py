"""``drivora export``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import ConfigurationOption, id_of, ids_of
from drivora_service.cli.service.table_files import TableFormat, save_tables
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.out_option import check_folder
from drivora_service.cli.terminal.output import find_entry
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.client import Client
    from drivora_service.studies.table_names import ResultTableName, TableForm


def export(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Write the tables there.")],
    batches: Annotated[
        list[str] | None,
        typer.Option(
            "--batch",
            metavar="BATCH",
            help="Runs of this batch (id, first digits of it, name, or latest); may be repeated.",
        ),
    ] = None,
    campaigns: Annotated[
        list[str] | None,
        typer.Option(
            "--campaign",
            metavar="CAMPAIGN",
            help="Runs of this campaign (id, first digits of it, name, or latest), or of those "
            "that a pattern of names fits; may be repeated.",
        ),
    ] = None,
    studies: Annotated[
        list[str] | None,
        typer.Option(
            "--study",
            metavar="STUDY",
            help="Runs of this study (id, first digits of it, name, or latest); may be repeated.",
        ),
    ] = None,
    agent: Annotated[str, typer.Option(metavar="NAME", help="Only runs of this agent.")] = "",
    configuration: ConfigurationOption = "",
    formats: Annotated[
        list[TableFormat] | None,
        typer.Option("--format", help="Format of the files [default: both]; may be repeated."),
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Writes runs, their verdicts, metrics and agents as tables: Parquet and CSV.

    Without a batch, campaign or study: all runs that are stored.
    """
    check_folder(out)
    with open_client(server, data_dir) as client:
        from drivora_service.store.runs.run_records import JobFilter
        from drivora_service.studies.table_names import ResultTableName

        if agent:
            _check_agent(client, agent)
        configuration_id = id_of(client, configuration, IdKind.CONFIGURATION)
        batch_ids = ids_of(client, batches or (), IdKind.BATCH)
        study_ids = ids_of(client, studies or (), IdKind.STUDY)

        def save(path: Path, table: ResultTableName, form: TableForm) -> None:
            client.save_result_table(
                path,
                table,
                batches=batch_ids,
                campaigns=campaigns or (),
                studies=study_ids,
                wanted=JobFilter(agent=agent, configuration_id=configuration_id),
                form=form,
            )

        chosen = tuple(dict.fromkeys(formats or TableFormat))
        save_tables(out, ResultTableName, save, formats=chosen)


def _check_agent(client: Client, agent: str) -> None:
    """Checks that an agent is known, or has driven a run.

    Raises:
        UnknownName: It is not.
    """
    from drivora_service.store.runs.run_records import JobFilter

    if client.run_counts(JobFilter(agent=agent)).total:
        return
    if any(campaign.agent == agent for campaign in client.campaigns()):
        return
    find_entry("agent", agent, client.agents().items)
