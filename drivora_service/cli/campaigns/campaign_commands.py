"""``drivora campaign``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import CampaignArgument, id_of
from drivora_service.cli.campaigns.campaign_export_command import export
from drivora_service.cli.campaigns.campaign_presets_command import presets
from drivora_service.cli.campaigns.campaign_validate_command import validate
from drivora_service.cli.campaigns.comparison_commands import compare, report
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.error_printing import say_error
from drivora_service.cli.terminal.interruption import say_interrupted
from drivora_service.cli.terminal.options import (
    DataDirOption,
    ExecutorOption,
    GateOracleOption,
    RayAddressOption,
    ServerOption,
    location,
)
from drivora_service.cli.terminal.out_option import check_file, check_folder
from drivora_service.cli.terminal.output import (
    note,
    say,
    write_text,
)
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.errors import ConfigurationError, ServiceError
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.cli.runs.run_gates import Gate
    from drivora_service.client import Client

app = typer.Typer(help="Searches for failures of an ADS.", no_args_is_help=True)

WorkersOption = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="Worker processes, on a Ray cluster of each node [default: as the campaign says, or "
        "one a core]; not with --server.",
    ),
]
EvaluatorOption = Annotated[
    str,
    typer.Option(
        metavar="NAME", help="Evaluator to use, by its name [default: local]; not with --server."
    ),
]
OutOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Write scenario and trace of each failure there."),
]
DetachOption = Annotated[
    bool, typer.Option("--detach", help="With --server: do not wait until it has ended.")
]
GateOption = Annotated[
    bool,
    typer.Option(
        "--gate",
        help="Exit with 1 if any failure was found: a violation that the campaign's counts and "
        "oracles count, or a failure of the ADS itself.",
    ),
]


@app.command()
@with_forms
def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A campaign, as YAML or JSON.")],
    start_from: Annotated[
        str,
        typer.Option(
            metavar="CAMPAIGN|DIR",
            help="Begin with candidates of an earlier campaign on the same scenario and space: its "
            "id, first digits of it, its name, latest, or the folder that --out wrote.",
        ),
    ] = "",
    start_with: Annotated[
        str,
        typer.Option(
            metavar="KIND",
            help="With --start-from: failures, one of each kind first, or elites, those nearest to "
            "a failure by their objectives [default: failures].",
        ),
    ] = "",
    start_most: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1000,
            help="With --start-from: candidates of each seed scenario, at most [default: 20].",
        ),
    ] = None,
    workers: WorkersOption = None,
    out: OutOption = None,
    evaluator: EvaluatorOption = "",
    executor: ExecutorOption = None,
    ray_address: RayAddressOption = None,
    gate: GateOption = False,
    gate_oracle: GateOracleOption = None,
    detach: DetachOption = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Runs a campaign; an interrupt (Ctrl-C) pauses it, and then exits with 130.

    With --server the service runs it; an interrupt then only ends the watching.
    """
    _refuse_detaching(detach, server)
    check_folder(out)
    with open_client(
        server,
        data_dir,
        works=True,
        makes_data=True,
        workers=workers,
        evaluator=evaluator,
        executor=executor,
        ray_address=ray_address,
        on_error=say_error,
    ) as client:
        import json

        from drivora_service.cli.campaigns.campaign_files import send_campaign
        from drivora_service.cli.campaigns.campaign_gates import gate_of_document
        from drivora_service.cli.campaigns.campaign_starts import (
            resolve_campaign_start,
            start_option,
        )

        chosen_start = start_option(start_from, start_with, start_most)

        def post(content: dict[str, Any]) -> tuple[Campaign, Gate | None]:
            content = resolve_campaign_start(client, content, file.parent, chosen_start)
            chosen = gate_of_document(client, content, gate_oracle or (), is_wanted=gate)
            return client.post_campaign(json.dumps(content)), chosen

        posted, chosen = send_campaign(file, post)
        for remark in posted.notes:
            note(f"note: {remark}")
        note(f"campaign {posted.id}")
        _finish(
            client,
            posted,
            server,
            data_dir,
            out=out,
            gate=chosen,
            detach=detach,
            form=form,
        )


