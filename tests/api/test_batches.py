from __future__ import annotations

import json
import time
from typing import Any

import httpx
import pytest

from drivora_service.api.answers.batch_scenarios import read_batch_scenario
from drivora_service.api.routes import batches
from tests.api.conftest import MakeOffline, Offline
from tests.api.test_problem_details import is_problem

NDJSON = {"Content-Type": "application/x-ndjson"}


def test_every_scenario_of_a_batch_gets_its_own_answer(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    lost = {**scenario, "map_region": {"town": "Town99"}}
    answer = offline.client.post("/api/v1/batches", json=[scenario, lost, 3], params={"name": "n"})
    assert answer.status_code == 202
    body = answer.json()
    assert (body["accepted"], body["rejected"]) == (1, 2)
    accepted, unknown_town, number = body["items"]
    assert accepted["result"] == "accepted"
    assert offline.client.get(f"/api/v1/jobs/{accepted['job_id']}").json()["item"] == 0
    assert unknown_town["problems"][0]["pointer"] == "/map_region/town"
    assert "drivora networks import" in unknown_town["problems"][0]["message"]
    assert number["problems"][0]["code"] == "not_an_object"
    batch = offline.client.get(answer.headers["Location"]).json()
    assert (batch["name"], batch["size"], batch["counts"]) == ("n", 1, {"queued": 1})


def test_lines_are_scenarios_too(offline: Offline, scenario: dict[str, Any]) -> None:
    lines = f"{json.dumps(scenario)}\n\n{json.dumps(scenario)}\n{{broken\n"
    answer = offline.client.post("/api/v1/batches", content=lines, headers=NDJSON)
    assert [item["result"] for item in answer.json()["items"]] == [
        "accepted",
        "accepted",
        "rejected",
    ]
    assert answer.json()["items"][2]["problems"][0]["code"] == "not_json"


def labelled(scenario: object, label: object = "Town01_route_07") -> dict[str, Any]:
    return {"label": label, "scenario": scenario}


def post(offline: Offline, items: list[Any], form: str, query: str = "") -> httpx.Response:
    """Posts items as a JSON list or as lines."""
    if form == "list":
        return offline.client.post(f"/api/v1/batches{query}", json=items)
    lines = "\n".join(json.dumps(item) for item in items)
    return offline.client.post(f"/api/v1/batches{query}", content=lines, headers=NDJSON)


FORMS = pytest.mark.parametrize("form", ["list", "lines"])


@FORMS
def test_a_scenario_may_come_with_the_label_of_its_run(
    offline: Offline, scenario: dict[str, Any], form: str
) -> None:
    # The words of a label in another place make no label.
    talking = {**scenario, "extensions": {"a:b": {"label": "scenario", "scenario": {}}}}
    items = [labelled(scenario), scenario, talking, labelled(scenario, ""), labelled(talking, "ü")]
    answer = post(offline, items, form)
    assert answer.status_code == 202, answer.text
    assert answer.json()["rejected"] == 0
    ids = [item["job_id"] for item in answer.json()["items"]]
    jobs = [offline.client.get(f"/api/v1/jobs/{job_id}").json() for job_id in ids]
    assert [job["label"] for job in jobs] == ["Town01_route_07", "", "", "", "ü"]
    first, second, third, _, fifth = (job["scenario_sha256"] for job in jobs)
    assert (first, third) == (second, fifth)


@FORMS
def test_a_scenario_with_a_label_may_have_a_seed_of_its_own(
    offline: Offline, scenario: dict[str, Any], form: str
) -> None:
    items = [{**labelled(scenario, "x"), "seed": seed} for seed in (0, 8, None)]
    answer = post(offline, [*items, labelled(scenario, "x"), scenario], form, "?seed=5")
    assert answer.status_code == 202, answer.text
    jobs = [offline.client.get(f"/api/v1/jobs/{item['job_id']}") for item in answer.json()["items"]]
    assert [job.json()["seed"] for job in jobs] == [0, 8, 5, 5, 5]


@FORMS
@pytest.mark.parametrize(
    ("item", "found"),
    [
        ({"label": 7, "scenario": ...}, {("/label", "string_type")}),
        ({"label": None, "scenario": ...}, {("/label", "string_type")}),
        ({"label": "x" * 201, "scenario": ...}, {("/label", "string_too_long")}),
        ({"label": "a\0b", "scenario": ...}, {("/label", "odd_value")}),
        ({"label": "x", "scenario": ..., "agent": "idm"}, {("/agent", "extra_forbidden")}),
        ({"label": "x", "scenario": ..., "seed": -1}, {("/seed", "greater_than_equal")}),
        ({"label": "x", "scenario": ..., "seed": "1"}, {("/seed", "int_type")}),
        ({"scenario": ...}, {("/label", "missing")}),
        ({"label": "x"}, {("/scenario", "missing")}),
        ({"label": "x", "scenario": [1]}, {("/scenario", "dict_type")}),
        (
            {"label": "x", "scenario": None, "a": 1},
            {("/scenario", "dict_type"), ("/a", "extra_forbidden")},
        ),
    ],
)
def test_an_item_with_a_label_has_these_keys_and_no_other(
    offline: Offline,
    scenario: dict[str, Any],
    form: str,
    item: dict[str, Any],
    found: set[tuple[str, str]],
) -> None:
    item = {key: scenario if value is ... else value for key, value in item.items()}
    answer = post(offline, [item, labelled(scenario, "x" * 200)], form)
    assert answer.status_code == 202, answer.text
    rejected, accepted = answer.json()["items"]
    assert {(p["pointer"], p["code"]) for p in rejected["problems"]} == found
    job = offline.client.get(f"/api/v1/jobs/{accepted['job_id']}").json()
    assert job["label"] == "x" * 200


@FORMS
def test_problems_of_a_scenario_with_a_label_are_found_in_what_was_posted(
    offline: Offline, scenario: dict[str, Any], form: str
) -> None:
    lost = {**scenario, "map_region": {"town": "Town99"}, "sed": 1}
    inside = {"/scenario/sed", "/scenario/map_region/town"}
    answer = post(offline, [labelled(lost), labelled(lost, 7), labelled({}), scenario, lost], form)
    first, second, third, _, bare = answer.json()["items"]
    assert {p["pointer"] for p in first["problems"]} == inside
    assert {p["pointer"] for p in second["problems"]} == {"/label", *inside}
    assert {p["pointer"] for p in third["problems"]} == {
        "/scenario/ego_vehicles",
        "/scenario/map_region",
    }
    assert {p["pointer"] for p in bare["problems"]} == {"/sed", "/map_region/town"}
    refused = is_problem(post(offline, [labelled(lost)], form), 422)
    assert {p["pointer"] for p in refused["problems"]} == {f"/0{place}" for place in inside}


@FORMS
def test_an_unknown_oracle_of_known_failures_is_refused_with_the_choices(
    offline: Offline, scenario: dict[str, Any], form: str
) -> None:
    names = ("agent_failed", "collision", "nosuch", None)
    known = [{"reason": "issue 1"} | ({"oracle": name} if name else {}) for name in names]
    items = [
        {**labelled(scenario), "failures": {"known": known}},
        {**labelled(scenario), "failures": {"known": [known[0], known[1], known[3]]}},
    ]
    refused, accepted = post(offline, items, form).json()["items"]
    assert accepted["result"] == "accepted"
    (problem,) = refused["problems"]
    assert (problem["pointer"], problem["code"]) == (
        "/failures/known/2/oracle",
        "unknown_oracle",
    )
    assert "unknown oracle 'nosuch'; known: agent_failed, " in problem["message"]
    assert "collision" in problem["message"]


def test_a_batch_names_what_its_failing_runs_count(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    def definition(items: list[Any], query: str = "") -> dict[str, Any]:
        posted = post(offline, items, "list", query)
        found: dict[str, Any] = offline.client.get(posted.headers["Location"]).json()["definition"]
        return found

    assert definition([scenario])["origin"] == "default"
    assert definition([scenario], "?counts=any")["counts"] == "any"
    own = {**labelled(scenario), "failures": {"oracles": ["near_miss"]}}
    both = definition([scenario, own])
    assert (both["definitions"], both["origin"]) == (2, "posted")
    assert "near miss" in both["words"]
    (listed, *_) = offline.client.get("/api/v1/batches").json()["items"]
    assert listed["definition"] is None


def test_a_repeated_key_in_a_line_with_a_label_is_named(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    text = json.dumps(scenario)[1:-1]
    lines = [
        f'{{"label": "x", "scenario": {{"seed": 1, "seed": 2, {text}}}}}',
        f'{{"label": "x", "label": "y", "scenario": {{{text}}}}}',
        f'{{"label": "x", "scenario": {{{text}}}',
        f'{{"label": "\\ud800", "scenario": {{{text}}}}}',
        f'{{"label": "x", "scenario": {{{text}}}}}',
    ]
    answer = offline.client.post("/api/v1/batches", content="\n".join(lines), headers=NDJSON)
    found = [
        [(p["pointer"], p["code"]) for p in item["problems"]] for item in answer.json()["items"]
    ]
    assert found == [
        [("/scenario/seed", "repeated_key")],
        [("/label", "repeated_key")],
        [("", "not_json")],
        [("/label", "odd_value")],
        [],
    ]


@pytest.mark.parametrize("is_labelled", [False, True])
def test_only_lines_that_may_have_a_label_are_parsed_for_it(
    scenario: dict[str, Any], is_labelled: bool
) -> None:
    line = json.dumps(labelled(scenario) if is_labelled else scenario).encode()
    read = read_batch_scenario(line)
    assert read.label == ("Town01_route_07" if is_labelled else "")
    assert read.document == (scenario if is_labelled else line)


def test_a_batch_of_nothing_usable_is_refused_with_every_place(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    lost = {**scenario, "map_region": {"town": "Town99"}, "sed": 1}
    answer = offline.client.post("/api/v1/batches", json=[lost])
    assert answer.status_code == 422
    pointers = {p["pointer"] for p in answer.json()["problems"]}
    assert pointers == {"/0/sed", "/0/map_region/town"}
    assert offline.client.get("/api/v1/batches").json()["items"] == []


@pytest.mark.parametrize(
    ("body", "code"),
    [
        (b"[]", "empty_batch"),
        (b"{}", "not_a_list"),
        (b"[" * 100_000, "malformed_json"),
        (b"nonsense", "malformed_json"),
        (json.dumps([{}] * 51).encode(), "batch_too_long"),
    ],
)
def test_bodies_that_are_no_batch_are_refused(offline: Offline, body: bytes, code: str) -> None:
    headers = {"Content-Type": "application/json"}
    answer = offline.client.post("/api/v1/batches", content=body, headers=headers)
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["code"] == code


def test_a_batch_without_a_usable_beginning_is_not_read_to_its_end(
    offline: Offline, scenario: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(batches, "MOST_REJECTED", 3)
    lost = {**scenario, "map_region": {"town": "Town99"}}
    refused = offline.client.post("/api/v1/batches", json=[lost, lost, lost, scenario, lost])
    stopped, *named = is_problem(refused, 422)["problems"]
    assert stopped["code"] == "batch_not_checked"
    assert "the last 2 were not looked at" in stopped["message"]
    assert [problem["pointer"][:2] for problem in named] == ["/0", "/1", "/2"]
    taken = offline.client.post("/api/v1/batches", json=[scenario, lost, lost, lost, lost])
    assert (taken.json()["accepted"], taken.json()["rejected"]) == (1, 4)


def test_a_batch_with_too_many_mistakes_is_refused_as_a_whole(
    offline: Offline, scenario: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(batches, "MOST_PROBLEMS", 5)
    odd = {**scenario, **{f"key{i}": 1 for i in range(3)}}
    refused = offline.client.post("/api/v1/batches", json=[scenario, odd, odd, odd, scenario])
    problems = is_problem(refused, 422)["problems"]
    assert problems[0]["code"] == "batch_not_checked"
    assert len(problems) == 1 + 5
    assert offline.client.get("/api/v1/jobs").json()["items"] == []


def test_every_scenario_of_a_refused_batch_keeps_its_first_problem(
    make_offline: MakeOffline, scenario: dict[str, Any]
) -> None:
    offline = make_offline(batch_items=250)
    lost = {**scenario, "map_region": {"town": "Town99"}, "sed": 1}
    refused = offline.client.post("/api/v1/batches", json=[lost] * 250)
    named = is_problem(refused, 422)["problems"]
    assert [problem["pointer"].split("/")[1] for problem in named] == [str(n) for n in range(250)]
    odd = {**scenario, **{f"key{number}": 1 for number in range(300)}}
    refused = offline.client.post("/api/v1/batches", json=[odd, lost])
    places = [p["pointer"].split("/")[1] for p in is_problem(refused, 422)["problems"]]
    assert (places.count("0"), places.count("1")) == (100, 2)


@pytest.mark.slow
def test_ten_times_the_scenarios_are_checked_in_ten_times_the_time(
    make_offline: MakeOffline, scenario: dict[str, Any]
) -> None:
    """Compares processor time, which other processes of the machine add little to."""
    client = make_offline(queued_runs=20_000, batch_items=10_000, body_bytes=64 << 20).client
    few, many = 200, 2_000
    good = [json.dumps({**scenario, "seed": seed}) for seed in range(many)]
    bad = [json.dumps({f"key{i}{n}": 1 for n in range(200)}) for i in range(many)]
    for lines, status in ((good, 202), (bad, 422)):
        used = {}
        for count in (few, many):
            content = "\n".join(lines[:count])
            before = time.process_time()
            answer = client.post("/api/v1/batches", content=content, headers=NDJSON, timeout=300)
            used[count] = time.process_time() - before
            assert answer.status_code == status
        # A hundred times, if each were compared with all others.
        assert used[many] < 30.0 * used[few], used


def test_batches_are_listed_by_priority(offline: Offline, scenario: dict[str, Any]) -> None:
    client = offline.client
    for priority in ("campaign", "ci", "campaign", "interactive", "campaign", "ci"):
        posted = client.post("/api/v1/batches", json=[scenario], params={"priority": priority})
        assert posted.status_code == 202

    def listed(query: str) -> list[str]:
        answer = client.get(f"/api/v1/batches?{query}").json()
        return [batch["priority"] for batch in answer["items"]]

    assert listed("priority=ci") == ["ci", "ci"]
    assert listed("priority=ci&priority=interactive&limit=2") == ["ci", "interactive"]
    assert len(listed("")) == 6
    page = client.get("/api/v1/batches?priority=ci&limit=1").json()
    token = page["next_page_token"]
    assert listed(f"priority=ci&limit=1&page_token={token}") == ["ci"]
    refused = is_problem(client.get(f"/api/v1/batches?limit=1&page_token={token}"), 422)
    assert refused["problems"][0]["code"] == "bad_page_token"
    assert client.get("/api/v1/batches?priority=late").status_code == 422


def test_pause_resume_and_cancel(offline: Offline, scenario: dict[str, Any]) -> None:
    posted = offline.client.post("/api/v1/batches", json=[scenario, scenario])
    batch = posted.headers["Location"]
    assert offline.client.post(f"{batch}:pause").json()["state"] == "paused"
    assert offline.client.post(f"{batch}:resume").json()["state"] == "open"
    cancelled = offline.client.post(f"{batch}:cancel").json()
    assert (cancelled["done"], cancelled["counts"]) == (True, {"cancelled": 2})
    again = offline.client.post(f"{batch}:resume")
    assert again.status_code == 409
    assert again.headers["Content-Type"] == "application/problem+json"


def test_a_batch_is_judged_to_the_last_run(http: httpx.Client, scenario: dict[str, Any]) -> None:
    scenarios = [{**scenario, "seed": seed} for seed in range(6)]
    posted = http.post("/api/v1/batches", json=scenarios)
    deadline = time.monotonic() + 90
    batch = posted.json()["batch"]
    while not batch["done"]:
        assert time.monotonic() < deadline, batch
        time.sleep(0.1)
        batch = http.get(posted.headers["Location"]).json()
    assert batch["counts"] == {"finished": 6}
    jobs = http.get(batch["jobs_url"]).json()["items"]
    assert sorted(job["item"] for job in jobs) == list(range(6))
