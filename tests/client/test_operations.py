"""The operations of the clients are those of the API."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import AsyncIterator, Iterator, Mapping
from pathlib import Path
from typing import Any, assert_type

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SUITE_RUN_REQUEST
from drivora_service.api.schemas.service import Health
from drivora_service.api.schemas.suites import SuiteRunRequest
from drivora_service.client import AsyncClient, Call, Client, Listing
from drivora_service.client.operations import Answered, Listed, Operations, Saved, Told
from drivora_service.store.runs.run_records import RunSummary
from tests.client.scripted_server import ok, scripted

_SUITE_RUN = SuiteRunRequest.model_validate(SUITE_RUN_REQUEST)
_GIVEN: Mapping[str, Any] = {
    "decision": _SUITE_RUN.decision,
    "outcomes": _SUITE_RUN.outcomes,
    "document": {},
    "documents": [{}],
    "file": Path("town.osm"),
    "campaigns": ["a"],
    "kinds": ["run"],
    "number": 1,
    "table": "failures",
}
_METHODS = {
    name: value
    for name, value in vars(Operations).items()
    if isinstance(value, Answered | Listed | Saved | Told)
}


def call_of(name: str) -> Call[Any]:
    """The call that a method makes of its required arguments."""
    make = _METHODS[name].make
    required = [
        parameter.name
        for parameter in inspect.signature(make).parameters.values()
        if parameter.default is parameter.empty
    ]
    made = make(*(_GIVEN.get(parameter, "x") for parameter in required))
    if isinstance(made, Listing):
        return made.first
    assert isinstance(made, Call)
    return made


@pytest.fixture(scope="module")
def operations(service_url: str) -> dict[tuple[str, str], dict[str, Any]]:
    """The operations of the OpenAPI document by method and path."""
    paths = httpx.get(f"{service_url}/api/v1/openapi.json").json()["paths"]
    return {
        (method.upper(), path): operation
        for path, methods in paths.items()
        for method, operation in methods.items()
    }


def test_every_operation_has_one_method_and_every_method_an_operation(
    operations: dict[tuple[str, str], Any],
) -> None:
    answering = [name for name, method in _METHODS.items() if not isinstance(method, Saved)]
    calls = [call_of(name) for name in answering]
    assert sorted((call.method, call.template) for call in calls) == sorted(operations)


@pytest.mark.parametrize("name", sorted(_METHODS))
def test_a_method_knows_the_parameters_of_its_operation(
    name: str, operations: dict[tuple[str, str], Any]
) -> None:
    call = call_of(name)
    parameters = operations[call.method, call.template].get("parameters", [])
    by_place: dict[str, set[str]] = {"path": set(), "query": set(), "header": set()}
    for parameter in parameters:
        by_place[parameter["in"]].add(parameter["name"])
    assert set(call.places) == by_place["path"]
    assert set(call.query) == by_place["query"]
    assert call.is_once == ("Idempotency-Key" in by_place["header"])


@pytest.mark.parametrize("name", sorted(_METHODS))
def test_a_method_reads_the_answer_of_its_operation(
    name: str, operations: dict[tuple[str, str], Any]
) -> None:
    call = call_of(name)
    operation = operations[call.method, call.template]
    (success,) = (answer for status, answer in operation["responses"].items() if status[0] == "2")
    if call.answer is type(None):
        assert "content" not in success
        return
    schemas = [form.get("schema", {}) for form in success["content"].values()]
    named = schemas[0].get("$ref", "").rpartition("/")[2]
    if call.answer in (bytes, str):
        assert named in ("", "ScenarioDocument")
    else:
        read = getattr(call.answer, "__origin__", call.answer).__name__
        items = [item.__name__ for item in getattr(call.answer, "__args__", ())]
        assert named == "_".join([read, *items, *[""] * bool(items)])


@pytest.mark.parametrize("name", sorted(_METHODS))
def test_what_may_be_repeated_changes_nothing_or_has_a_key(name: str) -> None:
    call = call_of(name)
    only_reads = call.method == "GET" or call.template.endswith((":validate", ":inspect"))
    assert call.is_repeatable == only_reads
    assert not (call.is_repeatable and call.is_once)


def test_both_clients_have_the_same_methods() -> None:
    def public(kind: type) -> set[str]:
        return {name for name in dir(kind) if not name.startswith("_")}

    assert public(Client) - {"close"} == public(AsyncClient) - {"aclose"}


@pytest.mark.parametrize("name", sorted(_METHODS))
def test_methods_are_documented(name: str) -> None:
    with Client("http://127.0.0.1:1") as client:
        method = getattr(client, name)
        assert inspect.getdoc(method)
        assert method.__name__ == _METHODS[name].make.__name__
    assert inspect.getdoc(_METHODS[name])


def test_methods_have_the_types_of_their_answers() -> None:
    """The type checker reads this as well."""
    empty = ok({"items": []})
    health = ok({"status": "ok", "version": "1"})
    with scripted(health, empty) as server, Client(server.url) as client:
        assert_type(client.health(), Health)
        assert_type(client.runs(limit=1), Iterator[RunSummary])
        assert list(client.runs()) == []

    async def ask(url: str) -> None:
        async with AsyncClient(url) as client:
            assert_type(await client.health(), Health)
            assert_type(client.runs(limit=1), AsyncIterator[RunSummary])
            assert [run async for run in client.runs()] == []

    with scripted(health, empty) as server:
        asyncio.run(ask(server.url))


def test_places_in_a_path_are_quoted() -> None:
    call = Client.job.make("a/b:c?d#e {f}")
    assert call.path == "/api/v1/jobs/a%2Fb%3Ac%3Fd%23e%20%7Bf%7D"


def test_values_of_a_query() -> None:
    call: Call[Any] = Call(
        method="GET",
        template="/",
        query={"a": True, "b": ["x", "", "y"], "c": None, "d": "", "e": 0, "f": frozenset()},
        answer=str,
        is_repeatable=True,
    )
    assert call.parameters == (("a", "true"), ("b", "x"), ("b", "y"), ("e", "0"))
