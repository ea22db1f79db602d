from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from drivora_service.api.guards.api_tokens import Scope, TokenFile
from tests.api.conftest import MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer

BINARY = ("application/vnd.apache.parquet", "application/vnd.apache.arrow.stream")


_OPEN_TO_ALL = ("/healthz", "/readyz", "GET /api/v1/session", "DELETE /api/v1/session")


@pytest.fixture
def openapi(offline: Offline) -> dict[str, Any]:
    document: dict[str, Any] = offline.client.get("/api/v1/openapi.json").json()
    return document


def operations(openapi: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return [
        (f"{method.upper()} {path}", operation)
        for path, methods in openapi["paths"].items()
        for method, operation in methods.items()
    ]


def check(openapi: dict[str, Any], where: str, content: dict[str, Any]) -> None:
    """Checks that content documented as JSON has an example that its schema accepts."""
    assert "example" in content, where
    schema = {**content["schema"], "components": openapi["components"]}
    jsonschema.Draft202012Validator(schema).validate(content["example"])


def test_every_operation_has_examples_that_its_schema_accepts(openapi: dict[str, Any]) -> None:
    assert len(operations(openapi)) >= 22
    for name, operation in operations(openapi):
        bodies = operation.get("requestBody", {}).get("content", {})
        for media_type, content in bodies.items():
            check(openapi, f"{name}: {media_type}", content)
        for status, answer in operation["responses"].items():
            for media_type, content in answer.get("content", {}).items():
                if media_type not in BINARY:
                    check(openapi, f"{name}: {status} {media_type}", content)


def test_every_operation_says_what_it_does_and_how_it_fails(openapi: dict[str, Any]) -> None:
    for name, operation in operations(openapi):
        assert operation["description"], name
        errors = {
            status: answer
            for status, answer in operation["responses"].items()
            if "400" <= status < "500"
        }
        if not any(open_to_all in name for open_to_all in _OPEN_TO_ALL):
            assert "401" in errors, name
        for status, answer in errors.items():
            assert list(answer["content"]) == ["application/problem+json"], (name, status)


def test_tokens_are_optional_where_none_is_asked_for(
    openapi: dict[str, Any], make_offline: MakeOffline, tmp_path: Path
) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    secret = tokens.create("reader", Scope.READ)
    client = make_offline(tokens=tokens).client
    asking = client.get("/api/v1/openapi.json", headers=bearer(secret)).json()
    for document, expected in (
        (openapi, [{}, {"token": []}, {"session": []}]),
        (asking, [{"token": []}, {"session": []}]),
    ):
        for name, operation in operations(document):
            if not any(open_to_all in name for open_to_all in (*_OPEN_TO_ALL, "/session")):
                assert operation["security"] == expected, name


def test_the_schema_says_what_is_needed_of_lists_and_page_tokens(openapi: dict[str, Any]) -> None:
    body = openapi["paths"]["/api/v1/batches"]["post"]["requestBody"]
    assert body["content"]["application/json"]["schema"]["minItems"] == 1
    tokens = [
        parameter["schema"]
        for _, operation in operations(openapi)
        for parameter in operation.get("parameters", ())
        if parameter["name"] == "page_token"
    ]
    assert len(tokens) == 11
    for schema in tokens:
        assert schema["format"] == "page-token"
        assert re.fullmatch(schema["pattern"], "WyI1ZmVjZWI2NmZmYzgiLCAxXQ")
        assert not re.fullmatch(schema["pattern"], "no token")


def test_ids_in_paths_are_never_empty(openapi: dict[str, Any]) -> None:
    ids = [
        parameter["schema"]
        for _, operation in operations(openapi)
        for parameter in operation.get("parameters", ())
        # A number, and the name of a table, which is one of three, are no ids.
        if parameter["in"] == "path" and parameter["name"] not in ("number", "table")
    ]
    assert len(ids) > 20
    assert {schema["minLength"] for schema in ids} == {1}


def test_links_name_operations_and_their_parameters(openapi: dict[str, Any]) -> None:
    known = {operation["operationId"]: operation for _, operation in operations(openapi)}
    assert len(known) == len(operations(openapi))
    links = [
        link
        for _, operation in operations(openapi)
        for answer in operation["responses"].values()
        for link in answer.get("links", {}).values()
    ]
    assert len(links) > 30
    for link in links:
        parameters = {p["name"] for p in known[link["operationId"]]["parameters"]}
        assert set(link["parameters"]) <= parameters, link


def test_the_page_shows_every_operation_and_loads_nothing(
    offline: Offline, openapi: dict[str, Any]
) -> None:
    answer = offline.client.get("/docs")
    assert answer.status_code == 200
    assert answer.headers["Content-Type"].startswith("text/html")
    assert answer.headers["Content-Security-Policy"].startswith("default-src 'none'")
    page = answer.text
    for name, operation in operations(openapi):
        method, path = name.split(" ")
        assert f'<section id="{method.lower()}-' in page
        assert f"<code>{path}</code>" in page
        assert operation["description"].split()[0] in page
    anchors = set(re.findall(r'href="#([^"]+)"', page))
    assert anchors == set(re.findall(r'<section id="([^"]+)"', page))
    assert len(anchors) == len(operations(openapi))
    assert "<script" not in page
    assert re.findall(r'(?:src|href)="(?!#|data:,|/api/v1/openapi\.json)[^"]*"', page) == []
    assert offline.client.get("/redoc").status_code == 404
