from __future__ import annotations

from typing import Any

import pytest
from fastapi import Request

from drivora_service.api.guards.idempotency_keys import Answer, Work, run_once
from drivora_service.api.problem_details import ApiError
from tests.api.conftest import Offline

KEY = {"Idempotency-Key": "the-first-of-monday"}


def test_a_repeated_request_is_answered_as_the_first_time(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    first = offline.client.post("/api/v1/jobs", json=scenario, headers=KEY)
    second = offline.client.post("/api/v1/jobs", json=scenario, headers=KEY)
    assert (second.status_code, second.content) == (202, first.content)
    assert second.headers["Location"] == first.headers["Location"]
    assert second.headers["Idempotency-Replayed"] == "true"
    assert len(offline.client.get("/api/v1/jobs").json()["items"]) == 1


def test_another_body_under_the_same_key_is_refused(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    offline.client.post("/api/v1/jobs", json=scenario, headers=KEY)
    other = offline.client.post("/api/v1/jobs", json={**scenario, "seed": 2}, headers=KEY)
    assert other.status_code == 422
    elsewhere = offline.client.post("/api/v1/batches", json=[scenario], headers=KEY)
    assert elsewhere.status_code == 202


def test_a_refused_request_leaves_the_key_free(offline: Offline, scenario: dict[str, Any]) -> None:
    assert offline.client.post("/api/v1/jobs", json={}, headers=KEY).status_code == 422
    assert offline.client.post("/api/v1/jobs", json=scenario, headers=KEY).status_code == 202


def test_a_request_that_comes_while_the_first_is_being_done(offline: Offline) -> None:
    scope = {
        "type": "http",
        "method": "POST",
        "path": "/api/v1/jobs",
        "query_string": b"",
        "headers": [],
        "app": offline.app,
        "state": {},
    }
    request = Request(scope)
    work = Work(commit=lambda _: Answer(status=202, headers={}, body="{}"))

    def prepare() -> Work:
        with pytest.raises(ApiError) as refused:
            run_once(request, offline.context, "key", b"body", lambda: work)
        assert refused.value.status == 409
        return work

    assert run_once(request, offline.context, "key", b"body", prepare).status_code == 202
