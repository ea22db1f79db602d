from __future__ import annotations

import copy
import json
import time
from pathlib import Path
from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.search.space.presets import SpacePreset
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.locks.work_locks import LongWork
from tests.api.conftest import MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer
from tests.api.test_problem_details import is_problem
from tests.store.campaigns.test_campaign_repository import create

CAMPAIGNS = "/api/v1/campaigns"


@pytest.fixture
def document() -> dict[str, Any]:
    """A campaign that can be run; its oracles are violated often."""
    return copy.deepcopy(small_campaign("random"))


def small_campaign(tester: str) -> dict[str, Any]:
    return {
        **copy.deepcopy(CAMPAIGN),
        "name": f"tee, {tester}",
        "tester": {"name": tester},
        "space": {"vehicles": 2, "walkers": 1},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": 12},
        "seed": 3,
    }


@pytest.fixture(scope="module")
def finished(service_url: str) -> dict[str, Any]:
    """A campaign that the real service has finished."""
    with httpx.Client(base_url=service_url, timeout=60) as client:
        posted = client.post(CAMPAIGNS, json=small_campaign("avfuzzer"))
        assert posted.status_code == 202, posted.text
        deadline = time.monotonic() + 180
        while time.monotonic() < deadline:
            campaign: dict[str, Any] = client.get(posted.headers["Location"]).json()
            if campaign["state"] not in ("queued", "running"):
                assert campaign["state"] == "finished", campaign["message"]
                return campaign
            time.sleep(0.1)
    raise AssertionError("the campaign did not end")


def post(offline: Offline, document: dict[str, Any]) -> dict[str, Any]:
    answer = offline.client.post(CAMPAIGNS, json=document)
    assert answer.status_code == 202, answer.text
    campaign: dict[str, Any] = answer.json()
    return campaign


def set_state(offline: Offline, campaign_id: str, state: CampaignState) -> None:
    with offline.context.database.write() as transaction:
        transaction.campaigns.end(campaign_id, state)


def test_a_posted_campaign_waits_and_tells_where_to_look(
    offline: Offline, document: dict[str, Any]
) -> None:
    answer = offline.client.post(CAMPAIGNS, json=document)
    assert answer.status_code == 202
    campaign = answer.json()
    assert answer.headers["Location"] == f"{CAMPAIGNS}/{campaign['id']}"
    assert int(answer.headers["Retry-After"]) >= 1
    assert (campaign["state"], campaign["simulations"], campaign["rate"]) == ("queued", 0, None)
    assert (campaign["tester"], campaign["agent"], campaign["town"]) == (
        "random",
        "idm",
        "tee-town",
    )
    assert campaign["document"]["budget"] == {"simulations": 12}
    assert campaign["document"]["lookahead"] == 8
    assert offline.woken == [1]
    batch = offline.client.get(f"/api/v1/batches/{campaign['batch_id']}").json()
    assert (batch["name"], batch["priority"], batch["size"]) == ("tee, random", "campaign", 0)


def test_the_document_of_a_campaign_can_be_posted_again(
    offline: Offline, document: dict[str, Any]
) -> None:
    first = post(offline, document)
    again = post(offline, first["document"])
    assert again["document"] == first["document"]


def test_a_campaign_may_be_written_in_yaml(offline: Offline, document: dict[str, Any]) -> None:
    answer = offline.client.post(
        CAMPAIGNS,
        # JSON is YAML.
        content=json.dumps(document),
        headers={"Content-Type": "application/yaml"},
    )
    assert answer.status_code == 202


