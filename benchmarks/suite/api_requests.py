"""Requests a second of a real server, over HTTP."""

from __future__ import annotations

import json
import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager

import httpx
import numpy as np

from benchmarks.client_load import PREFIX, Load, start
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.result import Better, ResultError
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.cli.application.service_process import run_service

_CLIENTS = 8
_BATCH = 100


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    with (
        run_service(plan.folder / "data", workers=1) as url,
        ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool,
        httpx.Client(base_url=url, timeout=60.0) as client,
    ):
        job = client.post(f"{PREFIX}/jobs", json=SCENARIO).raise_for_status().json()["id"]
        client.post(f"{PREFIX}/batches", json=[SCENARIO] * 20).raise_for_status()
        while client.get(f"{PREFIX}/jobs?status=queued&limit=1").json()["items"]:
            time.sleep(0.1)
        body = json.dumps(SCENARIO).encode()
        batch = json.dumps([SCENARIO] * _BATCH).encode()
        requests = {
            "GET /healthz": ("/healthz", b""),
            "GET /jobs/ID": (f"{PREFIX}/jobs/{job}", b""),
            "GET /jobs?limit=20": (f"{PREFIX}/jobs?limit=20", b""),
            "GET /batches?limit=5": (f"{PREFIX}/batches?limit=5", b""),
            "POST /scenarios:validate": (f"{PREFIX}/scenarios:validate", body),
        }
        seconds = 0.5 if plan.short else 3.0
        # The pool's process starts with its first work.
        _ask(pool, url, "/healthz", b"", 0.2)

        def once() -> Iterator[Sample]:
            for name, (path, sent) in requests.items():
                rate, p99 = _ask(pool, url, path, sent, seconds)
                yield sample(name, "rate", rate, "requests/s", Better.HIGHER)
                yield sample(name, "p99", p99, "ms")
            begun = time.perf_counter()
            answer = client.post(
                f"{PREFIX}/batches", content=batch, headers={"Content-Type": "application/json"}
            )
            took = time.perf_counter() - begun
            client.post(f"{answer.raise_for_status().headers['Location']}:cancel")
            name = f"POST /batches of {_BATCH} scenarios"
            yield sample(name, "rate", _BATCH / took, "scenarios/s", Better.HIGHER)

        yield once


def _ask(
    pool: ProcessPoolExecutor, url: str, path: str, body: bytes, seconds: float
) -> tuple[float, float]:
    """Returns the answers a second, and the 99th percentile of the waits in milliseconds.

    Raises:
        ResultError: An answer was none with status 200.
    """
    load = Load(url=url, paths=(path,), clients=_CLIENTS, pause=0.0, seconds=seconds, body=body)
    (seen,) = (future.result() for future in start(pool, load, 1))
    if set(seen.answers) != {"200"}:
        raise ResultError(f"{path} was answered with {dict(seen.answers)}; 200 is expected")
    return len(seen.waits) / seconds, 1e3 * float(np.percentile(seen.waits, 99))


API = Measurement(
    name="api",
    title="Requests over HTTP",
    about=f"A real server with one worker; {_CLIENTS} clients of one process repeat a request "
    "without a pause, on the cores of the server. Only answers with status 200 are counted. "
    "Equal questions at the same time are answered once.",
    open=_open,
)
