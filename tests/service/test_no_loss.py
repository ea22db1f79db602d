"""A real server with real runs, killed again and again in the middle of a batch."""

from __future__ import annotations

import json
import random
import time
from collections import Counter
from pathlib import Path

import httpx
import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.store.database import open_database
from tests.forked_service import forked_service, killed_service

# Many more than two workers judge between the kills, however fast they are.
RUNS = 240
KILLS = 3


def batch_lines() -> str:
    """Returns short drives."""
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    seeds = generate_seeds(network, count=20, min_length=60, max_length=150, seed=4, agent="idm")
    documents = [json.loads(document_text(seed)) for seed in seeds]
    return "\n".join(json.dumps(documents[n % 20] | {"seed": n}) for n in range(RUNS))


@pytest.mark.slow(seconds=30)
def test_every_run_is_judged_exactly_once(tmp_path: Path) -> None:
    lines, luck = batch_lines(), random.Random(11)
    batch = ""
    interrupted = 0
    for kill in range(KILLS):
        with killed_service(tmp_path) as (_, url), httpx.Client(timeout=60.0) as client:
            if kill == 0:
                answer = client.post(
                    f"{url}/api/v1/batches",
                    content=lines,
                    headers={"Content-Type": "application/x-ndjson"},
                )
                batch = answer.raise_for_status().json()["batch"]["id"]
            # At any moment of the workers' work, however fast they are.
            _wait_until_done(client, f"{url}/api/v1/batches/{batch}", luck.randrange(3, 12))
            time.sleep(luck.uniform(0.0, 0.3))
        interrupted += _statuses(tmp_path)[RunStatus.RUNNING]
    with (
        forked_service(tmp_path, workers=2) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client,
    ):
        deadline = time.monotonic() + 240.0
        while not client.get(f"/batches/{batch}").raise_for_status().json()["done"]:
            assert time.monotonic() < deadline
            time.sleep(0.2)
        counts = client.get(f"/batches/{batch}").json()["counts"]
    assert interrupted > 0
    assert {status: n for status, n in counts.items() if n} == {"finished": RUNS}
    assert _statuses(tmp_path) == {RunStatus.FINISHED: RUNS}


def _wait_until_done(client: httpx.Client, batch: str, more: int) -> None:
    """Waits until so many more runs of a batch have ended than now."""
    wanted = _ended(client, batch) + more
    assert wanted <= RUNS, "too few runs are left to be interrupted"
    deadline = time.monotonic() + 120.0
    while _ended(client, batch) < wanted:
        assert time.monotonic() < deadline
        time.sleep(0.01)


def _ended(client: httpx.Client, batch: str) -> int:
    counts: dict[str, int] = client.get(batch).raise_for_status().json()["counts"]
    return sum(counts.get(status, 0) for status in RunStatus if status.is_final)


def _statuses(folder: Path) -> Counter[RunStatus]:
    """Counts runs by status; a run has a report exactly if it is final."""
    database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
    try:
        with database.read() as transaction:
            jobs = transaction.jobs.page(limit=1000).items
            reports = transaction.jobs.reports([job.id for job in jobs])
    finally:
        database.close()
    assert set(reports) == {job.id for job in jobs if job.status.is_final}
    return Counter(job.status for job in jobs)
