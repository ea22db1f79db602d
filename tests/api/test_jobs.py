from __future__ import annotations

from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN
from tests.api.conftest import Offline, wait_until_final
from tests.store.samples import new_run


def test_a_posted_job_tells_where_and_when_to_look(
    http: httpx.Client, scenario: dict[str, Any]
) -> None:
    posted = http.post("/api/v1/jobs", json=scenario)
    assert posted.status_code == 202
    assert posted.headers["Location"] == f"/api/v1/jobs/{posted.json()['id']}"
    assert int(posted.headers["Retry-After"]) >= 1
    job = wait_until_final(http, posted.json()["id"])
    assert job["status"] == "finished"
    assert job["error"] is None
    assert job["agent"] == "idm"
    assert job["town"] == "tee-town"


def test_a_run_carries_its_verdicts_and_measures(finished_run: dict[str, Any]) -> None:
    assert finished_run["status"] == "finished"
    outcomes = {verdict["oracle"]: verdict["outcome"] for verdict in finished_run["verdicts"]}
    assert outcomes["collision"] == "passed"
    assert outcomes["destination"] == "passed"
    assert finished_run["metrics"]["route_completion"] == 100.0
    assert len(finished_run["trace_sha256"]) == 64
    (ego,) = finished_run["agent_cost_us"]
    assert 0.0 < finished_run["agent_cost_us"][ego] < finished_run["step_cost_us"]
    assert finished_run["privileged"] == []
    assert finished_run["tries"][0]["outcome"] == "finished"
    assert finished_run["label"] == "first"


def test_yaml_and_overrides_are_accepted(http: httpx.Client) -> None:
    text = """
map_region: {town: tee-town}
ego_vehicles:
  - id: ego
    model: vehicle.lincoln.mkz_2017
    route: [{x: 11.77, y: 19.81, yaw: 125.36}, {x: 3.01, y: 104.32, yaw: 91.51}]
    agent: {name: not-installed-here}
"""
    posted = http.post(
        "/api/v1/jobs",
        content=text,
        headers={"Content-Type": "application/yaml"},
        params={"agent": "sumo-idm", "seed": 7},
    )
    assert posted.status_code == 202, posted.text
    job = wait_until_final(http, posted.json()["id"])
    assert (job["status"], job["agent"], job["seed"]) == ("finished", "sumo-idm", 7)
    driven = http.get(f"/api/v1/runs/{job['id']}/scenario").json()
    assert (driven["ego_vehicles"][0]["agent"]["name"], driven["seed"]) == ("sumo-idm", 7)


def test_parameters_of_agents_are_taken_from_the_request(
    http: httpx.Client, scenario: dict[str, Any]
) -> None:
    setting = {"agent_parameter": ["speed_factor=0.5", "ego:speed_factor=0.6"]}
    posted = http.post("/api/v1/jobs", json=scenario, params=setting)
    assert posted.status_code == 202, posted.text
    job = wait_until_final(http, posted.json()["id"])
    run = http.get(f"/api/v1/runs/{job['id']}").json()
    assert run["agents"] == {
        "ego": {"name": "idm", "parameters": {"speed_factor": 0.6, "reaction_time": 0.0}}
    }
    document = http.get(run["scenario_url"]).json()
    assert document["ego_vehicles"][0]["agent"]["parameters"] == {"speed_factor": 0.6}
    driven = {"agent": "sumo-idm", "agent_parameter": "lane_change_model=SL2015"}
    posted = http.post("/api/v1/jobs", json=scenario, params=driven)
    job = wait_until_final(http, posted.json()["id"])
    agents = http.get(f"/api/v1/runs/{job['id']}").json()["agents"]
    assert agents["ego"]["name"] == "sumo-idm"
    assert agents["ego"]["parameters"]["lane_change_model"] == "SL2015"


