"""``drivora run``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.options import (
    AgentParameterOption,
    DataDirOption,
    GateOracleOption,
    PostedCountsOption,
    ServerOption,
    WorkersOption,
    location,
    parse_counts,
)
from drivora_service.cli.terminal.out_option import check_folder
from drivora_service.cli.terminal.output import fail, note
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms
from drivora_service.cli.terminal.run_progress import run_progress
from drivora_service.errors import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Callable

    from drivora_service.cli.runs.run_gates import Gate
    from drivora_service.cli.runs.run_output import ScenarioResult
    from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition

_MAX_SEED = 2**31 - 1


@with_forms
def run(
    scenarios: Annotated[
        list[Path],
        typer.Argument(
            metavar="SCENARIO…",
            help="Files or folders: OpenScenario (JSON, YAML), files of the original tool, "
            "Leaderboard routes (XML).",
        ),
    ],
    agent: Annotated[
        str, typer.Option(help="Agent of every ego, overrides the documented one.")
    ] = "",
    agent_parameter: AgentParameterOption = None,
    seed: Annotated[
        int | None, typer.Option(min=0, max=_MAX_SEED, help="Seed, overrides the documents'.")
    ] = None,
    name: Annotated[
        str,
        typer.Option(
            metavar="TEXT",
            help="Name of the batch of runs, for the page and `drivora compare` [default: drivora "
            "run].",
        ),
    ] = "",
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write a trace and a report of each run there."),
    ] = None,
    workers: WorkersOption = None,
    gate: Annotated[
        bool,
        typer.Option(
            "--gate",
            help="Exit with 1 if any run has a failure: a violation that --counts counts, "
            "observations left out, or a failure of the ADS itself.",
        ),
    ] = False,
    gate_oracle: GateOracleOption = None,
    counts: PostedCountsOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    form: Form = TABLE,
) -> None:
    """Runs scenarios and judges them; exits with 3 if any could not be run to its end.

    With --gate, a run in which the ADS itself failed is a failing run, and the exit code is 1.

    With --json, one scenario prints one object: the run as the API shows it, with `scenario`,
    `trace` and `notes`; several print {"batch_id": …, "runs": […]}.
    """
    counted = parse_counts(counts)
    chosen = _gate(gate_oracle or (), counted, data_dir) if gate or gate_oracle else None
    check_folder(out)
    where = location(server, data_dir)
    with open_client(server, data_dir, works=True, makes_data=True, workers=workers) as client:
        from drivora_service.cli.runs import run_output
        from drivora_service.cli.runs.file_running import RUN_BATCH, run_files, write_report
        from drivora_service.cli.scenarios.file_problems import all_problems
        from drivora_service.cli.scenarios.scenario_files import folder_sentence, read_files
        from drivora_service.runs.run_report import RunStatus

        _check_parameters(agent_parameter or ())
        files, unreadable = read_files(scenarios, agent=agent)
        if not files and unreadable and all(file.other for file in unreadable):
            raise ConfigurationError("\n".join(file.other for file in unreadable))
        if any(path.is_dir() for path in scenarios):
            note(folder_sentence(files))
        done = [
            run_output.ScenarioResult(scenario=str(file.path), problems=all_problems(file, client))
            for file in unreadable
        ]
        if out is not None:
            for result in done:
                write_report(out, result)
        batches: list[str] = []
        with _progress(len(files), shown=len(files) > 1) as step:
            done += run_files(
                client,
                files,
                agent=agent,
                agent_parameters=agent_parameter or (),
                seed=seed,
                definition=_definition(chosen, counted),
                out=out,
                where=where,
                on_result=step,
                batch_name=name or RUN_BATCH,
                on_posted=batches.append,
            )
    batch_id = "".join(batches)
    if form.is_table:
        run_output.say_notes(done)
    if not form.is_table:
        told = [result.content() for result in done]
        form.print_content(
            told[0] if len(told) == 1 else {"batch_id": batch_id, "runs": told}, told
        )
    elif len(done) == 1:
        run_output.print_result(done[0], where=where)
    else:
        run_output.print_results(done)
        if batch_id:
            note(f"batch {batch_id}")
    unfinished = [result for result in done if result.status is not RunStatus.FINISHED]
    agent_failed = [one for one in unfinished if one.status is RunStatus.AGENT_FAILED]
    # A gate decides on runs that say something about the ADS only.
    if unfinished and (chosen is None or len(agent_failed) < len(unfinished)):
        raise typer.Exit(ExitCode.NOT_DONE)
    if chosen is not None:
        from drivora_service.cli.runs.run_gates import print_answer

        print_answer(
            chosen.judge(
                (one.violations for one in done if one.status is RunStatus.FINISHED),
                agent_failed=[one.scenario for one in agent_failed],
            )
        )


def _definition(gate: Gate | None, counted: Counted | None) -> FailureDefinition:
    """Returns what is a failure of the runs: what the gate counts, if there is one."""
    from drivora_service.oracles.verdicts.failure_definition import (
        DEFAULT_DEFINITION,
        requested_definition,
    )

    if gate is not None:
        return gate.definition
    return requested_definition(counted, ()) or DEFAULT_DEFINITION


def _gate(wanted: Sequence[str], counted: Counted | None, data_dir: Path | None) -> Gate:
    from drivora_service.cli.application.installation import oracle_catalogue, settings_for
    from drivora_service.cli.runs.run_gates import read_gate

    known = oracle_catalogue(settings_for(data_dir)).names()
    try:
        return read_gate(wanted, known, counted_by="Drivora", counts=counted)
    except ConfigurationError as error:
        fail(str(error))
        raise typer.Exit(ExitCode.USAGE_ERROR) from error


def _check_parameters(texts: Sequence[str]) -> None:
    """Refuses what is no ``NAME=VALUE`` before any file is read."""
    from drivora_service.errors import InvalidDocument
    from drivora_service.scenario.agent_parameters import read_agent_parameter

    try:
        for text in texts:
            read_agent_parameter(text)
    except InvalidDocument as error:
        message = error.problems[0].message
        raise typer.BadParameter(message, param_hint="--agent-parameter") from error


@contextmanager
def _progress(total: int, *, shown: bool) -> Iterator[Callable[[ScenarioResult], None]]:
    """Shows progress on standard error while runs end."""
    if not shown:
        yield lambda _result: None
        return
    with run_progress(["runs"], total=total) as count:
        yield lambda _result: count("runs")
