"""``drivora study``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.application.references import StudyArgument, id_of
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.error_printing import ErrorPrinter
from drivora_service.cli.terminal.interruption import say_interrupted
from drivora_service.cli.terminal.options import (
    DataDirOption,
    EqualTimeOption,
    ExecutorOption,
    RayAddressOption,
    ServerOption,
    WorkersOption,
    location,
)
from drivora_service.cli.terminal.out_option import check_folder, convert_write_errors
from drivora_service.cli.terminal.output import JsonOption, note, print_shape, say
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.errors import ConfigurationError, InvalidDocument, ServiceError
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.api.schemas.studies import Study
    from drivora_service.client import Client

app = typer.Typer(
    help="Runs campaigns by scenarios, agents, methods and repetitions.", no_args_is_help=True
)

DetachOption = Annotated[
    bool, typer.Option("--detach", help="With --server: do not wait until it has ended.")
]


@app.command()
@with_forms
def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A study, as YAML or JSON.")],
    workers: WorkersOption = None,
    executor: ExecutorOption = None,
    ray_address: RayAddressOption = None,
    detach: DetachOption = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Runs a study; an interrupt (Ctrl-C) pauses it, and then exits with 3.

    With --server the service runs it; an interrupt then only ends the watching.
    """
    _refuse_detaching(detach, server)
    with open_client(
        server,
        data_dir,
        works=True,
        makes_data=True,
        workers=workers,
        executor=executor,
        ray_address=ray_address,
        on_error=ErrorPrinter(),
    ) as client:
        study = _post_study(client, file)
        for remark in study.notes:
            note(f"note: {remark}")
        note(f"study {study.id}")
        _finish(client, study, server, data_dir, detach=detach, form=form)


