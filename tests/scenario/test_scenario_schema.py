"""The JSON Schema: current, documented, and of one mind with the documents about structure."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given, settings

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import document_text, parse_document
from drivora_service.scenario.scenario_schema import document_schema, schema_path, schema_text
from drivora_service.scenario.validation import validate_document
from tests.scenario.conftest import GOOD
from tests.scenario.strategies import documents, garbled
from tests.scenario.test_bad_input import BROKEN

AGENTS = ("idm", "idm-mobil", "pdm-closed", "sumo-krauss")
EXAMPLES = sorted((Path(__file__).parents[2] / "openscenario_schemas" / "examples").glob("*.json"))
BEYOND_THE_SCHEMA = frozenset(
    {
        # Texts that are no document, or not the document any more that was written.
        "empty text",
        "no JSON",
        "no object",
        "no UTF-8",
        "100 MB",
        "a million brackets",
        "two million values",
        "repeated key",
        # Bounds of the whole document.
        "nesting in a known key",
        "nesting in free data",
        "large extension",
        "half a surrogate",
        "NaN",
        "infinity",
        # What relates one place to another, to the network or to a catalogue.
        "same id twice",
        "patch with an actor's id",
        "patch beside the road",
        "patch off the map",
        "agent and config_path",
        "count and density",
        "empty region",
        "unknown agent",
        "unknown model",
        "walker as ego",
        "unknown town",
        "unknown light",
        "SUMO without a way",
        "start outside the region",
        "start off the map",
        "walker off the map",
        "start is the destination",
        "overlapping starts",
    }
)
"""Problems that a schema cannot express."""


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = document_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_committed_file_is_current() -> None:
    assert schema_path().read_text() == schema_text(), "run `make schema`"


def test_every_property_is_described() -> None:
    for path, entry in _properties(document_schema()):
        assert entry.get("description"), path


def test_every_number_has_a_unit() -> None:
    text = json.dumps(document_schema())
    schema = json.loads(text)
    for path, entry in _numbers(schema):
        assert "x-unit" in entry, path
        assert "minimum" in entry, path
        assert "maximum" in entry, path


def test_the_example_in_the_schema_is_valid(
    networks: NetworkCatalogue, validator: jsonschema.Draft202012Validator
) -> None:
    for example in document_schema()["examples"]:
        validator.validate(example)
        validate_document(parse_document(example), networks, AGENTS)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_valid(
    path: Path, networks: NetworkCatalogue, validator: jsonschema.Draft202012Validator
) -> None:
    text = path.read_text()
    validator.validate(json.loads(text))
    document = parse_document(text)
    notes = validate_document(document, networks, AGENTS).notes
    # Its waypoints lie far apart: the vehicle that cuts in slows down at their corners.
    expected = ["NPC 'cut_in': slows down"] if path.stem == "highway-cut-in" else []
    assert [note.split(" from ")[0] for note in notes] == expected
    assert document_text(document) == text


def test_examples_cover_every_entity() -> None:
    used: set[str] = set()
    for path in EXAMPLES:
        used |= json.loads(path.read_text()).keys()
    assert len(EXAMPLES) >= 6
    assert used >= {
        "ego_vehicles",
        "npc_vehicles",
        "npc_walkers",
        "npc_obstacles",
        "map_region",
        "weather",
        "traffic_lights",
        "background_traffic",
        "extensions",
    }


@settings(max_examples=40)
@given(content=documents())
def test_what_documents_accept_the_schema_accepts(
    validator: jsonschema.Draft202012Validator, content: dict[str, Any]
) -> None:
    validator.validate(json.loads(document_text(parse_document(content))))
    validator.validate(content)


@settings(max_examples=60)
@given(content=garbled(documents()))
def test_what_the_schema_refuses_documents_refuse(
    validator: jsonschema.Draft202012Validator, content: dict[str, Any]
) -> None:
    try:
        parse_document(content)
    except InvalidDocument:
        return
    validator.validate(content)


@pytest.mark.parametrize("name", sorted(BROKEN.keys() - BEYOND_THE_SCHEMA))
def test_broken_structure_is_refused(name: str, validator: jsonschema.Draft202012Validator) -> None:
    change, pointer = BROKEN[name]
    changed = change(json.loads(json.dumps(GOOD)))
    errors = list(validator.iter_errors(changed))
    assert errors
    places = ["".join(f"/{token}" for token in error.absolute_path) for error in errors]
    assert any(pointer.startswith(place) for place in places)


def _properties(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for name, definition in {"": schema, **schema["$defs"]}.items():
        for key, entry in definition.get("properties", {}).items():
            yield f"{name}.{key}", entry


def _numbers(entry: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(entry, dict):
        if entry.get("type") in ("number", "integer"):
            yield path, entry
        for key, inner in entry.items():
            if key not in ("examples", "default"):
                yield from _numbers(inner, f"{path}/{key}")
    elif isinstance(entry, list):
        for index, inner in enumerate(entry):
            yield from _numbers(inner, f"{path}/{index}")
