"""Everything that is wrong with a scenario file, also beyond what keeps it from being read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer

from drivora_service.cli.exit_codes import ExitCode
from drivora_service.cli.terminal.output import fail, say
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.importers.reading import FileFormat, detect_format

if TYPE_CHECKING:
    from drivora_service.cli.scenarios.scenario_files import UnreadableFile
    from drivora_service.client import Client

_First = TypeVar("_First")
_Second = TypeVar("_Second")


def all_problems(file: UnreadableFile, client: Client) -> tuple[Problem, ...]:
    """Returns what is wrong with a file, its well-formed parts checked against the road network.

    Args:
        file: The file.
        client: Client of the application or service that checks it.
    """
    if file.other:
        return file.problems
    try:
        data = file.path.read_bytes()
        match detect_format(data):
            case FileFormat.JSON:
                client.validate_scenario(data)
            case FileFormat.YAML:
                client.validate_scenario(data, language="yaml")
    except InvalidDocument as error:
        # An imported format, or results of a command, has problems of its own.
        return error.problems
    except OSError:
        return file.problems
    return file.problems


def print_problems(file: Path | str, problems: tuple[Problem, ...]) -> None:
    """Prints what is wrong with a file, each problem with its place, to standard error."""
    fail(f"{file}: {len(problems)} problem(s)")
    for problem in problems:
        say(f"  {problem.pointer or '/'}: {problem.message}", is_error=True)


def read_or_exit(file: Path | str, read: Callable[[], _First]) -> _First:
    """Reads a file; prints every problem and ends the command if it has any.

    Args:
        file: Its path.
        read: Reads it; raises ``InvalidDocument`` if it has problems.
    """
    try:
        return read()
    except InvalidDocument as error:
        print_problems(file, error.problems)
        raise typer.Exit(ExitCode.USAGE_ERROR) from error


def read_both_or_exit(
    first: tuple[Path | str, Callable[[], _First]],
    second: tuple[Path | str, Callable[[], _Second]],
) -> tuple[_First, _Second]:
    """Reads two files as :func:`read_or_exit`; prints the problems of both."""
    try:
        one = first[1]()
    except InvalidDocument as error:
        print_problems(first[0], error.problems)
        read_or_exit(*second)
        raise typer.Exit(ExitCode.USAGE_ERROR) from error
    return one, read_or_exit(*second)