@app.command()
@with_forms
def resume(
    campaign: CampaignArgument,
    workers: WorkersOption = None,
    out: OutOption = None,
    evaluator: EvaluatorOption = "",
    executor: ExecutorOption = None,
    ray_address: RayAddressOption = None,
    gate: GateOption = False,
    gate_oracle: GateOracleOption = None,
    detach: DetachOption = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Resumes a campaign that was paused, failed or killed, as if it had not been interrupted."""
    _refuse_detaching(detach, server)
    check_folder(out)
    with open_client(
        server,
        data_dir,
        works=True,
        workers=workers,
        evaluator=evaluator,
        executor=executor,
        ray_address=ray_address,
        on_error=say_error,
    ) as client:
        from drivora_service.cli.campaigns.campaign_gates import gate_of_document

        campaign_id = id_of(client, campaign, IdKind.CAMPAIGN)
        resumed = client.campaign(campaign_id)
        chosen = gate_of_document(client, resumed.document, gate_oracle or (), is_wanted=gate)
        if out is None or not resumed.state.is_over:
            resumed = client.resume_campaign(campaign_id)
        else:
            note(f"campaign {campaign_id} is {resumed.state}; its folder is written again")
        _finish(
            client,
            resumed,
            server,
            data_dir,
            out=out,
            gate=chosen,
            detach=detach,
            form=form,
        )


@app.command("list")
@with_forms
def list_campaigns(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="How many.")] = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Lists campaigns, newest first."""
    with open_client(server, data_dir) as client:
        from drivora_service.cli.campaigns.campaign_output import print_campaigns
        from drivora_service.store.campaigns.campaign_records import CampaignSummary

        campaigns = tuple(client.campaigns(limit=limit))
        if form.is_table:
            # Lists leave out what a campaign counts.
            print_campaigns([client.campaign(one.id) for one in campaigns])
        else:
            form.print_shape(tuple[CampaignSummary, ...], campaigns)


@app.command()
@with_forms
def show(
    campaign: CampaignArgument,
    evaluation: Annotated[
        int | None,
        typer.Option(min=0, metavar="N", help="Show this evaluation and its ancestors."),
    ] = None,
    out: OutOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows a campaign and the failures that it has found, or one of its evaluations.

    With --out, the folder is written as `campaign run --out` does, whatever the campaign's state.
    """
    if out is not None and evaluation is not None:
        raise typer.BadParameter("is for a campaign, not for --evaluation", param_hint="--out")
    check_folder(out)
    with open_client(server, data_dir) as client:
        campaign_id = id_of(client, campaign, IdKind.CAMPAIGN)
        if evaluation is None:
            from drivora_service.cli.campaigns.campaign_running import export_campaign

            shown = client.campaign(campaign_id)
            if out is not None:
                export_campaign(client, shown, out)
            _show(client, shown, form, where=location(server, data_dir))
            return
        found = client.evaluation(campaign_id, evaluation)
    from drivora_service.cli.campaigns.campaign_output import print_evaluation

    if form.is_table:
        print_evaluation(found, where=location(server, data_dir))
    else:
        form.print_shape(type(found), found, id_field="number")


@app.command()
def scenario(
    campaign: CampaignArgument,
    number: Annotated[int, typer.Argument(metavar="N", min=0, help="Number of an evaluation.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where to write it [default: print it].")
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Prints the scenario of an evaluation, for `drivora run`."""
    check_file(out)
    with open_client(server, data_dir) as client:
        text = client.evaluation_scenario(id_of(client, campaign, IdKind.CAMPAIGN), number)
    write_text(text, out)


@app.command()
@with_forms
def pause(
    campaign: CampaignArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Pauses a campaign, whichever process runs it."""
    with open_client(server, data_dir) as client:
        _say_state(client.pause_campaign(id_of(client, campaign, IdKind.CAMPAIGN)), form)


@app.command()
@with_forms
def cancel(
    campaign: CampaignArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Cancels a campaign permanently; what it has found stays."""
    with open_client(server, data_dir) as client:
        _say_state(client.cancel_campaign(id_of(client, campaign, IdKind.CAMPAIGN)), form)


app.command()(compare)
app.command()(report)
app.command()(export)
app.command()(presets)
app.command()(validate)


def _refuse_detaching(detach: bool, server: str) -> None:
    if detach and not server:
        raise ConfigurationError(
            "--detach is for campaigns of a service (--server): a campaign of this process ends "
            "with it"
        )


def _finish(
    client: Client,
    campaign: Campaign,
    server: str,
    data_dir: Path | None,
    *,
    out: Path | None,
    gate: Gate | None,
    detach: bool,
    form: Form,
) -> None:
    """Follows a campaign to its end, shows it and judges it."""
    from drivora_service.cli.campaigns.campaign_endings import (
        ending_hint,
        is_undecided,
    )
    from drivora_service.cli.campaigns.campaign_running import (
        export_campaign,
        follow,
        pause_and_wait,
    )
    from drivora_service.store.campaigns.campaign_records import CampaignState

    if detach:
        if not form.is_table:
            _show(client, campaign, form, where="")
        return
    where = f"{campaign.id} {location(server, data_dir)}".rstrip()
    is_interrupted = False
    try:
        campaign = follow(client, campaign.id)
    except KeyboardInterrupt as error:
        if server:
            say_interrupted(
                f"the service continues it; stop it with: drivora campaign pause {where}"
            )
            raise typer.Exit(ExitCode.INTERRUPTED) from error
        campaign = pause_and_wait(client, campaign.id)
        is_interrupted = True
    except ServiceError:
        # It has been stored, whatever has become of it.
        note(f"campaign {campaign.id}: drivora campaign show {where}")
        raise
    if out is not None:
        export_campaign(client, campaign, out)
    _show(client, campaign, form, where=location(server, data_dir))
    hint = ending_hint(campaign, where, out)
    if is_interrupted and campaign.state is CampaignState.PAUSED:
        done = campaign.counts.evaluations
        say_interrupted(
            f"the campaign is paused and its {done} evaluations are kept; {hint.partition('; ')[2]}"
        )
        raise typer.Exit(ExitCode.INTERRUPTED)
    if hint:
        note(hint)
    if campaign.state is not CampaignState.FINISHED or is_undecided(campaign, gate):
        raise typer.Exit(ExitCode.NOT_DONE)
    if gate is not None:
        from drivora_service.cli.campaigns.campaign_gates import judge_campaign
        from drivora_service.cli.runs.run_gates import print_answer

        print_answer(judge_campaign(client, campaign, gate))


def _show(client: Client, campaign: Campaign, form: Form, *, where: str) -> None:
    from drivora_service.cli.campaigns.campaign_output import campaign_content, print_campaign

    if form.is_table:
        print_campaign(campaign, where=where)
    else:
        form.print_content(campaign_content(campaign, tuple(client.failures(campaign.id))))


def _say_state(campaign: Campaign, form: Form) -> None:
    if not form.is_table:
        form.print_shape(type(campaign), campaign)
        return
    requested = f", {campaign.request} requested" if campaign.request else ""
    say(f"campaign {campaign.id} is {campaign.state}{requested}")