@app.command()
@with_forms
def resume(
    study: StudyArgument,
    workers: WorkersOption = None,
    executor: ExecutorOption = None,
    ray_address: RayAddressOption = None,
    detach: DetachOption = False,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Resumes a study that was paused, failed or killed, as if it had not been interrupted."""
    _refuse_detaching(detach, server)
    with open_client(
        server,
        data_dir,
        works=True,
        workers=workers,
        executor=executor,
        ray_address=ray_address,
        on_error=ErrorPrinter(),
    ) as client:
        resumed = client.resume_study(id_of(client, study, IdKind.STUDY))
        _finish(client, resumed, server, data_dir, detach=detach, form=form)


@app.command("list")
@with_forms
def list_studies(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="How many.")] = 50,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Lists studies, newest first."""
    with open_client(server, data_dir) as client:
        studies = tuple(client.studies(limit=limit))
    from drivora_service.api.schemas.studies import StudyInList
    from drivora_service.cli.studies.study_output import print_studies

    if form.is_table:
        print_studies(studies)
    else:
        form.print_shape(tuple[StudyInList, ...], studies)


@app.command()
@with_forms
def show(
    study: StudyArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Shows a study, and what its campaigns have found by scenario, agent and method."""
    with open_client(server, data_dir) as client:
        _show(client, client.study(id_of(client, study, IdKind.STUDY)), form)


@app.command()
@with_forms
def pause(
    study: StudyArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Pauses the campaigns of a study, whichever process runs them."""
    with open_client(server, data_dir) as client:
        _say_state(client.pause_study(id_of(client, study, IdKind.STUDY)), form)


@app.command()
@with_forms
def cancel(
    study: StudyArgument,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Cancels the campaigns of a study that are not over permanently; what was found stays."""
    with open_client(server, data_dir) as client:
        _say_state(client.cancel_study(id_of(client, study, IdKind.STUDY)), form)


@app.command()
def compare(
    study: StudyArgument,
    baseline_method: Annotated[
        str, typer.Option(metavar="METHOD", help="Baseline method [default: random, or the first].")
    ] = "",
    baseline_agent: Annotated[
        str, typer.Option(metavar="AGENT", help="Baseline agent [default: the first].")
    ] = "",
    measures: Annotated[
        list[str] | None,
        typer.Option("--measure", metavar="NAME", help="Measure; may be repeated."),
    ] = None,
    equal_time: EqualTimeOption = False,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write tables (Markdown, CSV) and a chart there."),
    ] = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compares the finished campaigns of a study, by method and by agent."""
    check_folder(out)
    with open_client(server, data_dir) as client:
        comparison = client.compare_study(
            id_of(client, study, IdKind.STUDY),
            baseline_method=baseline_method,
            baseline_agent=baseline_agent,
            measures=tuple(dict.fromkeys(measures or ())),
            equal_time=equal_time,
        )
    if as_json:
        print_shape(type(comparison), comparison)
    else:
        from drivora_service.cli.studies.study_comparison_output import print_study_comparison

        print_study_comparison(comparison)
    if out is not None:
        from drivora_service.studies.comparison.study_comparison_files import write_study_comparison

        with convert_write_errors(out):
            written = write_study_comparison(comparison, out)
        for path in written:
            note(str(path))


@app.command()
def export(
    study: StudyArgument,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Write the tables there.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
) -> None:
    """Writes campaigns, evaluations and failures of a study as Parquet and CSV."""
    check_folder(out)
    from drivora_service.cli.service.table_files import save_tables
    from drivora_service.studies.table_names import TableForm, TableName

    with open_client(server, data_dir) as client:
        study_id = id_of(client, study, IdKind.STUDY)

        def save(path: Path, table: TableName, form: TableForm) -> None:
            client.save_study_table(path, study_id, table, form=form)

        save_tables(out, TableName, save)


def _post_study(client: Client, file: Path) -> Study:
    """Posts a study file; prints what is wrong with it, each problem with its place."""
    import json

    from drivora_service.cli.campaigns.campaign_starts import resolve_study_starts
    from drivora_service.cli.scenarios.file_problems import read_or_exit
    from drivora_service.cli.studies.study_files import read_study_draft

    def post() -> Study:
        study = read_study_draft(file)
        try:
            # One with problems of its own is refused: it lacks a scenario, and is not begun.
            content = resolve_study_starts(client, dict(study.content), file.parent)
            return client.post_study(json.dumps(content))
        except InvalidDocument as error:
            raise study.in_file(error) from error

    return read_or_exit(file, post)


def _refuse_detaching(detach: bool, server: str) -> None:
    if detach and not server:
        raise ConfigurationError(
            "--detach is for studies of a service (--server): a study of this process ends with it"
        )


def _finish(
    client: Client,
    study: Study,
    server: str,
    data_dir: Path | None,
    *,
    detach: bool,
    form: Form,
) -> None:
    """Follows a study to its end, and shows it."""
    from drivora_service.cli.campaigns.campaign_endings import is_unjudged, unjudged_hint
    from drivora_service.cli.studies.study_display import study_display
    from drivora_service.store.campaigns.study_records import StudyState

    if detach:
        if not form.is_table:
            _show(client, study, form)
        return
    where = f"{study.id} {location(server, data_dir)}".rstrip()
    is_interrupted = False
    try:
        with study_display(study) as display:
            study = client.follow_study(study.id, on_progress=display.show)
    except KeyboardInterrupt as error:
        if server:
            say_interrupted(f"the service continues it; stop it with: drivora study pause {where}")
            raise typer.Exit(ExitCode.INTERRUPTED) from error
        client.pause_study(study.id)
        study = client.follow_study(study.id)
        is_interrupted = True
    except ServiceError:
        # It has been stored, whatever has become of it.
        note(f"study {study.id}: drivora study show {where}")
        raise
    _show(client, study, form)
    is_done = study.state in (StudyState.FINISHED, StudyState.FAILED)
    if is_done and is_unjudged(study.counts):
        note(unjudged_hint("study", study.counts, study.missing_results))
        raise typer.Exit(ExitCode.NOT_DONE)
    if study.state is StudyState.FINISHED:
        return
    if is_interrupted and study.state is StudyState.PAUSED:
        say_interrupted(
            f"the study is paused and its {study.simulations} simulations are kept; resume it "
            f"with: drivora study resume {where}"
        )
        raise typer.Exit(ExitCode.INTERRUPTED)
    if study.state is not StudyState.CANCELLED:
        note(f"{study.state}; resume it with: drivora study resume {where}")
    raise typer.Exit(ExitCode.NOT_DONE)


def _say_state(study: Study, form: Form) -> None:
    if not form.is_table:
        form.print_shape(type(study), study)
        return
    requested = f", {study.request} requested" if study.state.is_active else ""
    say(f"study {study.id} is {study.state}{requested}")


def _show(client: Client, study: Study, form: Form) -> None:
    from drivora_service.cli.studies.study_output import print_study, study_content

    campaigns = tuple(client.campaigns(study_id=study.id))
    if form.is_table:
        print_study(study, campaigns)
    else:
        form.print_content(study_content(study, campaigns))
