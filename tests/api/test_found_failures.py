"""The failures of all campaigns and batches over HTTP."""

from __future__ import annotations

import copy
from collections import Counter
from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.api.conftest import Offline, wait_until_final
from tests.api.test_campaigns import finished as finished  # a fixture
from tests.api.test_problem_details import is_problem

Json = dict[str, Any]
FAILURES = "/api/v1/failures"


def crash() -> Json:
    """A scenario in which the ego drives into a container."""
    scenario = copy.deepcopy(SCENARIO)
    scenario["ego_vehicles"][0]["agent"] = {"name": "scripted"}
    container = {"x": 3.4, "y": 50.0, "yaw": 91.51}
    scenario["npc_obstacles"] = [
        {"id": "container", "model": "static.prop.container", "location": container}
    ]
    return scenario


@pytest.fixture(scope="module")
def crashed(service_url: str) -> Json:
    """A run of it, posted alone, that the real service has judged."""
    with httpx.Client(base_url=service_url, timeout=60) as client:
        job = wait_until_final(client, client.post("/api/v1/jobs", json=crash()).json()["id"])
        run: Json = client.get(job["run_url"]).json()
        assert run["violations"]
        return run


def test_a_campaign_s_failures_are_among_all(http: httpx.Client, finished: Json) -> None:
    own = http.get(f"{finished['failures_url']}?limit=500").json()["items"]
    found = http.get(f"{FAILURES}?campaign={finished['id']}&limit=500").json()["items"]
    assert [(f["evaluation"], f["place"], f["verdict"]) for f in reversed(found)] == [
        (f["evaluation"], f["place"], f["verdict"]) for f in own
    ]
    first = found[-1]
    assert (first["kind"], first["confirmation"]) == (own[0]["kind"], own[0]["confirmation"])
    assert first["scenario_url"] == own[0]["scenario_url"]
    assert http.get(first["scenario_url"]).status_code == 200
    assert http.get(first["run_url"]).json()["id"] == first["run_id"]
    assert http.get(f"{FAILURES}/{first['id']}").json() == first
    blamed = [f for f in found if f["at_fault"]]
    wanted = {"campaign": finished["id"], "at_fault": True, "limit": 500}
    assert http.get(FAILURES, params=wanted).json()["items"] == blamed


def test_a_violation_of_a_single_run_is_told_by_its_facts(
    http: httpx.Client, crashed: Json
) -> None:
    wanted = {"oracle": "collision", "agent": "scripted", "since": crashed["created_at"]}
    (failure, *_) = http.get(FAILURES, params=wanted).json()["items"]
    assert failure["run_id"] == crashed["id"]
    assert (failure["campaign_id"], failure["batch_id"]) == ("", "")
    assert failure["verdict"] in crashed["verdicts"]
    verdict = failure["verdict"]
    assert (verdict["at_fault"], verdict["avoidable"]) == (True, "yes")
    assert failure["accountability"] == "avoidable"
    assert failure["group_name"] == "collision|npc_obstacle, front|standing"
    until = verdict["time"] - verdict["evidence"]["avoidability"]["latest_before"]
    assert failure["avoidable_until"] == pytest.approx(until)
    for fact in ("an obstacle", "8.0 m/s", "front", "tee-town", f"avoidable until {until:.2f} s"):
        assert fact in failure["sentence"]
    assert failure["scenario_url"].endswith(f"/runs/{crashed['id']}/scenario")


def test_groups_count_the_failures_that_pass_the_filters(
    http: httpx.Client, finished: Json, crashed: Json
) -> None:
    for query in ("", f"campaign={finished['id']}", "accountability=avoidable", "town=tee-town"):
        found = http.get(f"{FAILURES}?limit=500&{query}").json()["items"]
        answer = http.get(f"{FAILURES}/groups?limit=500&{query}")
        groups = answer.json()["items"]
        assert {g["id"]: g["failures"] for g in groups} == Counter(f["group_id"] for f in found)
        for group in groups:
            listed = http.get(f"{group['failures_url']}&limit=500").json()["items"]
            assert len(listed) == group["failures"]
            assert {f["group_id"] for f in listed} == {group["id"]}
            assert {f["group_name"] for f in listed} == set(group["names"])
            assert group["example"] in listed
            assert group["avoidable"] == sum(f["accountability"] == "avoidable" for f in listed)
            assert group["last_seen"] == listed[0]["found_at"]
        known = {"If-None-Match": answer.headers["ETag"]}
        assert http.get(f"{FAILURES}/groups?limit=500&{query}", headers=known).status_code == 304


