"""``drivora campaign``."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.commands.campaign_comparison import compare, report
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.options import DataDirOption, GateRuleOption, ServerOption
from drivora_service.cli.output import JsonOption, fail, note, print_json
from drivora_service.errors import ConfigurationError, InvalidDocument, WorkersCannotStart

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from drivora_service.cli.campaigns import Campaigns
    from drivora_service.cli.gates import Gate
    from drivora_service.cli.service_campaigns import ServiceCampaigns
    from drivora_service.cli.stored_campaigns import StoredCampaigns
    from drivora_service.store.campaign_records import CampaignRecord, CampaignRequest

app = typer.Typer(help="Searches for failures of an ADS.", no_args_is_help=True)

IdArgument = Annotated[str, typer.Argument(metavar="ID", help="Id of a campaign.")]
WorkersOption = Annotated[
    int | None,
    typer.Option(min=1, help="Worker processes [default: as the campaign says, or one a core]."),
]
EvaluatorOption = Annotated[
    str,
    typer.Option(metavar="NAME", help="What evaluates: an evaluator by its name [default: local]."),
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
        "--gate", help="Exit with 1 if any failure was found that an ego is accountable for."
    ),
]


@app.command()
def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A campaign, as YAML or JSON.")],
    workers: WorkersOption = None,
    out: OutOption = None,
    evaluator: EvaluatorOption = "",
    gate: GateOption = False,
    gate_rule: GateRuleOption = None,
    detach: DetachOption = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Runs a campaign; an interrupt (Ctrl-C) pauses it, and then exits with 3.

    With --server the service runs it; an interrupt then only ends the watching.
    """
    if server:
        from drivora_service.cli.service_campaigns import ServiceCampaigns

        _refuse_local_options(workers, evaluator)
        with ServiceCampaigns(server) as service:
            with _problems_of(file):
                _check_gate(file, gate_rule or ())
                record, notes = service.post(file)
            _announce(record, notes)
            chosen = _gate(service, record.id, gate_rule or (), is_wanted=gate)
            if not detach:
                _follow(service, record.id, server, out=out, gate=chosen, as_json=as_json)
            elif as_json:
                _show(service, record.id, as_json=True)
        return
    _prepare()
    from drivora_service.cli.local_campaigns import create_campaign
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        with _problems_of(file):
            _check_gate(file, gate_rule or ())
            record, notes = create_campaign(campaigns, file, workers=workers)
        _announce(record, notes)
        chosen = _gate(campaigns, record.id, gate_rule or (), is_wanted=gate)
        _work(
            campaigns,
            record.id,
            workers=workers,
            out=out,
            evaluator=evaluator,
            gate=chosen,
            as_json=as_json,
        )


@app.command()
def resume(
    campaign_id: IdArgument,
    workers: WorkersOption = None,
    out: OutOption = None,
    evaluator: EvaluatorOption = "",
    gate: GateOption = False,
    gate_rule: GateRuleOption = None,
    detach: DetachOption = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Goes on with a campaign that was paused, failed or killed, as if nothing had happened."""
    if server:
        from drivora_service.cli.service_campaigns import ServiceCampaigns

        _refuse_local_options(workers, evaluator)
        with ServiceCampaigns(server) as service:
            chosen = _gate(service, campaign_id, gate_rule or (), is_wanted=gate)
            service.resume(campaign_id)
            if not detach:
                _follow(service, campaign_id, server, out=out, gate=chosen, as_json=as_json)
            elif as_json:
                _show(service, campaign_id, as_json=True)
        return
    _prepare()
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    with StoredCampaigns(data_dir) as campaigns:
        chosen = _gate(campaigns, campaign_id, gate_rule or (), is_wanted=gate)
        _work(
            campaigns,
            campaign_id,
            workers=workers,
            out=out,
            evaluator=evaluator,
            gate=chosen,
            as_json=as_json,
        )


@app.command("list")
def list_campaigns(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="How many.")] = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Lists campaigns, newest first."""
    from drivora_service.cli import campaign_results
    from drivora_service.cli.campaigns import open_campaigns

    with open_campaigns(server, data_dir) as campaigns:
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
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Shows a campaign and the failures that it has found, or one of its evaluations."""
    from drivora_service.cli import campaign_results
    from drivora_service.cli.campaigns import open_campaigns

    with open_campaigns(server, data_dir) as campaigns:
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
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Returns the scenario of an evaluation, for `drivora run`."""
    from drivora_service.cli.campaigns import open_campaigns

    with open_campaigns(server, data_dir) as campaigns:
        text = campaigns.scenario(campaign_id, number)
    if out is None:
        typer.echo(text, nl=False)
    else:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text)
        typer.echo(str(out))


