"""What holds for every document, valid or not."""

from __future__ import annotations

import copy
import json
from typing import Any

import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.canonical import canonical_json, scenario_sha256
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.validation import ValidScenario, validate_data
from tests.fuzzing.harness import check_refusal
from tests.scenario.conftest import AGENTS, GOOD
from tests.scenario.strategies import documents, garbled, json_values, texts

_PATCH = {
    "location": {"x": 50.0, "y": 153.0, "yaw": 7.5},
    "length": 12.5,
    "width": 3.0,
    "friction": 0.2,
}
_NPC = {"model": "audi.tt", "route": [{"x": 60.0, "y": 152.7}, {"x": 30.0, "y": 153.2}]}


@st.composite
def drivable(draw: st.DrawFn) -> dict[str, Any]:
    """Documents whose egos drive along the through road of tee-town, with what a run may vary."""
    content = {
        **draw(documents()),
        "frame": "sumo",
        "ego_vehicles": GOOD["ego_vehicles"],
        "traffic_lights": {},
        "npc_vehicles": [{**_NPC, "id": "npc"}] * draw(st.integers(0, 1)),
        "npc_walkers": [],
        "npc_obstacles": [],
        "friction_patches": [{**_PATCH, "id": "ice"}] * draw(st.integers(0, 1)),
    }
    # What is drawn is changed by tests, and shares nothing with what is drawn next.
    return copy.deepcopy(content)


def validated(content: Any, networks: NetworkCatalogue, **language: Any) -> ValidScenario | None:
    """Returns what validation gives; of what it refuses, checks every place."""
    try:
        return validate_data(content, networks, AGENTS, **language)
    except InvalidDocument as error:
        check_refusal(error, content if isinstance(content, dict) else None)
        return None


def shuffled(content: Any, draw: st.DrawFn) -> Any:
    """The same JSON value with the keys of its objects in another order."""
    if isinstance(content, dict):
        return {key: shuffled(content[key], draw) for key in draw(st.permutations(list(content)))}
    return [shuffled(item, draw) for item in content] if isinstance(content, list) else content


@settings(max_examples=60)
@given(content=garbled(documents()) | garbled(drivable()))
def test_validation_is_total(networks: NetworkCatalogue, content: dict[str, Any]) -> None:
    validated(content, networks)


@given(content=st.dictionaries(texts | st.sampled_from(sorted(GOOD)), json_values, max_size=4))
def test_any_object_is_refused_with_its_places(
    networks: NetworkCatalogue, content: dict[str, Any]
) -> None:
    assert validated(content, networks) is None


@settings(max_examples=50)
@given(data=st.data(), value=json_values)
def test_any_value_in_any_place_is_read_or_refused(
    networks: NetworkCatalogue, data: st.DataObject, value: Any
) -> None:
    content = json.loads(json.dumps(data.draw(drivable())))
    place: Any = content
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        key = data.draw(st.sampled_from(keys))
        if not isinstance(place[key], dict | list) or not place[key] or data.draw(st.booleans()):
            break
        place = place[key]
    place[key] = value
    validated(content, networks)


@settings(max_examples=40)
@given(content=drivable())
def test_validation_is_idempotent(networks: NetworkCatalogue, content: dict[str, Any]) -> None:
    first = validated(content, networks)
    assert first is not None
    again = validated(to_document(first.scenario).model_dump(mode="json"), networks)
    assert again is not None
    assert canonical_json(again.scenario) == canonical_json(first.scenario)
    text = document_text(to_document(again.scenario))
    assert text == document_text(to_document(first.scenario))


@settings(max_examples=40)
@given(data=st.data())
def test_the_identity_does_not_depend_on_the_text(
    networks: NetworkCatalogue, data: st.DataObject
) -> None:
    content = data.draw(drivable())
    other = data.draw(st.composite(lambda draw: shuffled(content, draw))())
    texts_of_it = [
        (json.dumps(content), "json"),
        (json.dumps(other, indent=data.draw(st.integers(0, 4))), "json"),
        (json.dumps(other, ensure_ascii=False, separators=(" ,\n", "\t: ")), "json"),
        (yaml.safe_dump(other), "yaml"),
    ]
    valid = [validated(text, networks, format=language) for text, language in texts_of_it]
    assert len({scenario_sha256(one.scenario) for one in valid if one is not None}) == 1
    assert None not in valid
