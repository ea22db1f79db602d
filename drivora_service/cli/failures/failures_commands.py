"""``drivora failures``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import (
    BatchOption,
    CampaignOption,
    ConfigurationOption,
    GroupArgument,
    GroupOption,
    StudyOption,
    baseline_id,
    id_of,
    ids_of,
)
from drivora_service.cli.failures.failure_filters import check_owners, make_filter
from drivora_service.cli.terminal.options import (
    CountsOption,
    DataDirOption,
    ServerOption,
    location,
    parse_choice,
)
from drivora_service.cli.terminal.output import fail
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from collections.abc import Callable

    from drivora_service.api.schemas.failure_groups import FailureGroup
    from drivora_service.client import Client

app = typer.Typer(
    help="Failures of all campaigns and batches, and what was decided about them.",
    no_args_is_help=True,
)

_ByOption = Annotated[
    str, typer.Option(metavar="NAME", help="Who decides [default: the name of the user].")
]
_OracleOption = Annotated[str, typer.Option(metavar="NAME", help="Of this oracle.")]
_AgentOption = Annotated[str, typer.Option(metavar="NAME", help="Of this agent.")]
_TownOption = Annotated[str, typer.Option(metavar="NAME", help="On this road network.")]
_AccountabilityOption = Annotated[
    str,
    typer.Option(
        metavar="WORD", help="For which an ego is accountable so far, such as `avoidable`."
    ),
]
_LimitOption = Annotated[int, typer.Option(min=1, max=10_000, help="How many.")]


@app.command("list")
@with_forms
def list_failures(
    group: GroupOption = "",
    oracle: _OracleOption = "",
    agent: _AgentOption = "",
    configuration: ConfigurationOption = "",
    town: _TownOption = "",
    accountability: _AccountabilityOption = "",
    campaign: CampaignOption = "",
    study: StudyOption = "",
    batch: BatchOption = "",
    counts: CountsOption = None,
    limit: _LimitOption = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Lists failures, the last found first."""
    with open_client(server, data_dir) as client:
        from drivora_service.api.schemas.failures import FoundFailure

        wanted = make_filter(
            client,
            group,
            oracle,
            agent,
            configuration,
            town,
            accountability,
            campaign,
            study,
            batch,
            counts,
        )
        check_owners(client, wanted)
        failures = tuple(client.found_failures(wanted, limit=limit))
        found = client.found_counts(wanted)
    if not form.is_table:
        form.print_shape(tuple[FoundFailure, ...], failures)
    else:
        from drivora_service.cli.failures.failure_output import print_counts, print_failures

        print_counts(found)
        print_failures(failures, where=location(server, data_dir))


