"""``drivora campaign compare`` and ``drivora campaign report``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import CampaignArgument, id_of
from drivora_service.cli.terminal.options import (
    DataDirOption,
    EqualTimeOption,
    ServerOption,
    location,
)
from drivora_service.cli.terminal.out_option import check_file, check_folder, convert_write_errors
from drivora_service.cli.terminal.output import JsonOption, note, print_shape, write_text
from drivora_service.store.id_records import IdKind


def compare(
    wanted: Annotated[
        list[str],
        typer.Argument(
            metavar="CAMPAIGN…",
            help="Campaigns: ids, first digits of them, names, patterns of names such as "
            "'study-*', or latest.",
        ),
    ],
    baseline: Annotated[str, typer.Option(metavar="METHOD", help="Baseline method.")] = "random",
    measures: Annotated[
        list[str] | None,
        typer.Option("--measure", metavar="NAME", help="Measure; may be repeated [default: all]."),
    ] = None,
    equal_time: EqualTimeOption = False,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write tables (Markdown, CSV) and charts there."),
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compares methods by finished campaigns: effect sizes, p-values, tables, charts."""
    check_folder(out)
    with open_client(server, data_dir) as client:
        comparison = client.compare_campaigns(
            wanted,
            baseline=baseline,
            measures=tuple(dict.fromkeys(measures or ())),
            equal_time=equal_time,
        )
    if as_json:
        print_shape(type(comparison), comparison)
    else:
        from drivora_service.cli.campaigns.comparison_output import print_comparison

        print_comparison(comparison)
    if out is not None:
        from drivora_service.studies.comparison.campaign_comparison_files import write_comparison

        with convert_write_errors(out):
            written = write_comparison(comparison, out)
        for path in written:
            note(str(path))


def report(
    campaign: CampaignArgument,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Write it there, with a picture of each group in a folder beside it "
            "[default: print it].",
        ),
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Prints what a campaign searched and found, as Markdown.

    Pictures show road networks that are here too.
    """
    folder = None if out is None else out.with_name(f"{out.stem}-pictures")
    check_file(out)
    # With --server the data folder is for the road networks of pictures.
    with open_client(server, None if server else data_dir) as client:
        from drivora_service.cli.campaigns.campaign_reports import draw_report
        from drivora_service.cli.terminal.private_files import give_to_user

        campaign_id = id_of(client, campaign, IdKind.CAMPAIGN)
        is_new = folder is not None and not folder.exists()
        with convert_write_errors(folder):
            told = draw_report(client, campaign_id, data_dir, folder)
            for picture in told.pictures.values():
                give_to_user(picture)
                if is_new:
                    give_to_user(picture.parent)
    from drivora_service.studies.reports.campaign_report_text import report_markdown

    addresses = {n: f"{path.parent.name}/{path.name}" for n, path in told.pictures.items()}
    options = location(server, data_dir)
    write_text(report_markdown(told.report, pictures=addresses, options=options), out)