@pytest.mark.parametrize(
    ("setting", "pointer", "said"),
    [
        ("pace=1", "/ego_vehicles/0/agent/parameters/pace", "has no parameter 'pace'"),
        ("speed_factor=fast", "/ego_vehicles/0/agent/parameters/speed_factor", "allowed: a number"),
        ("speed_factor", "", "allowed: NAME=VALUE"),
        ("ego_9:speed_factor=1", "", "its egos: ego"),
    ],
)
def test_wrong_parameters_in_a_request_are_named(
    offline: Offline, scenario: dict[str, Any], setting: str, pointer: str, said: str
) -> None:
    posted = offline.client.post("/api/v1/jobs", json=scenario, params={"agent_parameter": setting})
    assert posted.status_code == 422
    (problem,) = posted.json()["problems"]
    assert problem["pointer"] == pointer
    assert said in problem["message"]


@pytest.mark.parametrize(
    ("query", "pointers"),
    [
        ({}, ["speed_factor", "pace"]),
        ({"agent": "idm"}, ["speed_factor", "pace"]),
        ({"agent": "sumo-idm"}, None),
    ],
)
def test_parameters_that_the_agent_does_not_take_are_refused(
    offline: Offline,
    scenario: dict[str, Any],
    query: dict[str, str],
    pointers: list[str] | None,
) -> None:
    agent = {"name": "idm", "parameters": {"speed_factor": "fast", "pace": 1}}
    document = {**scenario, "ego_vehicles": [{**scenario["ego_vehicles"][0], "agent": agent}]}
    posted = offline.client.post("/api/v1/jobs", json=document, params=query)
    if pointers is None:
        # Somebody else will drive, without these parameters.
        assert posted.status_code == 202
        return
    assert posted.status_code == 422
    above = "/ego_vehicles/0/agent/parameters"
    problems = posted.json()["problems"]
    assert [problem["pointer"] for problem in problems] == [f"{above}/{name}" for name in pointers]
    assert 'speed_factor is "fast"; allowed: a number from 0.1 to 2' in problems[0]["message"]
    batch = offline.client.post("/api/v1/batches", json=[document, scenario], params=query).json()
    assert [item["result"] for item in batch["items"]] == ["rejected", "accepted"]


def test_the_same_scenario_gives_the_same_trace(
    http: httpx.Client, finished_run: dict[str, Any], scenario: dict[str, Any]
) -> None:
    posted = http.post("/api/v1/jobs", json=scenario).json()
    job = wait_until_final(http, posted["id"])
    assert job["trace_sha256"] == finished_run["trace_sha256"]


