"""``drivora campaign``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.commands.campaign_comparison import compare, report
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.options import DataDirOption
from drivora_service.cli.output import JsonOption, fail, note, print_json
from drivora_service.errors import InvalidDocument

if TYPE_CHECKING:
    from drivora_service.cli.stored_campaigns import StoredCampaigns
    from drivora_service.store.campaign_records import CampaignRequest

app = typer.Typer(help="Searches for failures of an ADS.", no_args_is_help=True)

IdArgument = Annotated[str, typer.Argument(metavar="ID", help="Id of a campaign.")]
WorkersOption = Annotated[
    int | None,
    typer.Option(min=1, help="Worker processes [default: as the campaign says, or one a core]."),
]
EvaluatorOption = Annotated[
    str, typer.Option(metavar="NAME", help="What evaluates: an evaluator by its name.")
]
OutOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Write scenario and trace of each failure there."),
]
GateOption = Annotated[bool, typer.Option("--gate", help="Exit with 1 if any failure was found.")]


@app.command()
def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A campaign, as YAML or JSON.")],
    workers: WorkersOption = None,
    out: OutOption = None,
    evaluator: EvaluatorOption = "local",
    gate: GateOption = False,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Runs a campaign; an interrupt (Ctrl-C) pauses it, and then exits with 3."""
    from drivora_service.cli.local_campaigns import create_campaign
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        try:
            record, notes = create_campaign(campaigns, file)
        except InvalidDocument as error:
            fail(f"{file}: {len(error.problems)} problem(s)")
            for problem in error.problems:
                typer.echo(f"  {problem.pointer or '/'}: {problem.message}", err=True)
            raise typer.Exit(ExitCode.WRONG_USE) from error
        for remark in notes:
            note(f"note: {remark}")
        note(f"campaign {record.id}")
        _work(
            campaigns,
            record.id,
            workers=workers,
            out=out,
            evaluator=evaluator,
            gate=gate,
            as_json=as_json,
        )


@app.command()
def resume(
    campaign_id: IdArgument,
    workers: WorkersOption = None,
    out: OutOption = None,
    evaluator: EvaluatorOption = "local",
    gate: GateOption = False,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Goes on with a campaign that was paused, failed or killed, as if nothing had happened."""
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        _work(
            campaigns,
            campaign_id,
            workers=workers,
            out=out,
            evaluator=evaluator,
            gate=gate,
            as_json=as_json,
        )


@app.command("list")
def list_campaigns(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="How many.")] = 50,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Lists campaigns, newest first."""
    from drivora_service.cli import campaign_results
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        listed = [(record, campaigns.is_running(record)) for record in campaigns.newest(limit)]
    if as_json:
        print_json([campaign_results.summary(record, running=on) for record, on in listed])
    else:
        campaign_results.print_campaigns(listed)


@app.command()
def show(
    campaign_id: IdArgument,
    evaluation: Annotated[
        int | None,
        typer.Option(min=0, metavar="N", help="Show this evaluation and what it descends from."),
    ] = None,
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Shows a campaign and the failures that it has found, or one of its evaluations."""
    from drivora_service.cli import campaign_results
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        if evaluation is None:
            _show(campaigns, campaign_id, as_json=as_json)
            return
        lineage = campaigns.lineage(campaign_id, evaluation)
    if as_json:
        print_json({"lineage": [campaign_results.evaluation_result(e) for e in lineage]})
    else:
        campaign_results.print_evaluation(lineage)


@app.command()
def scenario(
    campaign_id: IdArgument,
    number: Annotated[int, typer.Argument(metavar="N", min=0, help="Number of an evaluation.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where to write it [default: print it].")
    ] = None,
    data_dir: DataDirOption = None,
) -> None:
    """Gives the scenario of an evaluation, for `drivora run`."""
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        text = campaigns.scenario(campaign_id, number)
    if out is None:
        typer.echo(text, nl=False)
    else:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text)
        typer.echo(str(out))


@app.command()
def pause(
    campaign_id: IdArgument, data_dir: DataDirOption = None, as_json: JsonOption = False
) -> None:
    """Asks the process that runs a campaign to pause it."""
    from drivora_service.store.campaign_records import CampaignRequest

    _ask_for(campaign_id, CampaignRequest.PAUSE, data_dir, as_json=as_json)


@app.command()
def cancel(
    campaign_id: IdArgument, data_dir: DataDirOption = None, as_json: JsonOption = False
) -> None:
    """Gives a campaign up for good; what it has found stays."""
    from drivora_service.store.campaign_records import CampaignRequest

    _ask_for(campaign_id, CampaignRequest.CANCEL, data_dir, as_json=as_json)


app.command()(compare)
app.command()(report)


def _work(
    campaigns: StoredCampaigns,
    campaign_id: str,
    *,
    workers: int | None,
    out: Path | None,
    evaluator: str,
    gate: bool,
    as_json: bool,
) -> None:
    from drivora_service.cli.local_campaigns import export_campaign, run_campaign
    from drivora_service.store.campaign_records import CampaignState

    record = run_campaign(campaigns, campaign_id, workers=workers, evaluator=evaluator)
    if out is not None:
        export_campaign(campaigns, campaign_id, out)
    _show(campaigns, campaign_id, as_json=as_json)
    if record.state is CampaignState.PAUSED:
        note(f"paused; go on with: drivora campaign resume {campaign_id}")
    if record.state is not CampaignState.FINISHED:
        raise typer.Exit(ExitCode.NOT_DONE)
    if gate and record.counts.violating:
        raise typer.Exit(ExitCode.GATE_FAILED)


def _show(campaigns: StoredCampaigns, campaign_id: str, *, as_json: bool) -> None:
    from drivora_service.cli import campaign_results

    found = campaigns.found(campaign_id)
    if as_json:
        print_json(campaign_results.campaign_result(found))
    else:
        campaign_results.print_campaign(found)


def _ask_for(
    campaign_id: str, request: CampaignRequest, data_dir: Path | None, *, as_json: bool
) -> None:
    from drivora_service.cli import campaign_results
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        record = campaigns.ask_for(campaign_id, request)
        running = campaigns.is_running(record)
    if as_json:
        print_json(campaign_results.summary(record, running=running))
    else:
        state = campaign_results.state_of(record, running=running)
        wanted = f", {record.request} wanted" if record.request else ""
        typer.echo(f"campaign {campaign_id} is {state}{wanted}")
