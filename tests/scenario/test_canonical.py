"""Canonical JSON: one text for one scenario, and the same scenario back."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import pytest
from hypothesis import given, settings

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario import model
from drivora_service.scenario.canonical import canonical_json, from_canonical, scenario_sha256
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import parse_document
from tests.scenario.strategies import documents, json_values

PLAIN = model.Scenario(
    ego_vehicles=(
        model.EgoVehicle(
            id="ego_0",
            model="vehicle.audi.tt",
            route=(model.Waypoint(x=1e-7, y=-0.0), model.Waypoint(x=100.25, y=1e16, yaw=0.1)),
            agent=model.AgentChoice(name="idm", parameters={"speed_factor": 1.0, "lanes": 1}),
        ),
    ),
    map_region=model.MapRegion(town="tee-town"),
    extensions={"b:é": [1, 1.0, {"z": None, "a": True}], "a:x": '\u2028\U0001f600"\\'},
)

ICE = model.FrictionPatch(
    id="ice", location=model.Waypoint(x=60.0, y=153.0), length=9.0, width=3.0, friction=0.1
)


@settings(max_examples=50)
@given(content=documents())
def test_there_and_back_is_identical(networks: NetworkCatalogue, content: dict[str, Any]) -> None:
    scenario = to_scenario(parse_document(content), networks.get("tee-town"))
    text = canonical_json(scenario)
    assert from_canonical(text) == scenario
    assert canonical_json(from_canonical(text)) == text
    # Called for NaN and infinities, which are no JSON.
    json.loads(text, parse_constant=pytest.fail)


@settings(max_examples=40)
@given(content=documents())
def test_spelling_does_not_matter(networks: NetworkCatalogue, content: dict[str, Any]) -> None:
    network = networks.get("tee-town")
    respelled = json.loads(json.dumps(content, sort_keys=True, indent=3))
    whole = {**respelled, "seed": respelled.get("seed", 0), "npc_vehicles": content["npc_vehicles"]}
    one = to_scenario(parse_document(content), network)
    other = to_scenario(parse_document(whole), network)
    assert scenario_sha256(one) == scenario_sha256(other)


def test_later_fields_leave_the_identity_of_older_scenarios() -> None:
    """The hash is that which scenarios had before actors could join and weather change."""
    walker = model.NpcWalker(id="w", model="walker.pedestrian.0001", route=())
    scenario = dataclasses.replace(PLAIN, npc_walkers=(walker,))
    text = canonical_json(scenario)
    assert "joins" not in text
    assert "weather_changes" not in text
    joined = dataclasses.replace(
        scenario,
        npc_walkers=(dataclasses.replace(walker, joins=True),),
        weather_changes=(model.WeatherChange(time=1.0, weather=model.Weather()),),
    )
    assert from_canonical(canonical_json(joined)) == joined
    assert len({scenario_sha256(one) for one in (PLAIN, scenario, joined)}) == 3


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
        scenario_sha256(dataclasses.replace(scenario, friction_patches=(ICE,))),
        scenario_sha256(
            dataclasses.replace(
                scenario, friction_patches=(dataclasses.replace(ICE, friction=0.3),)
            )
        ),
        scenario_sha256(dataclasses.replace(scenario, extensions={"a:b": 1})),
    }
    assert len(hashes) == 7


def test_scenarios_without_patches_keep_their_text() -> None:
    assert "friction_patches" not in canonical_json(PLAIN)
    # As it was before the document had patches.
    assert (
        scenario_sha256(PLAIN) == "cc3d6b3b94730aa103618f7c555e221999775f39f8ee5aa0a7c4c2fd5076f5f2"
    )


@given(content=documents(), extension=json_values)
def test_the_text_is_pythons_own_json_and_is_read_to_the_same_values(
    networks: NetworkCatalogue, content: dict[str, Any], extension: Any
) -> None:
    scenario = to_scenario(parse_document(content), networks.get("tee-town"))
    scenario = dataclasses.replace(scenario, extensions={"a:b": extension})
    text = canonical_json(scenario)
    values = json.loads(text)
    assert text == json.dumps(
        values, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )
    # As texts, so that 1, 1.0 and true differ.
    assert repr(from_canonical(text).extensions["a:b"]) == repr(values["extensions"]["a:b"])


@pytest.mark.parametrize(
    "number",
    [1e16, 1e22, 1e-5, 1e-7, -0.0, 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, 0.1],
)
def test_floats_are_written_as_python_does_and_read_to_the_same_bits(number: float) -> None:
    scenario = dataclasses.replace(
        PLAIN, weather=model.Weather(wetness=number), extensions={"a:b": number}
    )
    text = canonical_json(scenario)
    assert f'"wetness":{number!r},' in text
    assert f'"extensions":{{"a:b":{number!r}}}' in text
    read = from_canonical(text)
    for value in (read.weather.wetness, read.extensions["a:b"]):
        assert value == number
        assert math.copysign(1.0, value) == math.copysign(1.0, number)


def test_the_identity_of_a_scenario_is_for_good() -> None:
    identity = "cc3d6b3b94730aa103618f7c555e221999775f39f8ee5aa0a7c4c2fd5076f5f2"
    assert scenario_sha256(PLAIN) == identity
    assert from_canonical(canonical_json(PLAIN)) == PLAIN
