"""What a service answers, as JSON."""

from __future__ import annotations

from typing import Any

JOB: dict[str, Any] = {
    "id": "1",
    "status": "queued",
    "cause": "",
    "label": "",
    "batch_id": "",
    "item": 0,
    "town": "t",
    "agent": "a",
    "configuration": "a",
    "configuration_id": "",
    "seed": None,
    "scenario_sha256": "",
    "created_at": "2026-01-01T00:00:00Z",
    "started_at": None,
    "ended_at": None,
    "cancel_requested": False,
    "attempts": 0,
    "violations": None,
    "at_fault_violations": None,
    "failures": None,
    "observations": None,
    "accountability": None,
    "steps": None,
    "sim_time_s": None,
    "wall_time_s": None,
    "trace_sha256": "",
    "revision": 1,
}

BATCH: dict[str, Any] = {
    "id": "b",
    "name": "",
    "priority": "ci",
    "state": "open",
    "created_at": "2026-01-01T00:00:00Z",
    "size": 1,
    "counts": {"queued": 1},
    "jobs_url": "",
}
