"""A reader of a real service's events, over its death, its restart and its shutdown."""

from __future__ import annotations

import signal
import socket
import threading
import time
from pathlib import Path

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.schemas.events import Begin, Changes
from drivora_service.client import Client, Event
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.changes.change_lists import ChangedKind
from drivora_service.store.database import open_database
from tests.forked_service import killed_service

RUNS = 120
KILLS = 2


def free_port() -> int:
    """A port that nothing listens at."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
        return port


@pytest.mark.slow(seconds=25)
def test_a_reader_misses_no_end_of_a_run_however_often_the_service_is_killed(
    tmp_path: Path,
) -> None:
    port = free_port()
    url = f"http://127.0.0.1:{port}"
    told: dict[str, str] = {}
    begun: list[Event] = []
    finished = threading.Event()

    def listen(client: Client, batch_id: str) -> None:
        for event in client.events([ChangedKind.RUN, ChangedKind.BATCH], of=batch_id):
            if isinstance(event.data, Begin):
                begun.append(event)
            if isinstance(event.data, Changes):
                for change in event.data.changes:
                    told[change.id] = change.status
            ended = sum(status == RunStatus.FINISHED for status in told.values())
            if ended == RUNS:
                finished.set()
                return

    batch_id = ""
    with Client(url, retry_s=120.0) as client:
        for kill in range(KILLS):
            with killed_service(tmp_path, port=port):
                if not kill:
                    # Nobody listens yet while the first runs are queued: they are told, too.
                    documents = [{**SCENARIO, "seed": seed} for seed in range(RUNS)]
                    posted = client.post_batch(documents)
                    batch_id = posted.batch.id
                    told[batch_id] = RunStatus.QUEUED
                    for item in posted.items:
                        told[item.job_id] = RunStatus.QUEUED
                    listener = threading.Thread(target=listen, args=(client, batch_id))
                    listener.start()
                before = len([s for s in told.values() if s == RunStatus.FINISHED])
                deadline = time.monotonic() + 60.0
                while len([s for s in told.values() if s == RunStatus.FINISHED]) < before + 5:
                    assert time.monotonic() < deadline
                    time.sleep(0.01)
            assert not finished.is_set(), "too few runs are left to be interrupted"
        with killed_service(tmp_path, port=port):
            assert finished.wait(120.0), told
        listener.join()
    database = open_database(f"sqlite:///{tmp_path / 'drivora.sqlite3'}")
    with database.read() as transaction:
        jobs = transaction.jobs.page(limit=500).items
        batch = transaction.batches.get(batch_id)
    database.close()
    assert len(begun) == KILLS + 1
    assert batch.done
    assert {job.id: job.status for job in jobs} == {
        run_id: status for run_id, status in told.items() if run_id != batch_id
    }


def test_streams_end_at_once_when_the_service_is_stopped(tmp_path: Path) -> None:
    with (
        killed_service(tmp_path) as (server, url),
        httpx.Client(base_url=url, timeout=30.0) as client,
        client.stream("GET", "/api/v1/events?kind=run") as answer,
        client.stream("GET", "/api/v1/events?kind=run") as other,
    ):
        parts = [stream.iter_bytes() for stream in (answer, other)]
        assert all(next(part).startswith(b"event: begin") for part in parts)
        server.send_signal(signal.SIGTERM)
        begun = time.monotonic()
        # The end of the body, not a broken connection.
        assert all(list(part) == [] for part in parts)
        # The server would else wait 5 s for answers that go on.
        assert time.monotonic() - begun < 4.0
        assert server.wait(30.0) == 0
