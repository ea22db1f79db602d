"""Suites that were run over HTTP."""

from __future__ import annotations

import copy
from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SUITE_RUN_REQUEST
from tests.api.conftest import Offline
from tests.api.test_problem_details import is_problem

Json = dict[str, Any]


def request(**changes: Any) -> Json:
    wanted = copy.deepcopy(SUITE_RUN_REQUEST)
    wanted["decision"] |= changes
    return wanted


def test_what_a_gate_decided_is_kept(http: httpx.Client) -> None:
    answer = http.post("/api/v1/suite-runs", json=request(suite="nightly"))
    assert answer.status_code == 201, answer.text
    kept = answer.json()
    assert http.get(answer.headers["Location"]).json() == kept
    assert kept["sentence"] == SUITE_RUN_REQUEST["decision"]["sentence"]
    assert [one["scenario"] for one in kept["outcomes"]] == ["cut-in", "left-turn"]
    again = http.post("/api/v1/suite-runs", json=request(suite="nightly", fails=False)).json()
    listed = http.get("/api/v1/suite-runs", params={"suite": "nightly"}).json()["items"]
    assert [one["id"] for one in listed] == [again["id"], kept["id"]]
    suites = {one["suite"]: one for one in http.get("/api/v1/suites").json()["items"]}
    assert (suites["nightly"]["runs"], suites["nightly"]["last"]["fails"]) == (2, False)
    history = http.get("/api/v1/suites:history", params={"suite": "nightly"}).json()
    assert [one["id"] for one in history["runs"]] == [kept["id"], again["id"]]
    assert [one["scenario"] for one in history["scenarios"]] == ["cut-in", "left-turn"]
    known = {"If-None-Match": http.get(answer.headers["Location"]).headers["ETag"]}
    assert http.get(answer.headers["Location"], headers=known).status_code == 304


def test_a_request_that_is_sent_again_is_kept_once(http: httpx.Client) -> None:
    headers = {"Idempotency-Key": "suite-run-once"}
    first, second = (
        http.post("/api/v1/suite-runs", json=request(suite="once"), headers=headers)
        for _ in range(2)
    )
    assert first.json() == second.json()
    assert len(http.get("/api/v1/suite-runs?suite=once").json()["items"]) == 1


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"scenarios": 3}, "there are 2 outcomes"),
        ({"passing": 3}, "more scenarios pass than there are"),
        ({"suite": ""}, "1 to 200 characters"),
        ({"agent": "x" * 201}, "at most 200 characters"),
        ({"fails": "perhaps"}, "/decision/fails"),
        ({"unknown": 1}, "/decision/unknown"),
    ],
)
def test_decisions_that_make_no_sense_are_refused(
    offline: Offline, changes: Json, told: str
) -> None:
    answer = offline.client.post("/api/v1/suite-runs", json=request(**changes))
    is_problem(answer, 422)
    assert told in answer.text


def test_a_scenario_has_one_outcome(offline: Offline) -> None:
    doubled = request()
    doubled["outcomes"][1] = doubled["outcomes"][0]
    answer = offline.client.post("/api/v1/suite-runs", json=doubled)
    is_problem(answer, 422)
    assert "each scenario of a suite has one outcome" in answer.text


def test_what_was_never_run_has_no_history(offline: Offline) -> None:
    assert offline.client.get("/api/v1/suites").json() == {"items": []}
    is_problem(offline.client.get("/api/v1/suites:history?suite=none"), 404)
    is_problem(offline.client.get("/api/v1/suites:history"), 422)
    is_problem(offline.client.get("/api/v1/suite-runs/none"), 404)
