"""Runs of scenario files, in this process or on a service."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Unpack

from drivora_service.api.schemas.batches import BatchItem, ItemResult
from drivora_service.cli.runs.run_output import ScenarioResult
from drivora_service.cli.scenarios.scenario_files import ScenarioFile
from drivora_service.cli.terminal.interruption import say_interrupted
from drivora_service.cli.terminal.out_option import write_result
from drivora_service.cli.terminal.output import note
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.client import Client
from drivora_service.client.calls.jobs import PostOptions
from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.scenario.documents import document_text
from drivora_service.store.runs.run_records import Priority

RUN_BATCH = "drivora run"
"""Name of a batch of ``drivora run``, unless the user gives one."""
_SCENARIO = "/scenario"
"""Place of a scenario in an item of a batch with labels."""


def run_files(
    client: Client,
    files: Sequence[ScenarioFile],
    *,
    out: Path | None,
    where: str,
    on_result: Callable[[ScenarioResult], None],
    seeds: Sequence[int | None] | None = None,
    definitions: Sequence[FailureDefinition] | None = None,
    batch_name: str = RUN_BATCH,
    priority: Priority = Priority.INTERACTIVE,
    on_posted: Callable[[str], None] = lambda _batch_id: None,
    **options: Unpack[PostOptions],
) -> list[ScenarioResult]:
    """Runs scenarios as one batch and returns their results in the order of the files.

    Args:
        client: Client of the application or service that runs them.
        files: The scenarios.
        out: Folder for the traces and reports, each written when its run has ended; ``None``: they
            are not written.
        where: Options with which other commands find the runs.
        on_result: Called with each result, in any order.
        seeds: Seed of each file's run in place of the options'; ``None``: none has its own.
        definitions: What is a failure of each file's run; ``None``: as the options say.
        batch_name: Display name of the batch.
        priority: Priority of the runs.
        on_posted: Called with the id of the batch once it is queued.
        options: As :meth:`Client.post_batch` takes them.

    Raises:
        ConfigurationError: The agent or one of its parameters cannot be used.
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    if not files:
        return []

    def handle_result(result: ScenarioResult) -> None:
        if out is not None:
            write_report(out, result)
        on_result(result)

    try:
        posted = client.post_batch(
            [document_text(file.document) for file in files],
            labels=[file.name for file in files],
            seeds=seeds,
            definitions=definitions,
            name=batch_name,
            priority=priority,
            **options,
        )
    except InvalidDocument as error:
        if all(not problem.pointer for problem in error.problems):
            # The request itself is wrong, such as the name of the agent.
            raise ConfigurationError(str(error.problems[0].message)) from error
        refused = [
            ScenarioResult(
                scenario=file.name,
                problems=problems_of_item(error.problems, item),
                notes=file.notes,
            )
            for item, file in enumerate(files)
        ]
        for result in refused:
            handle_result(result)
        return refused
    on_posted(posted.batch.id)
    results = {item.item: _make_result(item, files[item.item]) for item in posted.items}
    for item in posted.items:
        if item.result is ItemResult.REJECTED:
            handle_result(results[item.item])
    with note_batch_on_stop(posted.batch.id, where):
        for run in client.wait_for_batch(posted.batch.id):
            trace = ""
            if out is not None and run.observations_url:
                path = out / f"{files[run.item].name}.trace.parquet"
                client.save_run_observations(path, run.id)
                give_to_user(path)
                trace = str(path)
            results[run.item] = replace(results[run.item], run=run, trace=trace)
            handle_result(results[run.item])
    return [results[item] for item in range(len(files))]


def write_report(folder: Path, result: ScenarioResult) -> None:
    """Writes the report of a scenario into a folder, which is made if it is missing."""
    name = Path(result.scenario).stem
    text = json.dumps(result.content(), indent=2, ensure_ascii=False)
    write_result(folder / f"{name}.report.json", text + "\n")


@contextmanager
def note_batch_on_stop(batch_id: str, where: str) -> Iterator[None]:
    """Prints how to find the runs of a batch if the command does not wait for all of them."""
    found = f"its runs: drivora runs list --batch {batch_id} {where}".rstrip()
    try:
        yield
    except KeyboardInterrupt:
        is_on_service = where.startswith("--server")
        others = "the service continues the others" if is_on_service else "the others are cancelled"
        say_interrupted(f"runs that have ended are kept, {others}; {found}")
        raise
    except BaseException:
        note(found)
        raise


def _make_result(item: BatchItem, file: ScenarioFile) -> ScenarioResult:
    return ScenarioResult(
        scenario=file.name,
        problems=tuple(
            Problem(pointer=_in_file(p.pointer), code=p.code, message=p.message)
            for p in item.problems
        ),
        notes=(*file.notes, *item.notes),
    )


def problems_of_item(problems: Sequence[Problem], item: int) -> tuple[Problem, ...]:
    """Returns the problems of one scenario of a batch; those of the whole belong to each."""
    prefix = f"/{item}"
    return tuple(
        Problem(pointer=_in_file(p.pointer.removeprefix(prefix)), code=p.code, message=p.message)
        for p in problems
        if p.pointer == "" or p.pointer == prefix or p.pointer.startswith(f"{prefix}/")
    )


def _in_file(pointer: str) -> str:
    """Returns a place in an item of a batch as one in the scenario of the item."""
    return pointer.removeprefix(_SCENARIO)