def test_every_problem_is_named_with_its_place(offline: Offline, document: dict[str, Any]) -> None:
    document["tester"] = {"name": "rando"}
    document["budget"] = {"simulations": 0}
    document["oracles"] = ["colision"]
    document["scenario"]["map_region"]["town"] = "Nowhere"
    for path in (CAMPAIGNS, f"{CAMPAIGNS}:validate"):
        body = is_problem(offline.client.post(path, json=document), 422)
        assert {problem["pointer"] for problem in body["problems"]} == {
            "/tester/name",
            "/budget/simulations",
            "/oracles/0",
            "/scenario/map_region/town",
        }
    assert offline.client.get(CAMPAIGNS).json()["items"] == []


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        (
            {"tester": {"name": "avfuzzer", "parameters": {"population": 0}}},
            "/tester/parameters/population",
        ),
        ({"agent": {"name": "idm", "parameters": {"speed": 1}}}, "/agent/parameters/speed"),
        ({"scenario": {"file": "seed.json"}}, "/scenario/file"),
        ({"space": {"vehicles": 0, "walkers": 0, "weather": False}}, "/space"),
        ({"tester": {"name": "doppeltest"}}, "/tester"),
    ],
)
def test_what_tester_and_space_refuse_is_refused_before_anything_is_stored(
    offline: Offline, document: dict[str, Any], change: dict[str, Any], pointer: str
) -> None:
    body = is_problem(offline.client.post(CAMPAIGNS, json={**document, **change}), 422)
    assert [problem["pointer"] for problem in body["problems"]] == [pointer]
    assert offline.client.get(CAMPAIGNS).json()["items"] == []


def test_a_dry_run_stores_nothing(offline: Offline, document: dict[str, Any]) -> None:
    checked = offline.client.post(f"{CAMPAIGNS}:validate", json=document).json()
    assert (checked["valid"], checked["tester"], checked["town"]) == (True, "random", "tee-town")
    assert checked["genes"] > 20
    assert offline.client.get(CAMPAIGNS).json()["items"] == []


def test_named_spaces_are_listed_with_the_values_that_they_stand_for(
    offline: Offline, document: dict[str, Any]
) -> None:
    presets = offline.client.get(f"{CAMPAIGNS}:presets").json()["items"]
    assert [preset["name"] for preset in presets] == [preset.value for preset in SpacePreset]
    assert presets[0]["options"] == {}
    for preset in presets[1:]:
        assert preset["description"]
        assert preset["source"]
        named, written = (
            offline.client.post(CAMPAIGNS, json={**document, "space": space}).json()
            for space in ({"preset": preset["name"]}, preset["options"])
        )
        del named["document"]["space"]["preset"]
        assert named["document"]["space"] == written["document"]["space"]


def test_a_campaign_that_is_sent_twice_is_made_once(
    offline: Offline, document: dict[str, Any]
) -> None:
    key = {"Idempotency-Key": "study-1"}
    first = offline.client.post(CAMPAIGNS, json=document, headers=key)
    second = offline.client.post(CAMPAIGNS, json=document, headers=key)
    assert second.json() == first.json()
    assert second.headers["Idempotency-Replayed"] == "true"
    other = offline.client.post(CAMPAIGNS, json={**document, "seed": 4}, headers=key)
    is_problem(other, 422)
    assert len(offline.client.get(CAMPAIGNS).json()["items"]) == 1


def test_lists_page_and_filter_by_state(offline: Offline, document: dict[str, Any]) -> None:
    made = [post(offline, {**document, "name": str(n)})["id"] for n in range(3)]
    set_state(offline, made[1], CampaignState.PAUSED)
    first = offline.client.get(CAMPAIGNS, params={"limit": 2}).json()
    token = first["next_page_token"]
    second = offline.client.get(CAMPAIGNS, params={"limit": 2, "page_token": token}).json()
    assert [c["id"] for c in first["items"] + second["items"]] == made[::-1]
    assert second["next_page_token"] == ""
    paused = offline.client.get(CAMPAIGNS, params={"state": "paused"}).json()
    assert [c["id"] for c in paused["items"]] == [made[1]]
    assert "document" not in paused["items"][0]
    is_problem(offline.client.get(CAMPAIGNS, params={"state": "asleep"}), 422)
    is_problem(offline.client.get(CAMPAIGNS, params={"page_token": token, "state": "paused"}), 422)