def test_the_scenario_of_a_run_can_be_posted_again(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    document = http.get(finished_run["scenario_url"])
    checked = http.post("/api/v1/scenarios:validate", json=document.json())
    assert checked.status_code == 200
    assert checked.json()["scenario_sha256"] == finished_run["scenario_sha256"]


def test_a_waiting_job_is_cancelled_at_once(offline: Offline, scenario: dict[str, Any]) -> None:
    job_id = offline.client.post("/api/v1/jobs", json=scenario).json()["id"]
    cancelled = offline.client.post(f"/api/v1/jobs/{job_id}:cancel")
    assert cancelled.status_code == 202
    assert cancelled.json()["status"] == "cancelled"
    assert cancelled.json()["error"]["cause"] == "cancelled"
    assert len(offline.woken) == 2


def test_a_full_queue_says_when_to_come_back(make_offline: Any, scenario: dict[str, Any]) -> None:
    offline = make_offline(queued_runs=1)
    assert offline.client.post("/api/v1/jobs", json=scenario).status_code == 202
    refused = offline.client.post("/api/v1/jobs", json=scenario)
    assert refused.status_code == 429
    assert int(refused.headers["Retry-After"]) >= 1
    assert offline.client.get("/api/v1/jobs").json()["items"][0]["status"] == "queued"


def test_lists_filter_and_page_without_gaps(offline: Offline, scenario: dict[str, Any]) -> None:
    posted = [offline.client.post("/api/v1/jobs", json=scenario).json()["id"] for _ in range(5)]
    seen: list[str] = []
    token = ""
    for _ in range(3):
        page = offline.client.get("/api/v1/jobs", params={"limit": 2, "page_token": token}).json()
        seen += [job["id"] for job in page["items"]]
        token = page["next_page_token"]
    assert seen == posted[::-1]
    assert token == ""
    finished = offline.client.get("/api/v1/runs", params={"status": "finished"}).json()
    assert finished["items"] == []
    assert offline.client.get("/api/v1/jobs", params={"limit": 501}).status_code == 422
    bad = offline.client.get("/api/v1/jobs", params={"page_token": "nonsense"})
    assert bad.status_code == 422
    assert bad.json()["problems"][0]["code"] == "bad_page_token"


def test_an_unchanged_job_is_not_sent_again(offline: Offline, scenario: dict[str, Any]) -> None:
    job_id = offline.client.post("/api/v1/jobs", json=scenario).json()["id"]
    first = offline.client.get(f"/api/v1/jobs/{job_id}")
    known = {"If-None-Match": first.headers["ETag"]}
    assert offline.client.get(f"/api/v1/jobs/{job_id}", headers=known).status_code == 304
    offline.client.post(f"/api/v1/jobs/{job_id}:cancel")
    assert offline.client.get(f"/api/v1/jobs/{job_id}", headers=known).status_code == 200


def test_runs_are_listed_and_counted_by_the_same_filters(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    since, agent = finished_run["created_at"], finished_run["agent"]
    wanted = {"since": since, "agent": agent, "status": "finished", "order": "created_at"}
    listed = http.get("/api/v1/runs", params={**wanted, "limit": 500}).json()["items"]
    assert listed[0]["id"] == finished_run["id"]
    assert [run["created_at"] for run in listed] == sorted(run["created_at"] for run in listed)
    del wanted["order"]
    answer = http.get("/api/v1/runs:counts", params=wanted)
    counts = answer.json()
    assert counts["total"] == len(listed)
    assert counts["agent"][agent] == len(listed)
    assert counts["violated"] == sum(run["violations"] > 0 for run in listed)
    known = {"If-None-Match": answer.headers["ETag"]}
    assert http.get("/api/v1/runs:counts", params=wanted, headers=known).status_code == 304
    before = http.get("/api/v1/runs", params={"until": since}).json()["items"]
    assert all(run["created_at"] < since for run in before)
    assert finished_run["id"] not in {run["id"] for run in before}


@pytest.mark.parametrize(
    "query", ["since=yesterday", "since=2026-03-01T10:00:00", "order=age", "fault=true"]
)
def test_filters_that_cannot_be_read_are_refused(offline: Offline, query: str) -> None:
    for path in ("runs", "runs:counts"):
        answer = offline.client.get(f"/api/v1/{path}?{query}")
        assert answer.status_code == 422, answer.text
        assert answer.json()["problems"]


def test_runs_are_found_by_the_campaign_that_made_them(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    campaign = offline.client.post("/api/v1/campaigns", json=CAMPAIGN).json()
    offline.client.post("/api/v1/jobs", json=scenario)
    with offline.context.database.write() as transaction:
        run = new_run("{}")
        transaction.jobs.submit([run] * 3, batch_id=campaign["batch_id"])
    found = offline.client.get("/api/v1/runs", params={"campaign": campaign["id"]}).json()["items"]
    assert [run["batch_id"] for run in found] == [campaign["batch_id"]] * 3
    counts = offline.client.get("/api/v1/runs:counts", params={"campaign": campaign["id"]}).json()
    assert (counts["total"], counts["status"]) == (3, {"queued": 3})
    assert offline.client.get("/api/v1/runs:counts").json()["total"] == 4
    assert offline.client.get("/api/v1/runs?campaign=none").json()["items"] == []
