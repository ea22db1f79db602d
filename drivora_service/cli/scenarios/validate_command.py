"""``drivora validate``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from drivora_service.cli.application.command_connection import open_client
from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.scenarios.other_files import NO_SCENARIO
from drivora_service.cli.terminal.options import DataDirOption, ServerOption
from drivora_service.cli.terminal.output import JsonOption, fail, print_json, say
from drivora_service.errors import InvalidDocument, Problem


def validate(
    files: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Files and folders.")],
    server: ServerOption = "",
    data_dir: DataDirOption = None,
    as_json: JsonOption = False,
) -> None:
    """Checks scenarios and names every problem with its place; exits with 1 if there is any."""
    with open_client(server, data_dir) as client:
        from drivora_service.cli.scenarios.file_problems import all_problems
        from drivora_service.cli.scenarios.scenario_files import (
            describe_missing,
            find_files,
            read_files,
        )
        from drivora_service.scenario.documents import document_text

        there = [path for path in files if path.exists()]
        missing = [
            _result(
                str(path),
                "",
                (),
                (Problem(pointer="", code="no_file", message=describe_missing(path)),),
            )
            for path in files
            if path not in there
        ]
        scenarios, unreadable = read_files(there, agent="")
        results = [
            _result(str(file.path), "", (), all_problems(file, client)) for file in unreadable
        ]
        for scenario in scenarios:
            path, name = str(scenario.path), scenario.name
            try:
                checked = client.validate_scenario(document_text(scenario.document))
                results.append(_result(path, name, (*scenario.notes, *checked.notes), ()))
            except InvalidDocument as error:
                results.append(_result(path, name, scenario.notes, error.problems))
    order = {str(path): place for place, path in enumerate(find_files(there))}
    results.sort(key=lambda result: order[result["file"]])
    results = [*missing, *results]
    valid = all(result["valid"] for result in results)
    if as_json:
        print_json({"valid": valid, "results": results})
    else:
        _print(results)
    raise typer.Exit(ExitCode.DONE if valid else ExitCode.GATE_FAILED)


def _result(
    path: str, name: str, notes: Sequence[str], problems: Sequence[Problem]
) -> dict[str, Any]:
    return {
        "file": path,
        "scenario": name,
        "valid": not problems,
        "problems": [asdict(problem) for problem in problems],
        "notes": list(notes),
    }


def _print(results: Sequence[dict[str, Any]]) -> None:
    for result in results:
        where = result["file"]
        problems = result["problems"]
        if problems and problems[0]["code"] == NO_SCENARIO:
            fail(f"{where} {problems[0]['message']}")
            continue
        if result["scenario"] and result["scenario"] != Path(where).stem:
            where += f" ({result['scenario']})"
        if result["valid"]:
            say(f"{where}: valid")
        else:
            fail(f"{where}: {len(result['problems'])} problem(s)")
        for problem in result["problems"]:
            say(f"  {problem['pointer'] or '/'}: {problem['message']}")
        for remark in result["notes"]:
            say(f"  note: {remark}")
