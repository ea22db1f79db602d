"""``drivora run`` without a service."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.cli.embedded import network_catalogue, settings_for
from drivora_service.cli.results import invalid_result, result_of
from drivora_service.cli.scenario_files import ScenarioFile
from drivora_service.errors import InvalidDocument
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.running import run_all
from drivora_service.runs.report import RunReport, RunSpec
from drivora_service.scenario.agent_parameters import AgentParameter, with_agent_parameters
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.documents import with_agent
from drivora_service.scenario.validation import validate_document
from drivora_service.settings import Settings
from drivora_service.worker_settings import run_limits, worker_setup


def run_locally(
    files: Sequence[ScenarioFile],
    *,
    agent: str,
    parameters: Sequence[AgentParameter],
    seed: int | None,
    out: Path | None,
    workers: int | None,
    data_dir: Path | None,
    on_result: Callable[[dict[str, Any]], None],
) -> list[dict[str, Any]]:
    """Runs scenarios on worker processes of this machine and gives their results in order.

    Raises:
        UnknownName: There is no agent of that name.
        WorkersCannotStart: Nothing can be run on this machine.
    """
    settings = settings_for(data_dir, workers=workers)
    networks = network_catalogue(settings)
    agents = AgentCatalogue(folder=settings.agents_folder)
    if agent:
        agents.entry(agent)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    results: dict[str, dict[str, Any]] = {}
    specs: list[RunSpec] = []
    notes: dict[str, tuple[str, ...]] = {}
    for file in files:
        try:
            document = with_agent(file.document, agent) if agent else file.document
            valid = validate_document(document, networks, agents.availability())
            scenario = with_agent_parameters(valid.scenario, parameters, agents.availability())
        except InvalidDocument as error:
            results[file.name] = invalid_result(file.name, error.problems)
            on_result(results[file.name])
            continue
        notes[file.name] = (*file.notes, *valid.notes)
        trace = "" if out is None else str((out / f"{file.name}.trace.parquet").resolve())
        specs.append(
            RunSpec(
                run_id=file.name,
                document=canonical_json(scenario),
                trace_path=trace,
                seed=seed,
            )
        )

    for report in _reports(specs, settings):
        name = report.run_id
        written = out is not None and report.trace_sha256
        trace = str(out / f"{name}.trace.parquet") if out is not None and written else ""
        results[name] = result_of(report, name=name, trace=trace, notes=notes[name])
        on_result(results[name])
    return [results[file.name] for file in files]


def _reports(specs: Sequence[RunSpec], settings: Settings) -> Iterator[RunReport]:
    if not specs:
        return
    with (
        tempfile.TemporaryDirectory(prefix="drivora-") as folder,
        LocalExecutor(
            slots=min(settings.workers, len(specs)),
            setup=worker_setup(settings),
            folder=Path(folder),
            limits=run_limits(settings),
        ) as executor,
    ):
        yield from run_all(executor, specs)