def test_pausing_resuming_and_cancelling_a_campaign_that_waits(
    offline: Offline, document: dict[str, Any]
) -> None:
    url = f"{CAMPAIGNS}/{post(offline, document)['id']}"
    assert offline.client.post(f"{url}:pause").json()["state"] == "paused"
    assert offline.client.post(f"{url}:resume").json()["state"] == "queued"
    assert offline.client.post(f"{url}:cancel").json()["state"] == "cancelled"
    again = offline.client.post(f"{url}:cancel")
    assert (again.status_code, again.json()["state"]) == (202, "cancelled")
    for what in ("pause", "resume"):
        is_problem(offline.client.post(f"{url}:{what}"), 409)


def test_what_the_state_forbids(offline: Offline, document: dict[str, Any]) -> None:
    campaign_id = post(offline, document)["id"]
    url = f"{CAMPAIGNS}/{campaign_id}"
    with offline.context.database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
    is_problem(offline.client.post(f"{url}:resume"), 409)
    set_state(offline, campaign_id, CampaignState.FINISHED)
    for what in ("pause", "resume", "cancel"):
        is_problem(offline.client.post(f"{url}:{what}"), 409)
    assert offline.client.get(url).json()["state"] == "finished"


def test_a_running_campaign_is_asked_to_pause(offline: Offline, document: dict[str, Any]) -> None:
    campaign_id = post(offline, document)["id"]
    lock = offline.context.database.locks.hold(LongWork.campaign(campaign_id))
    try:
        with offline.context.database.write() as transaction:
            transaction.campaigns.begin(campaign_id)
        asked = offline.client.post(f"{CAMPAIGNS}/{campaign_id}:pause").json()
        assert (asked["state"], asked["request"]) == ("running", "pause")
        asked = offline.client.post(f"{CAMPAIGNS}/{campaign_id}:cancel").json()
        assert (asked["state"], asked["request"]) == ("running", "cancel")
    finally:
        lock.release()


def test_a_campaign_of_a_command_that_was_killed_is_handed_over(
    offline: Offline, document: dict[str, Any]
) -> None:
    campaign_id = post(offline, document)["id"]
    with offline.context.database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
        row = transaction.session.connection()
        row.exec_driver_sql("UPDATE campaigns SET batch_id = ''")
    resumed = offline.client.post(f"{CAMPAIGNS}/{campaign_id}:resume")
    assert resumed.status_code == 202, resumed.text
    assert resumed.json()["state"] == "queued"
    assert resumed.json()["batch_id"]


def test_what_is_not_there(offline: Offline, document: dict[str, Any]) -> None:
    url = f"{CAMPAIGNS}/{post(offline, document)['id']}"
    for path in (
        f"{CAMPAIGNS}/0",
        f"{CAMPAIGNS}/0/evaluations",
        f"{CAMPAIGNS}/0/failures",
        f"{url}/evaluations/0",
        f"{url}/evaluations/0/scenario",
        f"{url}/evaluations/0/observations",
    ):
        is_problem(offline.client.get(path), 404)
    is_problem(offline.client.post(f"{CAMPAIGNS}/0:pause"), 404)
    is_problem(offline.client.get(f"{url}/evaluations/-1"), 422)


def test_scopes(make_offline: MakeOffline, tmp_path: Path, document: dict[str, Any]) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    viewer, sender = tokens.create("viewer", Scope.READ), tokens.create("sender", Scope.SUBMIT)
    client = make_offline(tokens=tokens).client
    assert client.get(CAMPAIGNS).status_code == 401
    assert client.get(CAMPAIGNS, headers=bearer(viewer)).status_code == 200
    assert client.post(CAMPAIGNS, json=document, headers=bearer(viewer)).status_code == 403
    posted = client.post(CAMPAIGNS, json=document, headers=bearer(sender))
    assert posted.status_code == 202
    pause = f"{posted.headers['Location']}:pause"
    assert client.post(pause, headers=bearer(viewer)).status_code == 403
    assert client.post(pause, headers=bearer(sender)).status_code == 202


