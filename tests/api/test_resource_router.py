"""Large bodies that FastAPI checks itself."""

from __future__ import annotations

import json
import time

import pytest

from tests.api.conftest import Offline

RUN = "01a1bcbee3570d3ff8ce5b8e"


@pytest.mark.parametrize(
    "path", [f"/api/v1/runs/{RUN}:minimize", "/api/v1/suite-runs", "/api/v1/failures/groups:merge"]
)
def test_of_very_many_mistakes_the_first_are_listed(offline: Offline, path: str) -> None:
    body = json.dumps({f"k{number}": 0 for number in range(12_000)})
    client = offline.client
    client.post(path, json={"unknown": 1})
    begun = time.process_time()
    answer = client.post(path, content=body, headers={"Content-Type": "application/json"})
    assert time.process_time() - begun < 1.0
    assert answer.status_code == 422
    problems = answer.json()["problems"]
    assert len(problems) == 101
    assert "further problems are not listed" in problems[-1]["message"]
    assert {problem["code"] for problem in problems} <= {
        "extra_forbidden",
        "missing",
        "more_problems",
    }
