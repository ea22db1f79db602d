"""What the workers do, as the API tells it."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import httpx

from drivora_service.store.runs.run_records import Priority
from tests.api.conftest import Offline
from tests.api.record_examples import LONG
from tests.forked_service import forked_service
from tests.store.samples import claim, finish, finished, register, submit

WORKERS = "/api/v1/workers"


def until(client: httpx.Client, holds: Callable[[Any], bool]) -> Any:
    """Asks until what the workers do is as wanted."""
    deadline = time.monotonic() + 60.0
    while not holds(found := client.get(WORKERS).raise_for_status().json()):
        assert time.monotonic() < deadline, found
        time.sleep(0.05)
    return found


def _is_driving(slot: Mapping[str, Any]) -> bool:
    return bool(slot["state"] == "running" and slot["step"] > 0)


def test_a_slot_tells_what_it_does_and_how_its_worker_died(tmp_path: Path) -> None:
    with (
        forked_service(tmp_path / "data", workers=1) as url,
        httpx.Client(base_url=url, timeout=30) as client,
    ):
        (slot,) = until(client, lambda found: found["slots"][0]["state"] == "idle")["slots"]
        assert slot["is_own"] is True
        assert (slot["name"], slot["run_id"], slot["last_death"]) == ("slot-0", "", None)
        assert slot["memory_bytes"] > 1 << 20
        before = datetime.now(UTC)
        run_id = client.post("/api/v1/jobs", json=LONG).json()["id"]
        found = until(client, lambda found: _is_driving(found["slots"][0]))
        (slot,) = found["slots"]
        assert (slot["state"], slot["run_id"]) == ("running", run_id)
        assert before <= datetime.fromisoformat(slot["since"]) <= datetime.now(UTC)
        loads = {load["priority"]: load["running"] for load in found["queue"]}
        assert loads == {"interactive": 1, "ci": 0, "campaign": 0}
        os.kill(slot["pid"], signal.SIGKILL)
        died = until(client, lambda found: found["slots"][0]["last_death"] is not None)
        (after,) = died["slots"]
        assert "SIGKILL" in after["last_death"]["cause"]
        assert before <= datetime.fromisoformat(after["last_death"]["at"]) <= datetime.now(UTC)
        client.post(f"/api/v1/jobs/{run_id}:cancel")
        idle = until(client, lambda found: found["slots"][0]["state"] == "idle")
        assert idle["slots"][0]["recycled"] > 0
        assert idle["slots"][0]["pid"] not in (None, slot["pid"])
        assert idle["faults"] == []


def test_the_queue_is_told_by_priority_and_what_has_ended_by_time(offline: Offline) -> None:
    database = offline.context.database
    submit(database, 3)
    submit(database, 4, priority=Priority.CI)
    with database.write() as transaction:
        batches = transaction.batches.page().items
        transaction.batches.pause(batches[0].id)
    owner = register(database)
    first, second = claim(database, owner, 2)
    finish(database, owner, finished(first))
    found = offline.client.get(WORKERS).json()
    assert found["queue"] == [
        {"priority": "interactive", "queued": 1, "paused": 0, "running": 1},
        {"priority": "ci", "queued": 0, "paused": 4, "running": 0},
        {"priority": "campaign", "queued": 0, "paused": 0, "running": 0},
    ]
    assert (found["ended_last_minute"], found["ended_last_hour"]) == (1, 1)
    earlier = finished(second)
    object.__setattr__(earlier, "ended", datetime.now(UTC) - timedelta(minutes=30))
    finish(database, owner, earlier)
    found = offline.client.get(WORKERS).json()
    assert (found["ended_last_minute"], found["ended_last_hour"]) == (1, 2)
    # In the words of /readyz.
    assert found["faults"] == [{"name": "workers", "detail": "there are none"}]


def test_slots_of_other_processes_are_as_of_their_heartbeat(offline: Offline) -> None:
    from drivora_service.runs.slot_state import SlotState

    database = offline.context.database
    owner = register(database)
    now = datetime.now(UTC)
    state = SlotState(
        name="slot-0",
        pid=None,
        run_id="",
        phase="starting",
        step=0,
        memory_bytes=0,
        runs=3,
        restarts=2,
        last_crash="died of SIGSEGV",
        updated_at=now,
        since=now - timedelta(seconds=5),
        last_crash_at=now - timedelta(seconds=6),
    )
    with database.write() as transaction:
        transaction.workers.beat(owner, [state])
    (slot,) = offline.client.get(WORKERS).json()["slots"]
    assert (slot["process"], slot["is_own"], slot["state"]) == (owner, False, "starting")
    assert datetime.fromisoformat(slot["since"]) == state.since
    assert slot["last_death"]["cause"] == "died of SIGSEGV"
    assert datetime.fromisoformat(slot["last_death"]["at"]) == state.last_crash_at


def test_what_changes_of_the_workers_is_told_once_a_second_at_most(offline: Offline) -> None:
    database = offline.context.database
    with offline.client.stream("GET", "/api/v1/events?kind=workers") as answer:
        lines = answer.iter_lines()

        def told() -> tuple[str, Any]:
            name = next(line for line in lines if line.startswith("event: "))
            data = next(line for line in lines if line.startswith("data: "))
            return name.removeprefix("event: "), json.loads(data.removeprefix("data: "))

        assert told()[0] == "begin"
        name, first = told()
        assert (name, first) == ("workers", offline.client.get(WORKERS).json())
        begun = time.monotonic()
        for _ in range(5):
            submit(database, 1)
            time.sleep(0.2)
        seen: list[Any] = []
        while not seen or seen[-1]["queue"][0]["queued"] < 5:
            seen.append(told()[1])
        assert len(seen) <= 1 + (time.monotonic() - begun) / 0.9