def test_testers_and_their_parameters(offline: Offline) -> None:
    testers = {item["name"]: item for item in offline.client.get("/api/v1/testers").json()["items"]}
    assert {"random", "avfuzzer", "behavexplor", "doppeltest"} <= set(testers)
    assert all(tester["installed"] and tester["source"] for tester in testers.values())
    assert testers["random"]["generational"] is False
    avfuzzer = testers["avfuzzer"]
    assert avfuzzer["generational"] is True
    population, *_ = avfuzzer["parameters"]
    assert (population["name"], population["default"]) == ("population", 4)
    assert population["values"] == {
        "minimum": 2,
        "maximum": 10_000,
        "type": "integer",
        "x-within-budget": True,
    }
    for tester in testers.values():
        assert all(parameter["description"] for parameter in tester["parameters"]), tester["name"]


def test_an_unchanged_campaign_is_not_sent_again(
    offline: Offline, document: dict[str, Any]
) -> None:
    url = f"{CAMPAIGNS}/{post(offline, document)['id']}"
    known = {"If-None-Match": offline.client.get(url).headers["ETag"]}
    assert offline.client.get(url, headers=known).status_code == 304
    offline.client.post(f"{url}:pause")
    assert offline.client.get(url, headers=known).status_code == 200


def test_a_finished_campaign_tells_what_it_found(finished: dict[str, Any]) -> None:
    assert finished["simulations"] == 12
    assert finished["counts"]["judged"] == 12
    assert finished["rate"] > 0
    assert finished["left_s"] == 0.0
    assert set(finished["best"]) == {"safety_margin"}
    (kind,) = [kind for kind in finished["kinds"] if kind["kind"].startswith("discomfort")]
    assert kind["failures"] == kind["confirmed"] > 0
    assert kind["flaky"] == 0
    assert kind["groups"] >= 1


def test_evaluations_are_listed_in_both_orders_and_filtered(
    http: httpx.Client, finished: dict[str, Any]
) -> None:
    url = finished["evaluations_url"]
    seen: list[dict[str, Any]] = []
    token = ""
    while True:
        page = http.get(url, params={"limit": 5, "page_token": token}).json()
        seen += page["items"]
        token = page["next_page_token"]
        if not token:
            break
    assert [e["number"] for e in seen] == list(range(finished["counts"]["evaluations"]))
    newest = http.get(url, params={"order": "-number", "limit": 3}).json()["items"]
    assert newest == seen[:-4:-1]
    violating = http.get(url, params={"violating": True}).json()["items"]
    assert violating == [e for e in seen if e["violations"]]
    assert len(violating) == finished["counts"]["violating"] > 0
    assert all(len(e["failure_kinds"]) == e["violations"] for e in seen)
    generation = http.get(url, params={"generation": 1, "status": "judged"}).json()["items"]
    assert generation == [e for e in seen if e["generation"] == 1 and e["status"] == "judged"]
    assert generation
    assert all(set(e["objectives"]) == {"safety_margin"} for e in seen)
    best = finished["best"]["safety_margin"]
    assert best["value"] == min(e["objectives"]["safety_margin"] for e in seen)
    is_problem(http.get(url, params={"order": "origin"}), 422)


