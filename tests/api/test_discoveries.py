"""Failures against simulations: of a campaign, and of the repetitions of a study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from drivora_service.store.campaigns.campaign_records import CampaignState, Confirmation
from tests.api.conftest import Offline
from tests.api.test_campaigns import finished as finished  # a fixture
from tests.api.test_problem_details import is_problem
from tests.studies.example_study import run_computed, study_content

Json = dict[str, Any]


def test_the_curves_of_a_campaign_are_those_of_its_evaluations(
    http: httpx.Client, finished: Json
) -> None:
    one = f"/api/v1/campaigns/{finished['id']}"
    found = http.get(f"{one}/discoveries").json()
    evaluations = http.get(f"{one}/evaluations?limit=500").json()["items"]
    failures = http.get(f"{one}/failures?limit=500").json()["items"]
    assert any(failure["confirmation"] == "confirmed" for failure in failures)
    simulated = [e["number"] for e in evaluations if e["status"] != "invalid"]
    counting = {f["evaluation"] for f in failures if is_avoidable(f["verdict"])}
    failing = {f["evaluation"] for f in failures}
    assert found["simulations"] == len(simulated)
    assert found["at"][0] == 0
    assert found["at"][-1] == len(simulated)
    for place, after in enumerate(found["at"]):
        done = set(simulated[:after])
        assert found["avoidable"][place] == len(done & counting)
        assert found["others"][place] == len(done & (failing - counting))
        kinds = {f["kind"] for f in failures if f["evaluation"] in done}
        assert found["different"][place] == len(kinds)
        for curve in found["oracles"]:
            own = {f["evaluation"] for f in failures if f["verdict"]["oracle"] == curve["name"]}
            assert curve["avoidable"][place] + curve["others"][place] == len(done & own)
    assert found["first_failure"] == simulated.index(min(failing)) + 1
    assert {curve["name"] for curve in found["kinds"]} == {f["kind"] for f in failures}
    assert found["kinds_left_out"] == 0


def is_avoidable(verdict: Json) -> bool:
    return bool(verdict["at_fault"]) and verdict["avoidable"] in (None, "yes")


def test_curves_have_no_more_points_and_kinds_than_wanted(
    http: httpx.Client, finished: Json
) -> None:
    one = f"/api/v1/campaigns/{finished['id']}/discoveries"
    whole = http.get(one, params={"points": 2000}).json()
    cut = http.get(one, params={"points": 3, "kinds": 1}).json()
    assert len(whole["at"]) > 3
    assert len(cut["at"]) == 3
    assert (cut["at"][-1], cut["others"][-1]) == (whole["at"][-1], whole["others"][-1])
    assert [curve["name"] for curve in cut["kinds"]] == [whole["kinds"][0]["name"]]
    assert cut["kinds_left_out"] == len(whole["kinds"]) - 1
    assert cut["first_failure"] == whole["first_failure"]
    answer = http.get(one)
    known = {"If-None-Match": answer.headers["ETag"]}
    assert http.get(one, headers=known).status_code == 304
    is_problem(http.get(f"{one}?points=1"), 422)
    is_problem(http.get("/api/v1/campaigns/none/discoveries"), 404)


@pytest.fixture
def study(offline: Offline, tmp_path: Path) -> Json:
    """A study with computed runs."""
    posted = offline.client.post("/api/v1/studies", json=study_content()).json()
    context = offline.context
    run_computed(context.database, context.catalogues, tmp_path, posted["id"])
    found: Json = offline.client.get(f"/api/v1/studies/{posted['id']}").json()
    return found


def test_bands_are_the_quartiles_of_the_campaigns(offline: Offline, study: Json) -> None:
    answer = offline.client.get(f"/api/v1/studies/{study['id']}/bands").json()
    assert answer["unfinished"] == 0
    assert [(b["scenario"], b["agent"], b["method"]) for b in answer["bands"]] == [
        (scenario, agent, method)
        for scenario in ("first", "second")
        for agent in ("idm", "idm-mobil")
        for method in ("random", "fuzzer")
    ]
    tops = []
    for band in answer["bands"]:
        curves = [
            offline.client.get(f"/api/v1/campaigns/{one}/discoveries").json()
            for one in band["campaigns"]
        ]
        assert len(curves) == 2
        assert band["at"][-1] == min(curve["simulations"] for curve in curves)
        assert band["first_avoidable"] == [curve["first_avoidable"] for curve in curves]
        for name in ("avoidable", "different", "different_avoidable"):
            rows = [interpolated(curve, name, band["at"]) for curve in curves]
            assert band[name]["median"] == np.median(rows, axis=0).tolist()
            assert band[name]["low"] == np.quantile(rows, 0.25, axis=0).tolist()
            assert band[name]["high"] == np.quantile(rows, 0.75, axis=0).tolist()
        tops.append(band["avoidable"]["high"][-1])
    assert max(tops) > 0.0


def interpolated(curve: Json, name: str, at: list[int]) -> list[int]:
    """The value of a step curve at other points."""
    places = np.searchsorted(curve["at"], at, side="right") - 1
    return [curve[name][place] for place in places]


def test_bands_are_chosen_by_name(offline: Offline, study: Json) -> None:
    bands = f"/api/v1/studies/{study['id']}/bands"
    wanted = {"method": "random", "agent": "idm"}
    chosen = offline.client.get(bands, params=wanted).json()["bands"]
    assert [(b["scenario"], b["agent"], b["method"]) for b in chosen] == [
        ("first", "idm", "random"),
        ("second", "idm", "random"),
    ]
    is_problem(offline.client.get(bands, params={"method": "fuzzzer"}), 404)
    is_problem(offline.client.get("/api/v1/studies/none/bands"), 404)


def test_campaigns_that_have_not_finished_are_counted_and_left_out(offline: Offline) -> None:
    posted = offline.client.post("/api/v1/studies", json=study_content()).json()
    answer = offline.client.get(f"/api/v1/studies/{posted['id']}/bands?method=random").json()
    assert (answer["bands"], answer["unfinished"]) == ([], 8)


def test_failures_that_were_not_repeated_are_left_out(offline: Offline, study: Json) -> None:
    database = offline.context.database
    with database.read() as transaction:
        ids = transaction.studies.campaign_ids(study["id"], (CampaignState.FINISHED,))
        failures = {one: transaction.evaluations.failures(one) for one in ids}
    campaign_id = next(one for one, found in failures.items() if found)
    before = offline.client.get(f"/api/v1/campaigns/{campaign_id}/discoveries").json()
    first = failures[campaign_id][0].evaluation
    with database.write() as transaction:
        transaction.evaluations.confirm(campaign_id, first, Confirmation.FLAKY, trace="")
    after = offline.client.get(f"/api/v1/campaigns/{campaign_id}/discoveries").json()
    assert before["flaky"] == 0
    assert after["flaky"] == 1
    total = before["avoidable"][-1] + before["others"][-1]
    assert after["avoidable"][-1] + after["others"][-1] == total - 1


def test_a_campaign_without_failures_has_flat_curves(offline: Offline) -> None:
    posted = offline.client.post("/api/v1/studies", json=study_content()).json()
    (one, *_) = offline.client.get(posted["campaigns_url"]).json()["items"]
    found = offline.client.get(f"/api/v1/campaigns/{one['id']}/discoveries").json()
    assert (found["at"], found["avoidable"], found["others"]) == ([0], [0], [0])
    assert (found["first_failure"], found["oracles"], found["kinds"]) == (None, [], [])
