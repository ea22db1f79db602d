"""Requests that no client sends on purpose: refused with a problem, never with 5xx."""

from __future__ import annotations

import base64
import gzip
import json
import socket
from typing import Any
from urllib.parse import urlsplit

import pytest

from drivora_service.store.engine.paging import make_token
from tests.api.conftest import Offline

JSON = {"Content-Type": "application/json"}
HUGE = str(10**30)
LISTS = ("jobs", "runs", "batches", "campaigns")


def forged(content: object) -> str:
    return base64.urlsafe_b64encode(json.dumps(content).encode()).decode().rstrip("=")


def scope_of(token: str) -> str:
    """Returns what names the query in a token that the service made."""
    padded = token + "=" * (-len(token) % 4)
    name: str = json.loads(base64.urlsafe_b64decode(padded))[0]
    return name


def test_parameters_beyond_every_range(offline: Offline) -> None:
    for path in (
        f"jobs?limit={HUGE}",
        f"jobs?limit=-{HUGE}",
        "jobs?limit=1e999",
        "jobs?limit=NaN",
        f"runs/0/observations?first={HUGE}",
        f"campaigns/0/evaluations?generation={HUGE}",
        f"campaigns/0/evaluations/{HUGE}",
        f"campaigns/0/evaluations/{'9' * 5000}",
        f"campaigns/0/evaluations/-{HUGE}",
        "jobs?at_fault=perhaps",
        "jobs?status=%00",
    ):
        assert offline.client.get(f"/api/v1/{path}").status_code in (404, 422), path


def test_forged_page_tokens(offline: Offline, scenario: dict[str, Any]) -> None:
    for _ in range(2):
        offline.client.post("/api/v1/jobs", json=scenario)
    made = offline.client.get("/api/v1/jobs?limit=1").json()["next_page_token"]
    scope = scope_of(made)
    numbers: tuple[object, ...] = (
        10**30,
        -(10**30),
        2**63,
        -(2**63) - 1,
        True,
        1.5,
        "1",
        None,
        [[]],
    )
    for last in numbers:
        token = forged([scope, last])
        answer = offline.client.get("/api/v1/jobs", params={"limit": 1, "page_token": token})
        assert answer.status_code == 422, last
    assert make_token("a", 1) != make_token("b", 1)
    for token in ("%00", "%F0%9F%92%A5", "=" * 9, "A" * 500, "A" * 501, forged([[]] * 60)):
        for name in LISTS:
            answer = offline.client.get(f"/api/v1/{name}?page_token={token}")
            assert answer.status_code == 422, (name, token)


@pytest.mark.parametrize("odd", ["%00", "a%00b", "%FF%FE", "%ED%A0%80", "%E2%80%AE", "%0A", "%25"])
def test_ids_and_filters_of_odd_characters(offline: Offline, odd: str) -> None:
    for path in (
        f"jobs/{odd}",
        f"batches/{odd}",
        f"runs/{odd}/scenario",
        f"campaigns/{odd}/failures",
        f"campaigns/{odd}/evaluations/1",
        f"networks/{odd}/geometry",
    ):
        assert offline.client.get(f"/api/v1/{path}").status_code == 404, path
    for action in (f"jobs/{odd}:cancel", f"batches/{odd}:pause", f"campaigns/{odd}:resume"):
        assert offline.client.post(f"/api/v1/{action}").status_code == 404, action
    for query in ("agent", "town", "batch", "oracle", "scenario_sha256"):
        answer = offline.client.get(f"/api/v1/jobs?{query}={odd}")
        assert answer.status_code in (200, 422), query
    answer = offline.client.get(f"/api/v1/campaigns:compare?campaign={odd}&campaign=*")
    assert 400 <= answer.status_code < 500


def test_names_that_people_read_may_hold_all_that_does_not_act(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    for label, status in (("%00", 422), ("a%00", 422), ("%E6%BC%A2%E5%AD%97", 202), ("%0A", 422)):
        for path in (f"jobs?label={label}", f"batches?name={label}"):
            body = [scenario] if "batches" in path else scenario
            assert offline.client.post(f"/api/v1/{path}", json=body).status_code == status, path


@pytest.mark.parametrize(
    "body",
    [
        b'{"seed": 1, "seed": 2}',
        b'{"extensions": {"a:b": "\\ud800"}}',
        b'{"\\udfff": 1}',
        b'{"seed": 1e400}',
        b'{"seed": -Infinity}',
        b'{"a": ' + b"9" * 5000 + b"}",
        b'{"a":' * 100_000,
        "{}".encode("utf-16"),
        "{}".encode("utf-32"),
        gzip.compress(b"{}", mtime=0),
        b"\xef\xbb\xbf{}",
        b"\0",
    ],
)
def test_odd_bodies(offline: Offline, body: bytes) -> None:
    for path in (
        "jobs",
        "scenarios:validate",
        "batches",
        "campaigns",
        "campaigns:validate",
        "studies:validate",
    ):
        answer = offline.client.post(f"/api/v1/{path}", content=body, headers=JSON)
        assert answer.status_code in (413, 422), (path, answer.text[:300])
        assert answer.headers["Content-Type"] == "application/problem+json"


def test_odd_headers(offline: Offline, scenario: dict[str, Any]) -> None:
    job = offline.client.post("/api/v1/jobs", json=scenario).headers["Location"]
    for name, value in (
        ("Range", b"bytes=9-1,,-"),
        ("If-None-Match", b'"' * 1000),
        ("If-None-Match", b"W/\xff"),
        ("If-Modified-Since", b"yesterday"),
        ("Accept", b";;q=,"),
        ("Accept-Encoding", b"gzip;q=NaN"),
        ("Authorization", b"Bearer \xff\xfe"),
        ("Authorization", b"Basic"),
        ("Cookie", b"a=\xff; ;="),
        ("Expect", b"the-unexpected"),
    ):
        assert offline.client.get(job, headers=[(name.encode(), value)]).status_code == 200, (
            name,
            value,
        )
    # Without a token, what came through a proxy is refused, however it is written.
    assert offline.client.get(job, headers=[(b"X-Forwarded-For", b"::::")]).status_code == 403
    for charset in ("utf-16", "nonsense", '"utf-8', "utf-8;;"):
        kind = {"Content-Type": f"application/json; charset={charset}"}
        content = json.dumps(scenario).encode()
        answer = offline.client.post("/api/v1/jobs", content=content, headers=kind)
        assert answer.status_code in (202, 415), charset
    for key in (b"\xff\xfe", b"'; DROP TABLE runs", b"a" * 200, b"\xe2\x80\xae"):
        sent = [(b"Idempotency-Key", key)]
        first, second = (
            offline.client.post("/api/v1/jobs", json=scenario, headers=sent) for _ in range(2)
        )
        assert (first.status_code, second.status_code) == (202, 202), key
        assert first.json() == second.json()


@pytest.mark.parametrize(
    "request_line",
    [b"GET http://localhost/healthz HTTP/1.1", b"OPTIONS * HTTP/1.1", b"CONNECT a:1 HTTP/1.1"],
)
def test_other_forms_of_a_request_target(offline: Offline, request_line: bytes) -> None:
    address = urlsplit(str(offline.client.base_url))
    with socket.create_connection((address.hostname, address.port or 0), timeout=30) as client:
        client.sendall(request_line + b"\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        status = int(client.recv(65536).split()[1])
        assert 400 <= status < 500