@pytest.mark.parametrize(
    "query", ["accountability=some", "since=now", "kind=a", "limit=0", "page_token=bad"]
)
def test_filters_that_cannot_be_read_are_refused(offline: Offline, query: str) -> None:
    for path in (FAILURES, f"{FAILURES}/groups"):
        is_problem(offline.client.get(f"{path}?{query}"), 422)


def test_without_failures_the_lists_are_empty(offline: Offline) -> None:
    for path in (FAILURES, f"{FAILURES}/groups"):
        assert offline.client.get(path).json() == {"items": [], "next_page_token": ""}
    is_problem(offline.client.get(f"{FAILURES}/1"), 404)
    is_problem(offline.client.get(f"{FAILURES}/0"), 422)
    for what in ("", "/changes"):
        is_problem(offline.client.get(f"{FAILURES}/groups/{'0' * 24}{what}"), 404)


def test_people_decide_about_groups(http: httpx.Client, crashed: Json) -> None:
    """On a run of its own: the service is that of all tests."""
    (failure, *_) = http.get(FAILURES, params={"oracle": "collision", "limit": 1}).json()["items"]
    address = f"{FAILURES}/groups/{failure['group_id']}"
    before = http.get(address).json()
    assert failure["group_name"] in before["names"]
    note = {"note": f"seen after {before['revision']}", "by": "Ada"}
    answer = http.post(f"{address}:decide", json={**note, "revision": before["revision"]})
    assert answer.status_code == 200, answer.text
    after = answer.json()
    assert (after["note"], after["changed_by"]) == (note["note"], "Ada")
    assert http.get(address).json() == after
    problem = http.post(f"{address}:decide", json={**note, "revision": before["revision"]})
    is_problem(problem, 409)
    assert "Ada changed the group meanwhile" in problem.json()["detail"]
    change = http.get(after["changes_url"]).json()["items"][0]
    assert (change["what"], change["after"], change["by"]) == ("note", note["note"], "Ada")
    # A part of it is split off and merged again.
    part = http.post(f"{address}:split", json={"failures": [failure["id"]], "label": "this one"})
    if after["failures"] == 1:
        is_problem(part, 409)
        return
    assert (part.json()["failures"], part.json()["label"]) == (1, "this one")
    ids = {"into": after["id"], "groups": [part.json()["id"]], "by": "Bo"}
    merged = http.post(f"{FAILURES}/groups:merge", json=ids).json()
    assert (merged["id"], merged["failures"]) == (after["id"], after["failures"])
    assert http.get(f"{FAILURES}/groups/{part.json()['id']}").json()["id"] == after["id"]


def test_groups_are_compared_with_a_baseline(http: httpx.Client, crashed: Json) -> None:
    listed: dict[str, str | int] = {"town": "tee-town", "limit": 500}
    whole = http.get(f"{FAILURES}/groups", params=listed).json()["items"]
    assert {g["since_baseline"] for g in whole} == {None}
    for baseline, since in (("2020-01-01T00:00:00Z", "new"), ("2100-01-01T00:00:00Z", "gone")):
        found = http.get(f"{FAILURES}/groups", params={**listed, "baseline": baseline}).json()
        assert {g["since_baseline"] for g in found["items"]} == {since}
        assert {g["id"] for g in found["items"]} == {g["id"] for g in whole}
    problem = http.get(f"{FAILURES}/groups", params={"baseline": "last week"})
    is_problem(problem, 422)
    assert "2026-11-20T08:00:00Z" in problem.text


@pytest.mark.parametrize(
    ("action", "body"),
    [
        ("/x:decide", {"status": "old"}),
        ("/x:decide", {"label": "x" * 201}),
        ("/x:decide", {"unknown": 1}),
        (":merge", {"into": "x", "groups": []}),
        ("/x:split", {"failures": ["x"]}),
    ],
)
def test_decisions_that_cannot_be_read_are_refused(
    offline: Offline, action: str, body: Json
) -> None:
    is_problem(offline.client.post(f"{FAILURES}/groups{action}", json=body), 422)


@pytest.mark.parametrize("path", [FAILURES, f"{FAILURES}:counts", f"{FAILURES}/groups"])
def test_an_unknown_oracle_is_answered_with_the_choices(offline: Offline, path: str) -> None:
    answer = offline.client.get(path, params={"oracle": "nosuch"})
    assert is_problem(answer, 404)
    assert "unknown oracle 'nosuch'" in answer.text
    assert "near_miss" in answer.text
    assert offline.client.get(path, params={"oracle": "near_miss"}).status_code == 200
