"""One ADS with different parameters, as the API tells its runs and campaigns apart."""

from __future__ import annotations

import copy
from typing import Any

import httpx

from drivora_service.api.documentation.recorded_examples import CAMPAIGN
from tests.api.conftest import Offline

SLOWED = "idm · reaction_time 1.0"


def post(http: httpx.Client, scenario: dict[str, Any], **query: Any) -> dict[str, Any]:
    posted = http.post("/api/v1/jobs", json=scenario, params={"agent": "idm", **query})
    assert posted.status_code == 202, posted.text
    return dict(posted.json())


def test_jobs_are_filtered_and_counted_by_configuration(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    http = offline.client
    plain = post(http, scenario)
    slowed = post(http, scenario, agent_parameter="reaction_time=1")
    assert (plain["configuration"], slowed["configuration"]) == ("idm", SLOWED)
    wanted = {"configuration": slowed["configuration_id"]}
    for path in ("jobs", "runs"):
        items = http.get(f"/api/v1/{path}", params=wanted).json()["items"]
        assert [one["id"] for one in items] == [slowed["id"]]
    counts = http.get("/api/v1/runs:counts", params={"agent": "idm"}).json()
    assert counts["agent"] == {"idm": 2}
    assert counts["configurations"] == [
        {"id": one["configuration_id"], "words": one["configuration"], "runs": 1}
        for one in (plain, slowed)
    ]


def test_the_parameters_of_a_documented_agent_are_part_of_it(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    for ego in scenario["ego_vehicles"]:
        ego["agent"] = {"name": "idm", "parameters": {"reaction_time": 1.0}}
    documented = offline.client.post("/api/v1/jobs", json=scenario).json()
    assert documented["configuration"] == SLOWED
    # In place of another agent, an agent has its defaults.
    other = offline.client.post("/api/v1/jobs", json=scenario, params={"agent": "idm-mobil"})
    assert other.json()["configuration"] == "idm-mobil"


def test_a_campaign_names_its_agent_with_its_parameters(offline: Offline) -> None:
    content = copy.deepcopy(CAMPAIGN)
    content["agent"] = {"name": "idm", "parameters": {"reaction_time": 1.0}}
    posted = offline.client.post("/api/v1/campaigns", json=content)
    assert posted.status_code in (201, 202), posted.text
    assert (posted.json()["agent"], posted.json()["configuration"]) == ("idm", SLOWED)
    assert len(posted.json()["configuration_id"]) == 8


def test_found_failures_and_suites_take_the_filter(offline: Offline) -> None:
    for path in ("failures", "suite-runs"):
        found = offline.client.get(f"/api/v1/{path}", params={"configuration": "0" * 8})
        assert (found.status_code, found.json()["items"]) == (200, [])