@app.command()
@with_forms
def groups(
    status: Annotated[
        list[str] | None,
        typer.Option(
            metavar="STATUS",
            help="With this status (new, known, fixed, will_not_fix); may be repeated.",
        ),
    ] = None,
    assignee: Annotated[
        str, typer.Option(metavar="NAME", help="Of which this person takes care.")
    ] = "",
    baseline: Annotated[
        str,
        typer.Option(
            metavar="BATCH|CAMPAIGN|STUDY|TIME",
            help="Compare with the failures of this batch, campaign or study (id, first digits of "
            "it, name, or latest), or with those found before a time such as "
            "2026-11-20T08:00:00Z.",
        ),
    ] = "",
    since_baseline: Annotated[
        str,
        typer.Option(metavar="WORD", help="That stand so to the baseline: new, same, gone."),
    ] = "",
    oracle: _OracleOption = "",
    agent: _AgentOption = "",
    configuration: ConfigurationOption = "",
    town: _TownOption = "",
    accountability: _AccountabilityOption = "",
    campaign: CampaignOption = "",
    study: StudyOption = "",
    batch: BatchOption = "",
    counts: CountsOption = None,
    limit: _LimitOption = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Lists groups of failures, the last seen first."""
    from drivora_service.errors import InvalidDocument
    from drivora_service.store.failures.group_records import GroupStatus, SinceBaseline

    statuses = tuple(parse_choice(GroupStatus, one, "--status") for one in status or ())
    if since_baseline and not baseline:
        raise typer.BadParameter("needs --baseline", param_hint="--since-baseline")
    since = (
        parse_choice(SinceBaseline, since_baseline, "--since-baseline") if since_baseline else None
    )
    with open_client(server, data_dir) as client:
        from drivora_service.api.schemas.failure_groups import FailureGroup

        wanted = make_filter(
            client,
            "",
            oracle,
            agent,
            configuration,
            town,
            accountability,
            campaign,
            study,
            batch,
            counts,
        )
        check_owners(client, wanted)
        listing = client.failure_groups(
            wanted,
            statuses=statuses,
            assignee=assignee,
            baseline=baseline_id(client, baseline),
            since_baseline=since,
            limit=limit,
        )
        counted = client.found_counts(wanted)
        try:
            found = tuple(listing)
        except InvalidDocument as error:
            raise typer.BadParameter(error.problems[0].message, param_hint="--baseline") from error
    if not form.is_table:
        form.print_shape(tuple[FailureGroup, ...], found)
    else:
        from drivora_service.cli.failures.failure_output import print_counts, print_groups

        print_counts(counted)
        print_groups(found)


@app.command()
@with_forms
def show(
    group: GroupArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows a group, and what was decided about it."""
    with open_client(server, data_dir) as client:
        group_id = id_of(client, group, IdKind.FAILURE_GROUP)
        found = client.failure_group(group_id)
        changes = client.failure_group_changes(group_id)
    if not form.is_table:
        form.print_shape(type(found), found)
    else:
        from drivora_service.cli.failures.failure_output import print_group

        print_group(found, changes.items)


@app.command()
@with_forms
def decide(
    group: GroupArgument,
    status: Annotated[
        str,
        typer.Option(metavar="STATUS", help="Its status: new, known, fixed or will_not_fix."),
    ] = "",
    label: Annotated[
        str | None, typer.Option(metavar="TEXT", help='Its name; "": told by what it is.')
    ] = None,
    assignee: Annotated[
        str | None, typer.Option(metavar="NAME", help='Who takes care of it; "": nobody.')
    ] = None,
    note: Annotated[str | None, typer.Option(metavar="TEXT", help="A note.")] = None,
    by: _ByOption = "",
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Sets the status, label, assignee or note of a group; what is left out stays."""
    from drivora_service.store.failures.group_records import GroupStatus

    if not status and label is None and assignee is None and note is None:
        raise typer.BadParameter("name one of --status, --label, --assignee and --note")
    new_status = parse_choice(GroupStatus, status, "--status") if status else None
    _write(
        server,
        data_dir,
        lambda client: client.decide_group(
            id_of(client, group, IdKind.FAILURE_GROUP),
            status=new_status,
            label=label,
            assignee=assignee,
            note=note,
            by=by or _user(),
        ),
        form=form,
    )


@app.command()
@with_forms
def merge(
    into: GroupArgument,
    others: Annotated[
        list[str],
        typer.Argument(
            metavar="GROUP…",
            help="The groups whose failures come to the first one, which stays.",
        ),
    ],
    by: _ByOption = "",
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Puts the failures of groups into another one, also those found later."""
    _write(
        server,
        data_dir,
        lambda client: client.merge_groups(
            id_of(client, into, IdKind.FAILURE_GROUP),
            ids_of(client, others, IdKind.FAILURE_GROUP),
            by=by or _user(),
        ),
        form=form,
    )


@app.command()
@with_forms
def split(
    group: GroupArgument,
    failure: Annotated[
        list[int] | None,
        typer.Option(metavar="NUMBER", help="A failure to split off; may be repeated."),
    ] = None,
    name: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="A name of the group, whose failures are split off, also those found later; may "
            "be repeated.",
        ),
    ] = None,
    label: Annotated[str, typer.Option(metavar="TEXT", help="Name of the new group.")] = "",
    by: _ByOption = "",
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Makes a group of a part of another one."""
    if not failure and not name:
        raise typer.BadParameter("name what to split off: --failure or --name")
    _write(
        server,
        data_dir,
        lambda client: client.split_group(
            id_of(client, group, IdKind.FAILURE_GROUP),
            failures=failure or (),
            names=name or (),
            label=label,
            by=by or _user(),
        ),
        form=form,
    )


def _write(
    server: str,
    data_dir: Path | None,
    do: Callable[[Client], FailureGroup],
    *,
    form: Form,
) -> None:
    from drivora_service.cli.exit_codes import ExitCode
    from drivora_service.errors import RequestConflict

    with open_client(server, data_dir) as client:
        try:
            found = do(client)
        except RequestConflict as error:
            fail(str(error))
            raise typer.Exit(ExitCode.USAGE_ERROR) from error
    if not form.is_table:
        form.print_shape(type(found), found)
    else:
        from drivora_service.cli.failures.failure_output import print_groups

        print_groups((found,))


def _user() -> str:
    """Returns the name of the user, or "" where none can be told."""
    import getpass

    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return ""