def test_an_evaluation_names_its_genes_and_ancestors(
    http: httpx.Client, finished: dict[str, Any]
) -> None:
    listed = http.get(finished["evaluations_url"], params={"limit": 500}).json()["items"]
    child = next(e for e in reversed(listed) if e["parents"])
    detail = http.get(f"{finished['evaluations_url']}/{child['number']}").json()
    assert {key: detail[key] for key in child} == child
    blocks = {block["name"]: block for block in detail["genes"]}
    assert {"vehicle_0", "vehicle_1", "walker_0", "weather"} <= set(blocks)
    speed = next(g for g in blocks["vehicle_0"]["genes"] if g["name"] == "speed_0")
    assert speed["unit"] == "m/s"
    assert speed["low"] <= speed["value"] <= speed["high"]
    flat = [gene["value"] for block in detail["genes"] for gene in block["genes"]]
    assert flat == detail["values"]
    by_number = {e["number"]: e for e in listed}
    ancestors: set[int] = set()
    ahead = set(child["parents"])
    while ahead:
        ancestors |= ahead
        ahead = {p for n in ahead for p in by_number[n]["parents"]} - ancestors
    assert detail["lineage"] == [by_number[n] for n in sorted(ancestors)]
    assert detail["verdicts"]
    run = http.get(detail["run_url"]).json()
    assert (run["item"], run["batch_id"]) == (child["number"], finished["batch_id"])
    assert run["scenario_sha256"] == child["scenario_sha256"]


def test_failures_are_confirmed_and_can_be_watched_and_run_again(
    http: httpx.Client, finished: dict[str, Any]
) -> None:
    url = finished["failures_url"]
    pages = http.get(url, params={"limit": 1}).json()
    rest = http.get(url, params={"page_token": pages["next_page_token"], "limit": 500})
    assert pages["next_page_token"]
    # Another page size is the same query.
    failures = pages["items"] + rest.json()["items"]
    assert len(failures) == sum(kind["violations"] for kind in finished["kinds"])
    places = [failure["evaluation"] for failure in failures]
    assert places == sorted(places)
    assert {failure["confirmation"] for failure in failures} == {"confirmed"}
    chosen = http.get(url, params={"kind": failures[0]["kind"], "confirmation": "confirmed"})
    assert chosen.json()["items"] == [f for f in failures if f["kind"] == failures[0]["kind"]]
    assert http.get(url, params={"confirmation": "flaky"}).json()["items"] == []
    assert http.get(url, params={"oracle": "red_light"}).json()["items"] == []

    failure = failures[0]
    evaluation = http.get(f"{finished['evaluations_url']}/{failure['evaluation']}").json()
    assert evaluation["observations_url"] == failure["observations_url"]
    lines = http.get(failure["observations_url"], params={"first": 3, "last": 5}).text.splitlines()
    assert [json.loads(line)["step"] for line in lines] == [3, 4, 5]
    scenario = http.get(failure["scenario_url"])
    checked = http.post("/api/v1/scenarios:validate", json=scenario.json()).json()
    assert checked["scenario_sha256"] == evaluation["scenario_sha256"]
    known = {"If-None-Match": scenario.headers["ETag"]}
    assert http.get(failure["scenario_url"], headers=known).status_code == 304


@pytest.mark.parametrize("path", ["/api/v1/campaigns/{}", "/api/v1/campaigns"])
@pytest.mark.parametrize("ends", [True, False])
def test_one_that_ends_while_it_is_read_is_not_interrupted(
    make_offline: MakeOffline, monkeypatch: pytest.MonkeyPatch, path: str, ends: bool
) -> None:
    """The command of a campaign ends between the reading of its state and that of its lock."""
    offline = make_offline()
    database = offline.context.database
    campaign_id = create(database)
    with database.write() as transaction:
        transaction.campaigns.begin(campaign_id)

    def is_held(_work: LongWork) -> bool:
        if ends:
            with database.write() as transaction:
                transaction.campaigns.end(campaign_id, CampaignState.FINISHED)
        return False

    monkeypatch.setattr(database.locks, "is_held", is_held)
    answer = offline.client.get(path.format(campaign_id)).raise_for_status().json()
    (campaign,) = answer.get("items", [answer])
    assert campaign["state"] == ("finished" if ends else "interrupted")
