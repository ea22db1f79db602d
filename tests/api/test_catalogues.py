from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.api.conftest import MakeOffline, Offline
from tests.oracles.installing import install_oracles


def test_networks_and_their_geometry(offline: Offline) -> None:
    names = [item["name"] for item in offline.client.get("/api/v1/networks").json()["items"]]
    assert "tee-town" in names
    network = offline.client.get("/api/v1/networks/tee-town").json()
    geometry = offline.client.get(network["geometry_url"])
    assert len(geometry.json()["lanes"]) == network["lanes"]
    known = {"If-None-Match": geometry.headers["ETag"]}
    assert offline.client.get(network["geometry_url"], headers=known).status_code == 304


def test_every_example_scenario_can_be_posted(offline: Offline) -> None:
    examples = offline.client.get("/api/v1/scenarios:examples").json()["items"]
    assert len({example["name"] for example in examples}) == len(examples) > 10
    assert examples[0]["name"] == "church lane"
    for example in examples:
        checked = offline.client.post("/api/v1/scenarios:validate", json=example["document"])
        assert checked.status_code == 200, (example["name"], checked.text)


def test_agents_and_oracles(offline: Offline) -> None:
    agents = {item["name"]: item for item in offline.client.get("/api/v1/agents").json()["items"]}
    assert agents["idm"]["installed"] is True
    assert (agents["idm"]["privileged"], agents["sumo-idm"]["privileged"]) == (False, True)
    speed, reaction = agents["idm"]["parameters"]
    assert (speed["name"], speed["default"]) == ("speed_factor", 1.0)
    assert speed["values"] == {"type": "number", "minimum": 0.1, "maximum": 2.0}
    assert (reaction["name"], reaction["default"]) == ("reaction_time", 0.0)
    assert reaction["values"] == {"type": "number", "minimum": 0.0, "maximum": 3.0}
    assert agents["fop"]["parameters"] == []
    oracles = {o["name"]: o for o in offline.client.get("/api/v1/oracles").json()["items"]}
    assert {"collision", "red_light", "off_road"} <= set(oracles)
    assert all(oracle["description"] for oracle in oracles.values())
    assert oracles["speeding"]["thresholds"]
    assert all(oracle["installed"] and not oracle["package"] for oracle in oracles.values())


def test_models_of_actors(offline: Offline) -> None:
    models = offline.client.get("/api/v1/models").json()["items"]
    kinds: dict[str, set[str]] = {}
    for model in models:
        kinds.setdefault(model["kind"], set()).add(model["name"])
        assert model["length"] > 0.0
        assert model["width"] > 0.0
    assert "vehicle.audi.a2" in kinds["vehicle"] & kinds["obstacle"]
    assert "walker.pedestrian.0001" in kinds["walker"]
    assert "static.prop.container" in kinds["obstacle"]
    (van,) = [
        model
        for model in models
        if (model["kind"], model["name"]) == ("vehicle", "vehicle.ford.ambulance")
    ]
    assert (van["vehicle_class"], van["length"], van["max_speed"]) == ("van", 6.37, 45.0)


def test_oracles_of_packages_are_listed_with_what_is_wrong_with_them(
    make_offline: MakeOffline, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_oracles(tmp_path / "site", monkeypatch, "top_speed", "unmade")
    listed = make_offline().client.get("/api/v1/oracles").json()["items"]
    good, bad = listed[-2:]
    assert (good["name"], good["package"]) == ("top_speed", "foreign-oracles")
    assert (good["thresholds"], good["installed"]) == ({"limit": 5.0}, True)
    assert (bad["name"], bad["installed"]) == ("unmade", False)
    assert "no such file" in bad["reason"]


def test_health_and_readiness(offline: Offline, http: httpx.Client) -> None:
    assert http.get("/healthz").json()["status"] == "ok"
    assert http.get("/readyz").json()["ready"] is True
    assert http.get("/api/v1/healthz").status_code == 200
    without_workers = offline.client.get("/readyz")
    assert without_workers.status_code == 503
    checks = {check["name"]: check["ok"] for check in without_workers.json()["checks"]}
    assert checks == {"workers": False}
    whole = {check["name"] for check in http.get("/readyz").json()["checks"]}
    assert whole == {
        "database",
        "traces",
        "data",
        "workers",
        "campaigns",
        "accepting",
        "tokens",
    }


def test_metrics_count_runs(http: httpx.Client, finished_run: dict[str, object]) -> None:
    text = http.get("/metrics").text
    finished = re.search(r'^drivora_runs\{status="finished"\} (\d+)', text, re.MULTILINE)
    assert finished is not None
    assert int(finished.group(1)) >= 1
    assert 'drivora_runs{status="queued"}' in text


def test_every_value_of_a_run_is_described(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    answer = http.get("/api/v1/metrics:describe")
    items = answer.json()["items"]
    metrics = [item["name"] for item in items if item["kind"] == "metric"]
    objectives = [item["name"] for item in items if item["feedback"] == "general"]
    assert metrics == list(finished_run["metrics"])
    assert objectives == list(finished_run["scores"])
    known = {"If-None-Match": answer.headers["ETag"]}
    assert http.get("/api/v1/metrics:describe", headers=known).status_code == 304


def test_every_oracle_that_judged_is_described(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    told = {item["name"]: item for item in http.get("/api/v1/oracles").json()["items"]}
    for oracle in {verdict["oracle"] for verdict in finished_run["verdicts"]}:
        one = told[oracle]
        assert one["definition"].endswith(".")
        assert one["source"]
        names = [threshold["name"] for threshold in one["threshold_descriptions"]]
        assert names == list(one["thresholds"])
        assert (one["unit"] == "") == (one["violated_by"] == "event")
