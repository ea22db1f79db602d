"""Running the same scenarios twice, as A and as B."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from drivora_service.cli.runs.file_running import run_files
from drivora_service.cli.runs.run_output import ScenarioResult
from drivora_service.cli.scenarios.file_problems import all_problems
from drivora_service.cli.scenarios.scenario_files import read_files
from drivora_service.cli.terminal.run_progress import run_progress
from drivora_service.client import Client
from drivora_service.errors import InvalidDocument, Problem

_NAMES = ("A", "B")


@dataclass(frozen=True, slots=True, kw_only=True)
class SideOptions:
    """The drivers of a side.

    Attributes:
        agent: Agent of every ego; "": as documented.
        parameters: ``NAME=VALUE`` or ``EGO:NAME=VALUE``.
    """

    agent: str
    parameters: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class BothRun:
    """The batches of both sides.

    Attributes:
        a: Id of the batch of A.
        b: Id of the batch of B.
        problems: Why scenarios could not be run, a line each.
    """

    a: str
    b: str
    problems: tuple[str, ...]


def run_as_both(
    client: Client,
    scenarios: Sequence[Path],
    a: SideOptions,
    b: SideOptions,
    *,
    seed: int | None,
    where: str,
) -> BothRun:
    """Runs scenarios as A, then as B, each as a batch.

    Args:
        client: Client of the application or service that runs them.
        scenarios: Files and folders.
        a: Drivers of A.
        b: Drivers of B.
        seed: Overrides the documents'.
        where: Options with which other commands find the runs.

    Raises:
        ConfigurationError: A path, an agent or one of its parameters cannot be used.
        InvalidDocument: No scenario can be run as A, or as B.
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    files, unreadable = read_files(scenarios, agent=a.agent or b.agent)
    lines = [f"{file.path}: {_format_problems(all_problems(file, client))}" for file in unreadable]
    batches: dict[str, str] = {}
    with run_progress(_NAMES, total=len(files)) as count:
        for name, side in zip(_NAMES, (a, b), strict=True):
            results = run_files(
                client,
                files,
                agent=side.agent,
                agent_parameters=side.parameters,
                seed=seed,
                out=None,
                where=where,
                batch_name=f"drivora compare, {name}",
                on_posted=partial(batches.__setitem__, name),
                on_result=partial(_count_result, count, name),
            )
            refused = [result for result in results if result.run is None]
            lines += [
                f"{name}, {one.scenario}: {_format_problems(one.problems)}" for one in refused
            ]
            if name not in batches:
                message = f"no scenario can be run as {name}:\n" + "\n".join(lines)
                raise InvalidDocument((Problem(pointer="", code="no_scenario", message=message),))
    return BothRun(a=batches["A"], b=batches["B"], problems=tuple(lines))


def _count_result(count: Callable[[str], None], name: str, _result: ScenarioResult) -> None:
    count(name)


def _format_problems(problems: Sequence[Problem]) -> str:
    return "; ".join(f"{one.pointer or '/'}: {one.message}" for one in problems)
