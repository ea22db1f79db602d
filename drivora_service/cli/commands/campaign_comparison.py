"""``drivora campaign compare`` and ``drivora campaign report``."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.options import DataDirOption, ServerOption
from drivora_service.cli.output import JsonOption, note, print_json

if TYPE_CHECKING:
    from drivora_service.studies.comparing import Comparison


def compare(
    wanted: Annotated[
        list[str],
        typer.Argument(
            metavar="ID|NAME…", help="Ids or names of campaigns, or patterns such as 'study-*'."
        ),
    ],
    baseline: Annotated[
        str, typer.Option(metavar="METHOD", help="Whom the others are compared with.")
    ] = "random",
    measures: Annotated[
        list[str] | None,
        typer.Option("--measure", metavar="NAME", help="By what; may be repeated [default: all]."),
    ] = None,
    equal_time: Annotated[
        bool,
        typer.Option(
            "--equal-time",
            help="Count what each had done after the time that the shortest one took.",
        ),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write tables (Markdown, CSV) and charts there."),
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compares methods by finished campaigns: effect sizes, p-values, tables, charts."""
    from drivora_service.cli.campaign_comparison import print_comparison
    from drivora_service.shapes import adapter

    names = tuple(dict.fromkeys(measures or ()))
    if server:
        from drivora_service.cli.service_comparison import compare_on_service

        comparison = compare_on_service(
            server, wanted, baseline=baseline, measures=names, equal_time=equal_time
        )
    else:
        comparison = _compare_here(wanted, data_dir, baseline, names, equal_time=equal_time)
    if as_json:
        print_json(adapter(type(comparison)).dump_python(comparison, mode="json"))
    else:
        print_comparison(comparison)
    if out is not None:
        from drivora_service.studies.comparison_files import write_comparison

        for path in write_comparison(comparison, out):
            note(str(path))


def _compare_here(
    wanted: list[str],
    data_dir: Path | None,
    baseline: str,
    names: tuple[str, ...],
    *,
    equal_time: bool,
) -> Comparison:
    from drivora_service.campaigns.catalogues import installed_catalogues
    from drivora_service.cli.embedded import network_catalogue
    from drivora_service.cli.stored_campaigns import StoredCampaigns
    from drivora_service.studies.choosing import choose_campaigns
    from drivora_service.studies.comparing import compare_stored
    from drivora_service.studies.comparison import MEASURES, measure

    chosen = tuple(measure(name) for name in names) if names else MEASURES
    with StoredCampaigns(data_dir) as campaigns:
        return compare_stored(
            campaigns.database,
            choose_campaigns(campaigns.database, wanted),
            installed_catalogues(
                network_catalogue(campaigns.settings), campaigns.settings.agents_folder
            ),
            baseline=baseline,
            measures=chosen,
            equal_time=equal_time,
        )


def report(
    campaign_id: Annotated[str, typer.Argument(metavar="ID", help="Id of a campaign.")],
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
    """Tells what a campaign searched and found, as Markdown.

    With --server it is a campaign of the service; pictures show road networks that are here too.
    """
    from drivora_service.cli.campaign_reports import report_here, report_of_service
    from drivora_service.studies.report_text import report_markdown

    folder = None if out is None else out.with_name(f"{out.stem}-pictures")
    if server:
        told = report_of_service(server, campaign_id, data_dir, folder)
        options = f"--server {shlex.quote(server)}"
    else:
        told = report_here(campaign_id, data_dir, folder)
        options = "" if data_dir is None else f"--data-dir {shlex.quote(str(data_dir))}"
    addresses = {n: f"{path.parent.name}/{path.name}" for n, path in told.pictures.items()}
    text = report_markdown(told.report, pictures=addresses, options=options)
    if out is None:
        typer.echo(text, nl=False)
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text)
    typer.echo(str(out))
