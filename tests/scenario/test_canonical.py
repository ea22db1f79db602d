"""Canonical JSON: one text for one scenario, and the same scenario back."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

from hypothesis import given

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario import model
from drivora_service.scenario.canonical import canonical_json, from_canonical, scenario_sha256
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import parse_document
from tests.scenario.strategies import documents


@given(content=documents())
def test_there_and_back_is_identical(networks: NetworkCatalogue, content: dict[str, Any]) -> None:
    scenario = to_scenario(parse_document(content), networks.get("tee-town"))
    text = canonical_json(scenario)
    assert from_canonical(text) == scenario
    assert canonical_json(from_canonical(text)) == text
    assert "NaN" not in text


@given(content=documents())
def test_spelling_does_not_matter(networks: NetworkCatalogue, content: dict[str, Any]) -> None:
    network = networks.get("tee-town")
    respelled = json.loads(json.dumps(content, sort_keys=True, indent=3))
    whole = {**respelled, "seed": respelled.get("seed", 0), "npc_vehicles": content["npc_vehicles"]}
    one = to_scenario(parse_document(content), network)
    other = to_scenario(parse_document(whole), network)
    assert scenario_sha256(one) == scenario_sha256(other)


def test_names_and_numbers_are_normal(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    network = networks.get("tee-town")
    first = to_scenario(parse_document(good), network)
    good["ego_vehicles"][0]["model"] = "MKZ_2017"
    good["ego_vehicles"][0]["start_time"] = 0
    good["ego_vehicles"][0]["route"][0]["x"] = 100
    assert canonical_json(to_scenario(parse_document(good), network)) == canonical_json(first)


def test_any_change_changes_the_hash(networks: NetworkCatalogue, good: dict[str, Any]) -> None:
    scenario = to_scenario(parse_document(good), networks.get("tee-town"))
    hashes = {
        scenario_sha256(scenario),
        scenario_sha256(dataclasses.replace(scenario, seed=1)),
        scenario_sha256(dataclasses.replace(scenario, weather=model.Weather(wetness=1e-9))),
        scenario_sha256(dataclasses.replace(scenario, max_sim_time=10.0)),
        scenario_sha256(dataclasses.replace(scenario, extensions={"a:b": 1})),
    }
    assert len(hashes) == 5
