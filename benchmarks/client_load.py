"""Many clients at once: their waiting times, their answers, and the slowdown of the runs.

Three scenes against a service of its own::

    python -m benchmarks.client_load flood --clients 1000    # each repeats at once
    python -m benchmarks.client_load readers --clients 200   # one request a second, with runs
    python -m benchmarks.client_load locked --clients 400    # the database is locked meanwhile

The clients are processes of their own with a connection for each client. A request that cannot
be answered must get 429 or 503 with ``Retry-After``; everything else counts as an error.
"""

from __future__ import annotations

import argparse
import asyncio
import http.client
import itertools
import json
import multiprocessing
import sqlite3
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import numpy as np
import psutil

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.client_connections import raise_descriptor_limit
from drivora_service.cli.application.service_process import run_service

PREFIX = "/api/v1"
_PATIENCE_S = 60.0
_POSTED = 4000
"""Queued runs, more than are done meanwhile."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """The work of one process of clients.

    Attributes:
        pause: Seconds that each client waits between an answer and its next request.
        seconds: How long.
        body: Content in JSON of each request, which is a POST then; empty: it is a GET.
    """

    url: str
    paths: tuple[str, ...]
    clients: int
    pause: float
    seconds: float
    body: bytes = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """The results of the clients.

    Attributes:
        answers: By status; failed connections by the name of the error.
        waits: Seconds of each answer.
        rude: Refusals without ``Retry-After``.
    """

    answers: Counter[str]
    waits: tuple[float, ...]
    rude: int


def ask_for_a_while(load: Load) -> Seen:
    """Runs one process of clients."""
    raise_descriptor_limit()
    return asyncio.run(_run_clients(load))


async def _run_clients(load: Load) -> Seen:
    answers: Counter[str] = Counter()
    waits: list[float] = []
    rude = 0
    address = urlsplit(load.url)
    end = time.monotonic() + load.seconds
    turns = itertools.cycle(load.paths)

    async def client(number: int) -> None:
        nonlocal rude
        # They do not start all at the same moment, but within one pause.
        await asyncio.sleep(load.pause * number / load.clients)
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None
        while time.monotonic() < end:
            began = time.monotonic()
            path = next(turns)
            try:
                async with asyncio.timeout(_PATIENCE_S):
                    if streams is None:
                        streams = await asyncio.open_connection(address.hostname, address.port)
                    head = await _request(*streams, path, load.body)
            except (OSError, EOFError, TimeoutError) as error:
                answers[type(error).__name__] += 1
                head = b""
            if not head or b"connection: close" in head:
                if streams is not None:
                    streams[1].close()
                streams = None
            if head:
                waits.append(time.monotonic() - began)
                answers[head[9:12].decode()] += 1
                refused = head[9:12] in (b"429", b"503")
                rude += refused and b"retry-after:" not in head
                await asyncio.sleep(1.0 if refused else load.pause)
        if streams is not None:
            streams[1].close()

    await asyncio.gather(*(client(number) for number in range(load.clients)))
    return Seen(answers=answers, waits=tuple(waits), rude=rude)


async def _request(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter, path: str, body: bytes
) -> bytes:
    """Sends a request and returns the head of its answer in small letters."""
    head = f"{'POST' if body else 'GET'} {path} HTTP/1.1\r\nHost: localhost\r\n"
    if body:
        head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n"
    writer.write(f"{head}\r\n".encode() + body)
    answer = (await reader.readuntil(b"\r\n\r\n")).lower()
    length = next(
        (int(line[15:]) for line in answer.split(b"\r\n") if line.startswith(b"content-length:")),
        0,
    )
    await reader.readexactly(length)
    return answer


def start(pool: ProcessPoolExecutor, load: Load, processes: int) -> list[Future[Seen]]:
    """Starts the clients, divided among processes."""
    shares = [len(range(index, load.clients, processes)) for index in range(processes)]
    return [
        pool.submit(
            ask_for_a_while,
            Load(
                url=load.url,
                paths=load.paths,
                clients=share,
                pause=load.pause,
                seconds=load.seconds,
                body=load.body,
            ),
        )
        for share in shares
    ]


def report(name: str, parts: Sequence[Seen], seconds: float) -> dict[str, object]:
    """Returns the sum of the results of all processes."""
    answers: Counter[str] = sum((part.answers for part in parts), Counter())
    waits = np.concatenate([part.waits for part in parts]) * 1000
    p50, p95, p99 = np.percentile(waits, (50, 95, 99)) if waits.size else (np.nan,) * 3
    allowed = {"200", "304", "429", "503"}
    errors = sum(count for status, count in answers.items() if status not in allowed)
    return {
        "scene": name,
        "answers": dict(sorted(answers.items())),
        "errors": errors + sum(part.rude for part in parts),
        "requests_per_s": round(waits.size / seconds, 1),
        "p50_ms": round(float(p50), 1),
        "p95_ms": round(float(p95), 1),
        "p99_ms": round(float(p99), 1),
    }


def _count_finished(client: httpx.Client, batch: str) -> int:
    return int(client.get(batch).json()["counts"].get("finished", 0))


def _measure_pace(client: httpx.Client, batch: str, seconds: float) -> float:
    """Measures the finished runs of each second."""
    before, began = _count_finished(client, batch), time.monotonic()
    time.sleep(seconds)
    return (_count_finished(client, batch) - before) / (time.monotonic() - began)


def _measure_health(url: str, seconds: float) -> dict[str, float]:
    """Sends ten requests a second, each over a connection of its own."""
    waits = []
    address = urlsplit(url)
    end = time.monotonic() + seconds
    for path in itertools.cycle(("/healthz", "/readyz")):
        if (began := time.monotonic()) >= end:
            break
        connection = http.client.HTTPConnection(
            address.hostname or "", address.port, timeout=_PATIENCE_S
        )
        connection.request("GET", path)
        connection.getresponse().read()
        connection.close()
        waits.append((time.monotonic() - began) * 1000)
        time.sleep(0.1)
    p50, p99 = np.percentile(waits, (50, 99))
    return {"health_p50_ms": round(float(p50), 1), "health_p99_ms": round(float(p99), 1)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", choices=("flood", "readers", "locked"))
    parser.add_argument("--clients", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--processes", type=int, default=2, help="Of the clients.")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument(
        "--different", action="store_true", help="Hardly any two requests are for the same."
    )
    options = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(options.processes, multiprocessing.get_context("spawn")) as pool,
        run_service(Path(folder) / "data", workers=options.workers) as url,
        httpx.Client(base_url=url, timeout=_PATIENCE_S) as client,
    ):
        server = psutil.Process(json.loads((Path(folder) / "data/service.json").read_text())["pid"])
        job = client.post(f"{PREFIX}/jobs", json=SCENARIO).json()["id"]
        while client.get(f"{PREFIX}/jobs/{job}").json()["status"] != "finished":
            time.sleep(0.1)
        paths: tuple[str, ...] = (
            f"{PREFIX}/jobs/{job}",
            f"{PREFIX}/jobs?limit=20",
            f"{PREFIX}/batches?limit=5",
        )
        if options.different:
            client.post(f"{PREFIX}/batches", json=[SCENARIO] * 450).raise_for_status()
            jobs = client.get(f"{PREFIX}/jobs?limit=450").json()["items"]
            paths = tuple(f"{PREFIX}/jobs/{item['id']}" for item in jobs)
        load = Load(
            url=url,
            paths=paths,
            clients=options.clients,
            pause=1.0 if options.scene == "readers" else 0.0,
            seconds=options.seconds,
        )
        extra: dict[str, object] = {}
        used = sum(server.cpu_times()[:2])
        if options.scene == "readers":
            scenarios = [{**SCENARIO, "seed": seed} for seed in range(_POSTED)]
            batch = client.post(f"{PREFIX}/batches", json=scenarios).headers["Location"]
            alone = _measure_pace(client, batch, options.seconds)
            used = sum(server.cpu_times()[:2])
            running = start(pool, load, options.processes)
            read = _measure_pace(client, batch, options.seconds)
            parts = [future.result() for future in running]
            again = _measure_pace(client, batch, options.seconds)
            extra = {
                "runs_per_s_alone": round((alone + again) / 2, 2),
                "runs_per_s_read": round(read, 2),
                "lost": round(1 - 2 * read / (alone + again), 3) if alone + again else None,
            }
            client.post(f"{batch}:cancel")
        elif options.scene == "locked":
            database = sqlite3.connect(Path(folder) / "data" / "drivora.sqlite3", timeout=30)
            database.isolation_level = None
            database.execute("BEGIN EXCLUSIVE")
            running = start(pool, load, options.processes)
            extra = dict(_measure_health(url, options.seconds))
            database.execute("ROLLBACK")
            database.close()
            parts = [future.result() for future in running]
        else:
            running = start(pool, load, options.processes)
            extra = dict(_measure_health(url, options.seconds))
            parts = [future.result() for future in running]
        seen = report(options.scene, parts, options.seconds)
        asked = sum(sum(part.answers.values()) for part in parts)
        extra["server_cpu_ms_per_request"] = round(
            (sum(server.cpu_times()[:2]) - used) * 1000 / max(asked, 1), 2
        )
        print(json.dumps({**seen, **extra}))


if __name__ == "__main__":
    main()
