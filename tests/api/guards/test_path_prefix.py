from __future__ import annotations

import asyncio
from typing import Any

import pytest
from starlette.types import Receive, Scope, Send

from drivora_service.api.guards.path_prefix import PathPrefix, public_path


def seen(path: str, raw: bytes | None = None) -> Scope:
    """Returns what the application sees of a request for a path."""
    found: list[Scope] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        del receive, send
        found.append(scope)

    async def nothing(*_: Any) -> Any:
        raise AssertionError

    given: dict[str, Any] = {"type": "http", "path": path, "raw_path": raw or path.encode()}
    before = dict(given)
    asyncio.run(PathPrefix(app, root_path="/tools/drivora")(given, nothing, nothing))
    assert given == before
    (scope,) = found
    return scope


@pytest.mark.parametrize(
    ("asked", "inside"),
    [
        ("/tools/drivora", "/"),
        ("/tools/drivora/", "/"),
        ("/tools/drivora/api/v1/jobs", "/api/v1/jobs"),
        # Of a proxy that has taken the prefix off.
        ("/api/v1/jobs", "/api/v1/jobs"),
        ("/", "/"),
        # Once only, and only a whole part of the path.
        ("/tools/drivora/tools/drivora/metrics", "/tools/drivora/metrics"),
        ("/tools/drivorax/metrics", "/tools/drivorax/metrics"),
        ("/tools", "/tools"),
        ("//tools/drivora/metrics", "//tools/drivora/metrics"),
    ],
)
def test_the_prefix_is_taken_off(asked: str, inside: str) -> None:
    scope = seen(asked)
    assert (scope["path"], scope["raw_path"]) == (inside, inside.encode())
    assert public_path(scope) == f"/tools/drivora{inside}"


def test_escaped_characters_stay_in_the_raw_path() -> None:
    scope = seen("/tools/drivora/runs/a/b", b"/tools/drivora/runs/a%2Fb")
    assert (scope["path"], scope["raw_path"]) == ("/runs/a/b", b"/runs/a%2Fb")


def test_without_a_prefix_the_path_is_that_of_the_request() -> None:
    assert public_path({"type": "http", "path": "/api/v1/jobs"}) == "/api/v1/jobs"
