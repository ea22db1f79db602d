"""The application of a command: its workers and its runs."""

from __future__ import annotations

import time
from pathlib import Path

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.client import ApplicationTransport, Client
from drivora_service.command_app import create_command_app
from drivora_service.settings import load_settings


def test_more_runs_get_more_workers(tmp_path: Path) -> None:
    application = create_command_app(load_settings(data_dir=tmp_path / "data"), workers=2)
    with Client(transport=ApplicationTransport(application)) as client:
        first = client.post_batch([SCENARIO]).batch
        (alone,) = client.wait_for_batch(first.id)
        assert [one.worker for one in alone.tries] == ["slot-0"]
        workers = set[str]()
        deadline = time.monotonic() + 120.0
        # The second worker takes its time to start.
        while workers != {"slot-0", "slot-1"}:
            assert time.monotonic() < deadline, workers
            then = client.post_batch([SCENARIO] * 12).batch
            workers |= {run.tries[0].worker for run in client.wait_for_batch(then.id)}