@app.command()
def pause(
    campaign_id: IdArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Asks the process that runs a campaign to pause it."""
    from drivora_service.store.campaign_records import CampaignRequest

    _ask_for(campaign_id, CampaignRequest.PAUSE, server, data_dir, as_json=as_json)


@app.command()
def cancel(
    campaign_id: IdArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Returns a campaign up for good; what it has found stays."""
    from drivora_service.store.campaign_records import CampaignRequest

    _ask_for(campaign_id, CampaignRequest.CANCEL, server, data_dir, as_json=as_json)


app.command()(compare)
app.command()(report)


@contextmanager
def _problems_of(file: Path) -> Iterator[None]:
    """Prints what is wrong with a campaign file, each thing with its place."""
    try:
        yield
    except InvalidDocument as error:
        fail(f"{file}: {len(error.problems)} problem(s)")
        for problem in error.problems:
            typer.echo(f"  {problem.pointer or '/'}: {problem.message}", err=True)
        raise typer.Exit(ExitCode.WRONG_USE) from error


def _announce(record: CampaignRecord, notes: tuple[str, ...]) -> None:
    for remark in notes:
        note(f"note: {remark}")
    note(f"campaign {record.id}")


def _refuse_local_options(workers: int | None, evaluator: str) -> None:
    if workers is not None or evaluator:
        raise ConfigurationError(
            "--workers and --evaluator are for campaigns that run here; a service has its own "
            "workers, and a campaign may want fewer of them (`workers` in its file)"
        )


def _prepare() -> None:
    """Lets worker processes get ready while this one reads and checks what they are to do."""
    from drivora_service.cli.private_files import keep_files_private
    from drivora_service.execution.fork_server import prepare_processes

    keep_files_private()
    prepare_processes()


def _work(
    campaigns: StoredCampaigns,
    campaign_id: str,
    *,
    workers: int | None,
    out: Path | None,
    evaluator: str,
    gate: Gate | None,
    as_json: bool,
) -> None:
    from drivora_service.cli.local_campaigns import run_campaign

    try:
        record = run_campaign(
            campaigns, campaign_id, workers=workers, evaluator=evaluator or "local"
        )
    except WorkersCannotStart:
        note(f"paused; go on with: drivora campaign resume {campaign_id}")
        raise
    _conclude(campaigns, record, out=out, gate=gate, as_json=as_json)


def _follow(
    service: ServiceCampaigns,
    campaign_id: str,
    server: str,
    *,
    out: Path | None,
    gate: Gate | None,
    as_json: bool,
) -> None:
    try:
        record = service.follow(campaign_id)
    except KeyboardInterrupt as error:
        note(
            "the service goes on with it; stop it with: "
            f"drivora campaign pause {campaign_id} --server {server}"
        )
        raise typer.Exit(ExitCode.NOT_DONE) from error
    _conclude(service, record, out=out, gate=gate, as_json=as_json)


def _conclude(
    campaigns: Campaigns,
    record: CampaignRecord,
    *,
    out: Path | None,
    gate: Gate | None,
    as_json: bool,
) -> None:
    from drivora_service.cli.campaigns import export_campaign
    from drivora_service.store.campaign_records import CampaignState

    if out is not None:
        export_campaign(campaigns, record.id, out)
    _show(campaigns, record.id, as_json=as_json)
    if record.state is CampaignState.PAUSED:
        note(f"paused; go on with: drivora campaign resume {record.id}")
    if record.state is not CampaignState.FINISHED:
        raise typer.Exit(ExitCode.NOT_DONE)
    if gate is not None:
        from drivora_service.cli.gates import broken_in_campaign

        failures = campaigns.found(record.id).failures
        answer = gate.judge(broken_in_campaign((one.evaluation, one.verdict) for one in failures))
        note(str(answer))
        if answer.fails:
            raise typer.Exit(ExitCode.GATE_FAILED)


def _gate(
    campaigns: Campaigns, campaign_id: str, rules: Sequence[str], *, is_wanted: bool
) -> Gate | None:
    """Reads the gate of a campaign; its rules are those whose violations it counts as failures."""
    if not (rules or is_wanted):
        return None
    from drivora_service.campaigns.documents import CampaignDocument

    text = campaigns.found(campaign_id).record.document
    return _read_gate(rules, CampaignDocument.model_validate(text).oracles)


def _check_gate(file: Path, rules: Sequence[str]) -> None:
    """Refuses rules that the campaign of a file does not count, before the campaign is stored."""
    if not rules:
        return
    from drivora_service.campaigns.campaign import DEFAULT_ORACLES
    from drivora_service.cli.campaign_files import read_campaign_file

    counted = read_campaign_file(file).get("oracles", DEFAULT_ORACLES)
    if isinstance(counted, list | tuple):  # what else it is, is refused with the file
        _read_gate(rules, [str(one) for one in counted])


def _read_gate(rules: Sequence[str], counted: Sequence[str]) -> Gate:
    from drivora_service.cli.gates import read_gate

    try:
        return read_gate(rules, counted, whose="the campaign counts")
    except ConfigurationError as error:
        fail(str(error))
        raise typer.Exit(ExitCode.WRONG_USE) from error


def _show(campaigns: Campaigns, campaign_id: str, *, as_json: bool) -> None:
    from drivora_service.cli import campaign_results

    found = campaigns.found(campaign_id)
    if as_json:
        print_json(campaign_results.campaign_result(found))
    else:
        campaign_results.print_campaign(found)


def _ask_for(
    campaign_id: str,
    request: CampaignRequest,
    server: str,
    data_dir: Path | None,
    *,
    as_json: bool,
) -> None:
    from drivora_service.cli import campaign_results
    from drivora_service.cli.campaigns import open_campaigns

    with open_campaigns(server, data_dir) as campaigns:
        record = campaigns.ask_for(campaign_id, request)
        running = campaigns.is_running(record)
    if as_json:
        print_json(campaign_results.summary(record, running=running))
    else:
        state = campaign_results.state_of(record, running=running)
        wanted = f", {record.request} wanted" if record.request else ""
        typer.echo(f"campaign {campaign_id} is {state}{wanted}")
