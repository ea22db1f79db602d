"""Reading documents: what is accepted, what is refused, and where the problem is."""

from __future__ import annotations

import json
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.errors import InvalidDocument
from drivora_service.scenario.documents import (
    ScenarioDocument,
    document_text,
    parse_document,
    with_agent,
    with_background,
)
from tests.scenario.strategies import documents, garbled


def problems_of(data: Any, **options: Any) -> dict[str, str]:
    with pytest.raises(InvalidDocument) as caught:
        parse_document(data, **options)
    return {problem.pointer: problem.message for problem in caught.value.problems}


def test_defaults(good: dict[str, Any]) -> None:
    document = parse_document(json.dumps(good))
    assert document.step_length == 0.05
    assert document.weather.sun_altitude_angle == 70.0
    assert document.background_traffic is None
    assert document.ego_vehicles[0].agent_name == "idm"


def test_yaml_and_json_read_alike(good: dict[str, Any]) -> None:
    text = yaml.safe_dump(good)
    assert parse_document(text, "yaml") == parse_document(json.dumps(good).encode(), "json")


@pytest.mark.parametrize(
    ("config_path", "name"),
    [
        ("idm", "idm"),
        ("idm.yaml", "idm"),
        ("configs/idm.yml", "idm"),
        ("configs/sumo-eidm.json", "sumo-eidm"),
    ],
)
def test_config_path_names_an_agent(good: dict[str, Any], config_path: str, name: str) -> None:
    del good["ego_vehicles"][0]["agent"]
    good["ego_vehicles"][0]["config_path"] = config_path
    assert parse_document(good).ego_vehicles[0].agent_name == name


@pytest.mark.parametrize(
    "config_path", ["../idm", "/etc/idm.yaml", "configs/../idm", "a/b/idm", "idm.py", "", "idm\n"]
)
def test_config_path_is_no_path(good: dict[str, Any], config_path: str) -> None:
    del good["ego_vehicles"][0]["agent"]
    good["ego_vehicles"][0]["config_path"] = config_path
    found = problems_of(good)
    assert list(found) == ["/ego_vehicles/0/config_path"]
    assert "NAME, NAME.yaml or configs/NAME.yaml" in found["/ego_vehicles/0/config_path"]


def test_every_problem_is_named_in_document_order(good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["route"][1]["y"] = "98"
    good["ego_vehicles"][0]["route"][0]["x"] = True
    good["seed"] = -1
    good["npc_walkers"] = [{"id": "ego_0", "model": "walker.pedestrian.0001", "route": []}]
    good["wether"] = {}
    found = problems_of(good)
    assert list(found) == [
        "/ego_vehicles/0/route/0/x",
        "/ego_vehicles/0/route/1/y",
        "/seed",
        "/npc_walkers/0/id",
        "/npc_walkers/0/route",
        "/wether",
    ]
    assert found["/ego_vehicles/0/route/1/y"] == (
        "found text '98'; a number is needed, without a unit: it is in m"
    )
    assert "did you mean 'weather'?" in found["/wether"]
    assert "/ego_vehicles/0/id" in found["/npc_walkers/0/id"]


def test_wrong_items_are_not_also_a_list_too_short(good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["route"] = [{"x": "a", "y": 1}, {"x": 2, "y": 3}]
    assert list(problems_of(good)) == ["/ego_vehicles/0/route/0/x"]
    good["ego_vehicles"][0]["route"] = [{"x": 2, "y": 3}]
    found = problems_of(good)
    assert found == {"/ego_vehicles/0/route": "found 1 item; at least 2 are needed"}


def test_keys_with_slashes_and_tildes_are_escaped(good: dict[str, Any]) -> None:
    good["traffic_lights"] = {"junctions": {"a/b~c": {"green_time": 0}}}
    assert list(problems_of(good)) == ["/traffic_lights/junctions/a~1b~0c/green_time"]


def test_odd_values_are_named_together_with_structural_problems(good: dict[str, Any]) -> None:
    text = json.dumps(good).replace("152.1", "NaN", 1).replace('"idm"', '"i dm"')
    assert list(problems_of(text)) == ["/ego_vehicles/0/route/0/y", "/ego_vehicles/0/agent/name"]


def test_number_of_problems_is_bounded(good: dict[str, Any]) -> None:
    good["ego_vehicles"][0]["route"] = [{"x": "a", "y": "b"}] * 2000
    with pytest.raises(InvalidDocument) as caught:
        parse_document(good)
    assert len(caught.value.problems) == 101
    assert caught.value.problems[-1].message == "3900 further problems are not listed"


def test_with_agent_replaces_every_choice(good: dict[str, Any]) -> None:
    good["ego_vehicles"][0] = {**good["ego_vehicles"][0], "config_path": "idm.yaml"}
    del good["ego_vehicles"][0]["agent"]
    document = with_agent(parse_document(good), "sumo-krauss")
    assert document.ego_vehicles[0].agent_name == "sumo-krauss"
    assert document.ego_vehicles[0].config_path is None
    with pytest.raises(InvalidDocument):
        with_agent(document, "../idm")


def test_with_background(good: dict[str, Any]) -> None:
    document = with_background(parse_document(good), 5)
    assert document.background_traffic is not None
    assert document.background_traffic.count == 5
    with pytest.raises(InvalidDocument):
        with_background(document, -1)


@settings(max_examples=40)
@given(documents())
def test_documents_survive_writing_and_reading(content: dict[str, Any]) -> None:
    document = parse_document(content)
    assert parse_document(document_text(document)) == document
    assert parse_document(document.model_dump(mode="json")) == document
    assert document_text(parse_document(document_text(document))) == document_text(document)


@settings(max_examples=80)
@given(garbled(documents()))
def test_garbled_documents_are_refused_or_read(content: dict[str, Any]) -> None:
    try:
        document = parse_document(content)
    except InvalidDocument:
        return
    assert isinstance(document, ScenarioDocument)


@given(st.text() | st.binary(), st.sampled_from(["json", "yaml"]))
def test_any_text_is_refused_or_read(data: str | bytes, language: Any) -> None:
    with pytest.raises(InvalidDocument):
        parse_document(data, language)


@settings(max_examples=50)
@given(st.data())
def test_cut_texts_are_refused(data: st.DataObject) -> None:
    text = document_text(parse_document(data.draw(documents())))
    cut = data.draw(st.integers(0, len(text) - 3))
    with pytest.raises(InvalidDocument):
        parse_document(text[:cut])
