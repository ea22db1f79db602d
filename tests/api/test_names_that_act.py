"""Names with control and direction characters over HTTP: refused with their place, nothing kept."""

from __future__ import annotations

import copy
from typing import Any

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SUITE_RUN_REQUEST
from tests.api.conftest import Offline
from tests.api.test_campaigns import small_campaign
from tests.api.test_problem_details import is_problem
from tests.hostile_names import ACTING, MARKUP

EVIL = "abc\u202egpj.exe"
FOUND = "found U+202E (right-to-left override) as character 4 of 11"


def problems(answer: httpx.Response) -> dict[str, str]:
    """Returns the messages of a refusal by their places."""
    assert is_problem(answer, 422), answer.text
    return {one["pointer"]: one["message"] for one in answer.json()["problems"]}


# JSON text in which a NUL stands is refused for that, wherever it is.
@pytest.mark.parametrize("name", [name for name in ACTING if "\0" not in name], ids=ascii)
def test_a_campaign_has_no_such_name(offline: Offline, name: str) -> None:
    for path in ("campaigns", "campaigns:validate"):
        answer = offline.client.post(
            f"/api/v1/{path}", json=small_campaign("random") | {"name": name}
        )
        assert problems(answer)["/name"].startswith("found U+")
    assert offline.client.get("/api/v1/campaigns").json()["items"] == []


@pytest.mark.parametrize("name", MARKUP, ids=ascii)
def test_a_campaign_may_have_any_other(offline: Offline, name: str) -> None:
    answer = offline.client.post(
        "/api/v1/campaigns", json=small_campaign("random") | {"name": name}
    )
    assert answer.status_code == 202, answer.text
    assert offline.client.get(answer.headers["Location"]).json()["name"] == name


def test_runs_and_batches_have_no_such_labels(offline: Offline, scenario: dict[str, Any]) -> None:
    job = offline.client.post("/api/v1/jobs", json=scenario, params={"label": EVIL})
    assert FOUND in problems(job)[""]
    assert "query parameter 'label'" in problems(job)[""]
    batch = offline.client.post("/api/v1/batches", json=[scenario], params={"name": EVIL})
    assert FOUND in problems(batch)[""]
    posted = [{"label": EVIL, "scenario": scenario}, scenario]
    mixed = offline.client.post("/api/v1/batches", json=posted).json()
    assert (mixed["accepted"], mixed["rejected"]) == (1, 1)
    (problem,) = mixed["items"][0]["problems"]
    assert problem["pointer"] == "/label"
    assert problem["message"].startswith(FOUND)


def test_ids_of_actors_are_plain(offline: Offline, scenario: dict[str, Any]) -> None:
    scenario["ego_vehicles"][0]["id"] = EVIL
    assert "/ego_vehicles/0/id" in problems(offline.client.post("/api/v1/jobs", json=scenario))


@pytest.mark.parametrize("place", ["suite", "agent", "baseline", "scenario"])
def test_runs_of_suites_have_no_such_names(offline: Offline, place: str) -> None:
    wanted = copy.deepcopy(SUITE_RUN_REQUEST)
    if place == "scenario":
        wanted["outcomes"][0]["scenario"] = EVIL
    else:
        wanted["decision"][place] = EVIL
    answer = "".join(problems(offline.client.post("/api/v1/suite-runs", json=wanted)).values())
    assert FOUND in answer
