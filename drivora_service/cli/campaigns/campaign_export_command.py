"""``drivora campaign export``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import ids_of
from drivora_service.cli.terminal.options import DataDirOption, ServerOption, parse_counts
from drivora_service.cli.terminal.out_option import check_folder, convert_write_errors
from drivora_service.cli.terminal.output import JsonOption, note, print_json, say
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.suites.suite_exporting import FoundScenario


class Each(StrEnum):
    """The failures of which one is taken."""

    KIND = "kind"
    GROUP = "group"
    FAILURE = "failure"


def export(
    campaigns: Annotated[
        list[str],
        typer.Argument(
            metavar="CAMPAIGN…", help="Campaigns (id, first digits of it, name, or latest)."
        ),
    ],
    suite: Annotated[
        Path,
        typer.Option("--suite", metavar="DIR", help="Folder of the suite; made if it is missing."),
    ],
    each: Annotated[
        Each, typer.Option(help="Take the first failure of each kind or group, or every one.")
    ] = Each.GROUP,
    counts: Annotated[
        str | None,
        typer.Option(
            metavar="WORD",
            help="Take, and count in the scenarios, only these failures: accountable, preventable, "
            "at_fault, possibly_at_fault or any [default: as the campaign counts].",
        ),
    ] = None,
    most: Annotated[
        int | None, typer.Option(min=1, help="Most scenarios that are added [default: all].")
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Adds the scenarios of found failures to a suite, which has none twice."""
    counted = parse_counts(counts)
    check_folder(suite)
    with open_client(server, data_dir) as client:
        from drivora_service.cli.campaigns.campaign_scenarios import find_failure_scenarios
        from drivora_service.cli.suites.suite_files import describe_missing_oracles
        from drivora_service.suites.suite_exporting import export_scenarios

        ids = ids_of(client, campaigns, IdKind.CAMPAIGN)
        known = {oracle.name for oracle in client.oracles().items}
        counted_by: dict[str, None] = {}
        found = find_failure_scenarios(client, ids, each=each, counted=counted, most=most)
        with convert_write_errors(suite):
            done = export_scenarios(suite, _watch(found, counted_by), name=suite.resolve().name)
    for remark in describe_missing_oracles(name for name in counted_by if name not in known):
        note(remark)
    if done.kept:
        note(
            f"note: {len(done.kept)} of the scenarios that were there already count other failures "
            f"than these do, and stay as they are, such as {done.kept[0]}. To change them, set "
            "`counts` and `oracles` in their files (under `drivora:suite` of `extensions`), or "
            "export to another folder"
        )
    if as_json:
        print_json(
            {
                "suite": str(done.suite_file),
                "added": [str(path) for path in done.added],
                "known": done.known,
                "kept": [str(path) for path in done.kept],
            }
        )
        return
    for path in done.added:
        say(str(path))
    if done.is_new:
        note(f"{done.suite_file} is new")
    note(f"{len(done.added)} scenarios added to {suite}, {done.known} were there already")


def _watch(found: Iterable[FoundScenario], counted_by: dict[str, None]) -> Iterator[FoundScenario]:
    """Yields scenarios, and adds the oracles that count in them to a dictionary."""
    for one in found:
        counted_by.update(dict.fromkeys(one.definition.oracles or ()))
        yield one
