"""The JSON Schema of campaigns: current, documented, and consistent with the documents."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest

from drivora_service.campaigns.document.campaign_schema import (
    campaign_schema,
    schema_path,
    schema_text,
)
from tests.campaigns.document.test_campaign_reading import WRONG

BEYOND_THE_SCHEMA = frozenset(
    {
        # Problems that only the catalogues, the network or the server can find.
        "unknown tester",
        "too gentle braking",
        "tester's parameters",
        "a tester's parameter beyond all budgets",
        "a tester's parameter beyond the budget",
        "unknown mutation",
        "unknown selection",
        "unknown agent",
        "agent's parameters",
        "parameters of an agent in the scenario",
        "unknown oracle",
        "misspelt oracle",
        "oracle twice",
        "scenario of another town",
        "unknown model",
        "scenario in a file",
        "a scenario among several",
        "scenarios of one name",
        "NaN",
    }
)


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = campaign_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_committed_file_is_current() -> None:
    assert schema_path().read_text() == schema_text(), "run `make schema`"


def test_examples_fit(validator: jsonschema.Draft202012Validator, content: dict[str, Any]) -> None:
    validator.validate(content)
    for example in campaign_schema()["examples"]:
        validator.validate(example)


@pytest.mark.parametrize("name", sorted(WRONG.keys() - BEYOND_THE_SCHEMA))
def test_what_is_wrong_in_itself_does_not_fit(
    name: str, validator: jsonschema.Draft202012Validator, content: dict[str, Any]
) -> None:
    WRONG[name][0](content)
    with pytest.raises(jsonschema.ValidationError):
        validator.validate(content)


@pytest.mark.parametrize("name", sorted(BEYOND_THE_SCHEMA - {"NaN"}))
def test_what_only_catalogues_know_fits(
    name: str, validator: jsonschema.Draft202012Validator, content: dict[str, Any]
) -> None:
    WRONG[name][0](content)
    validator.validate(content)


def test_everything_is_described() -> None:
    schema = json.loads(schema_text())
    for path, entry in _properties(schema):
        assert entry.get("description"), path


def _properties(node: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(node, dict):
        for name, entry in node.get("properties", {}).items():
            yield f"{path}/{name}", entry
        for key, child in node.items():
            yield from _properties(child, f"{path}/{key}")
    elif isinstance(node, list):
        for child in node:
            yield from _properties(child, path)
