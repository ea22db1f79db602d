"""The examples of the documentation are what a service answers."""

from __future__ import annotations

import importlib
import json
import pkgutil
import re
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.routing import APIRoute
from pydantic import TypeAdapter

from drivora_service.api import routes
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.guards.entity_tags import JSON
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.validation import validate_data
from tests.api.conftest import Offline
from tests.api.record_examples import FOLDER, record_examples
from tests.forked_service import forked_service


def answered() -> Iterator[tuple[str, Any, str]]:
    """Yields the answers of all operations: where, the type of the answer, and its example."""
    for found in pkgutil.iter_modules(routes.__path__):
        module = importlib.import_module(f"{routes.__name__}.{found.name}")
        for route in module.router.routes:
            assert isinstance(route, APIRoute)
            for status, answer in route.responses.items():
                content = answer.get("content", {}).get(JSON)
                if content is not None and route.response_model is not None:
                    where = f"{min(route.methods or ())} {route.path} {status}"
                    yield where, route.response_model, content["example"]


ANSWERS = tuple(answered())


def test_every_operation_that_answers_with_json_has_a_recorded_example() -> None:
    assert len(ANSWERS) >= 29
    assert all(example.startswith(recorded_examples.RECORDED) for _, _, example in ANSWERS)


@pytest.mark.parametrize(
    ("model", "example"), [answer[1:] for answer in ANSWERS], ids=[answer[0] for answer in ANSWERS]
)
def test_what_was_recorded_is_what_the_operation_answers(model: Any, example: str) -> None:
    adapter: TypeAdapter[Any] = TypeAdapter(model)
    content = recorded_examples.read_recorded(example)
    assert json.loads(adapter.dump_json(adapter.validate_python(content))) == content


@pytest.mark.parametrize(
    "example", [recorded_examples.RUN_SCENARIO, recorded_examples.EVALUATION_SCENARIO]
)
def test_recorded_scenarios_can_be_posted(example: str) -> None:
    networks = NetworkCatalogue(shipped_networks())
    assert validate_data(
        recorded_examples.read_recorded(example), networks, None
    ).scenario.ego_vehicles


def test_what_is_recorded_is_shown_whole_and_nothing_else_lies_there(offline: Offline) -> None:
    names = {
        value.removeprefix(recorded_examples.RECORDED)
        for name, value in vars(recorded_examples).items()
        if isinstance(value, str)
        and value.startswith(recorded_examples.RECORDED)
        and name != "RECORDED"
    }
    assert {path.name for path in FOLDER.iterdir()} == names
    document = offline.client.get("/api/v1/openapi.json").json()
    shown = [
        content["example"]
        for methods in document["paths"].values()
        for operation in methods.values()
        for answer in operation["responses"].values()
        for content in answer.get("content", {}).values()
        if "example" in content
    ]
    for name in names:
        assert recorded_examples.read_recorded(recorded_examples.RECORDED + name) in shown, name


def test_recordings_hold_no_trace_of_the_hour_and_the_machine() -> None:
    for path in FOLDER.iterdir():
        text = path.read_text()
        assert set(re.findall(r"\d{4}-\d\d-\d\dT\d\d:\d\d", text)) <= {"2026-03-02T09:30"}, path
        ids = re.findall(r"(?<![0-9a-f])[0-9a-f]{24}(?![0-9a-f])", text)
        assert all(found.startswith("0193a5b0c4d2") for found in ids), path
        assert not re.search(r"/(tmp|home|root)/", text), path


def shape(value: Any) -> Any:
    """Returns keys and kinds of values, the numbers of a kind being alike."""
    if isinstance(value, dict):
        return {key: shape(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [shape(inner) for inner in value[:1]]
    return type(value).__name__


@pytest.mark.slow(seconds=30)
def test_a_service_answers_today_as_it_did_when_it_was_recorded() -> None:
    recorded = record_examples(forked_service)
    assert set(recorded) == {path.name for path in FOLDER.iterdir()}
    for name, text in recorded.items():
        before = (FOLDER / name).read_text()
        if name.endswith("json"):
            assert shape(json.loads(text)) == shape(json.loads(before)), name
        else:
            assert text.split("{")[0] == before.split("{")[0], name
