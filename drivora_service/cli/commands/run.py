"""``drivora run``."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.options import DataDirOption, GateRuleOption, ServerOption
from drivora_service.cli.output import JsonOption, fail, note, print_json
from drivora_service.errors import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Callable

    from drivora_service.cli.gates import Gate
    from drivora_service.scenario.agent_parameters import AgentParameter

_MAX_SEED = 2**31 - 1


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
        str, typer.Option(help="Drives every ego in place of the documented one.")
    ] = "",
    agent_parameter: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="Set a parameter of every ego's agent, or of one's: EGO:NAME=VALUE. Repeatable; "
            "a value that is no JSON is text.",
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, max=_MAX_SEED, help="Seed in place of the documents'.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write a trace and a report of each run there."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Worker processes [default: one a core].")
    ] = None,
    gate: Annotated[
        bool,
        typer.Option(
            "--gate",
            help="Exit with 1 if any run broke a rule (observations left out) in a way that an ego "
            "is accountable for.",
        ),
    ] = False,
    gate_rule: GateRuleOption = None,
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Runs scenarios and judges them; exits with 3 if any could not be run to its end.

    With --json, one scenario prints one object with status, verdicts, metrics, scores,
    trace_sha256, steps, sim_time_s, wall_time_s, step_cost_us and, by ego, agent_cost_us; several
    print {"runs": […]}.
    """
    chosen = _gate(gate_rule or ()) if gate or gate_rule else None
    if not server:
        from drivora_service.execution.fork_server import prepare_processes

        # They get ready while this process reads and checks what they are to do.
        prepare_processes()
    from drivora_service.cli import results
    from drivora_service.cli.scenario_files import read_files

    parameters = _parameters(agent_parameter or ())
    files, unreadable = read_files(scenarios, agent=agent)
    done = [results.invalid_result(str(file.path), file.problems) for file in unreadable]
    with _progress(len(files), shown=len(files) > 1) as step:
        if server:
            from drivora_service.cli.remote_runs import run_remotely

            done += run_remotely(
                server,
                files,
                agent=agent,
                parameters=agent_parameter or (),
                seed=seed,
                out=out,
                on_result=step,
            )
        else:
            from drivora_service.cli.local_runs import run_locally

            done += run_locally(
                files,
                agent=agent,
                parameters=parameters,
                seed=seed,
                out=out,
                workers=workers,
                data_dir=data_dir,
                on_result=step,
            )
    if out is not None:
        _write_reports(out, done)
    if as_json:
        print_json(done[0] if len(done) == 1 else {"runs": done})
    elif len(done) == 1:
        results.print_result(done[0])
    else:
        results.print_results(done)
    if any(result["status"] != results.FINISHED for result in done):
        raise typer.Exit(ExitCode.NOT_DONE)
    if chosen is not None:
        from drivora_service.cli.gates import broken_in_result

        answer = chosen.judge(broken_in_result(results.violations(result)) for result in done)
        note(str(answer))
        if answer.fails:
            raise typer.Exit(ExitCode.GATE_FAILED)


def _gate(rules: Sequence[str]) -> Gate:
    from drivora_service.cli.gates import read_gate
    from drivora_service.oracles.catalogue import OracleCatalogue

    try:
        return read_gate(rules, OracleCatalogue().names(), whose="there is")
    except ConfigurationError as error:
        fail(str(error))
        raise typer.Exit(ExitCode.WRONG_USE) from error


def _parameters(texts: Sequence[str]) -> tuple[AgentParameter, ...]:
    from drivora_service.errors import InvalidDocument
    from drivora_service.scenario.agent_parameters import read_agent_parameter

    try:
        return tuple(read_agent_parameter(text) for text in texts)
    except InvalidDocument as error:
        message = error.problems[0].message
        raise typer.BadParameter(message, param_hint="--agent-parameter") from error


@contextmanager
def _progress(total: int, *, shown: bool) -> Iterator[Callable[[dict[str, Any]], None]]:
    """Shows progress on standard error while runs end."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("runs"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), disable=not shown) as progress:
        task = progress.add_task("runs", total=total)
        yield lambda _result: progress.advance(task)


def _write_reports(folder: Path, results: Sequence[dict[str, Any]]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for result in results:
        name = Path(result["scenario"]).stem
        text = json.dumps(result, indent=2, ensure_ascii=False)
        (folder / f"{name}.report.json").write_text(text + "\n")
