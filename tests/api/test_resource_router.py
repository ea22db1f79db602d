"""Large bodies that FastAPI checks itself."""

from __future__ import annotations

import json
import socket
import time
from pathlib import Path

import pytest

from drivora_service.api.guards.api_tokens import Scope, TokenFile
from tests.api.conftest import MakeOffline, Offline

RUN = "01a1bcbee3570d3ff8ce5b8e"


MANY = json.dumps({f"k{number}": 0 for number in range(12_000)})
JSON = {"Content-Type": "application/json"}


@pytest.mark.parametrize(
    "path", [f"/api/v1/runs/{RUN}:minimize", "/api/v1/suite-runs", "/api/v1/failures/groups:merge"]
)
def test_of_very_many_mistakes_the_first_are_listed(offline: Offline, path: str) -> None:
    client = offline.client
    client.post(path, json={"unknown": 1})
    begun = time.process_time()
    answer = client.post(path, content=MANY, headers=JSON)
    assert time.process_time() - begun < 1.0
    assert answer.status_code == 422
    problems = answer.json()["problems"]
    assert len(problems) == 101
    assert "further problems are not listed" in problems[-1]["message"]
    assert {problem["code"] for problem in problems} <= {
        "extra_forbidden",
        "missing",
        "more_problems",
    }


def test_a_client_without_a_token_is_not_told_the_mistakes(
    make_offline: MakeOffline, tmp_path: Path
) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    reader = {"Authorization": f"Bearer {tokens.create('reader', Scope.READ)}"}
    client = make_offline(tokens=tokens).client
    answers = [
        client.post("/api/v1/suite-runs", content=MANY, headers={**JSON, **headers}).status_code
        for headers in ({}, reader)
    ]
    assert answers == [401, 403]


@pytest.mark.parametrize("path", ["/api/v1/suite-runs", "/api/v1/session"])
def test_no_large_body_is_read_of_a_client_without_a_token(
    make_offline: MakeOffline, tmp_path: Path, path: str
) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    url = make_offline(tokens=tokens).client.base_url
    for length in (b"Content-Length: 150000", b"Transfer-Encoding: chunked"):
        with socket.create_connection((url.host, url.port), timeout=10.0) as connection:
            head = f"POST {path} HTTP/1.1\r\nHost: localhost\r\n".encode()
            connection.sendall(head + b"Content-Type: application/json\r\n" + length + b"\r\n\r\n")
            assert connection.recv(65_536).startswith(b"HTTP/1.1 401 ")
