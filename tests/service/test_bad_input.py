"""Every broken document over HTTP: refused, the place named, and no other request affected."""

from __future__ import annotations

import copy
import json

import httpx

from tests.scenario.conftest import GOOD
from tests.scenario.test_bad_input import BROKEN


def test_the_service_refuses_every_broken_document(service_url: str) -> None:
    wrong = []
    with httpx.Client(base_url=f"{service_url}/api/v1", timeout=30.0) as client:
        for name, (change, pointer) in BROKEN.items():
            content = change(copy.deepcopy(GOOD))
            body = content if isinstance(content, str | bytes) else json.dumps(content)
            answer = client.post(
                "/jobs", content=body, headers={"Content-Type": "application/json"}
            )
            problem = answer.json()
            is_problem = answer.headers["Content-Type"].startswith("application/problem+json")
            pointers = [p["pointer"] for p in problem.get("problems", [])]
            # A body beyond the limit is refused before it is read.
            named = answer.status_code == 413 or pointer in pointers
            if not (400 <= answer.status_code < 500 and is_problem and named):
                wrong.append((name, answer.status_code, pointers))
        good = client.post("/jobs", json=GOOD)
    assert len(BROKEN) >= 40
    assert wrong == []
    assert good.status_code == 202
