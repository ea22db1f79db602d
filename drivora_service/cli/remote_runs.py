"""``drivora run --server``."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from drivora_service.cli.client import ServiceClient
from drivora_service.cli.results import invalid_result, result_of_run
from drivora_service.cli.scenario_files import ScenarioFile
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.documents import document_text

_POLL_S = 0.5
_PARQUET = "application/vnd.apache.parquet"


def run_remotely(
    server: str,
    files: Sequence[ScenarioFile],
    *,
    agent: str,
    parameters: Sequence[str],
    seed: int | None,
    out: Path | None,
    on_result: Callable[[dict[str, Any]], None],
) -> list[dict[str, Any]]:
    """Runs scenarios on a service and gives their results in order.

    Raises:
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    if not files:
        return []
    with ServiceClient(server) as client:
        documents = [document_text(file.document) for file in files]
        try:
            answer = client.post_batch(
                documents, name="drivora run", agent=agent, agent_parameters=parameters, seed=seed
            )
        except InvalidDocument as error:
            return [
                invalid_result(file.name, _of_item(error.problems, item))
                for item, file in enumerate(files)
            ]
        results: dict[int, dict[str, Any]] = {}
        for item in answer["items"]:
            if item["result"] == "rejected":
                problems = [Problem(**problem) for problem in item["problems"]]
                index = item["item"]
                results[index] = invalid_result(files[index].name, problems)
                on_result(results[index])
        while True:
            for job in client.jobs(answer["batch"]["id"]):
                index = job["item"]
                if index in results or job["status"] in ("queued", "running"):
                    continue
                run = client.get(f"/runs/{job['id']}")
                trace = _download(client, run, out, files[index].name)
                results[index] = result_of_run(run, name=files[index].name, trace=trace)
                on_result(results[index])
            if len(results) == len(files):
                return [results[index] for index in range(len(files))]
            client.expect_workers()
            time.sleep(_POLL_S)


def _of_item(problems: Sequence[Problem], item: int) -> list[Problem]:
    """Returns the problems of one scenario of a batch; those of the whole belong to each."""
    prefix = f"/{item}"
    return [
        Problem(pointer=p.pointer.removeprefix(prefix), code=p.code, message=p.message)
        for p in problems
        if p.pointer == "" or p.pointer == prefix or p.pointer.startswith(f"{prefix}/")
    ]


def _download(client: ServiceClient, run: dict[str, Any], out: Path | None, name: str) -> str:
    if out is None or not run["observations_url"]:
        return ""
    out.mkdir(parents=True, exist_ok=True)
    path = out / f"{name}.trace.parquet"
    path.write_bytes(client.download(f"/runs/{run['id']}/observations", accept=_PARQUET))
    return str(path)
