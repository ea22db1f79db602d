"""Who may ask a service without tokens, and pages of other sites."""

from __future__ import annotations

import socket
from pathlib import Path

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from tests.api.conftest import MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer
from tests.api.test_problem_details import is_problem

JOBS = "/api/v1/jobs"

FORWARDED = (
    {"Forwarded": "for=192.0.2.1"},
    {"X-Forwarded-For": "127.0.0.1"},
    {"X-Forwarded-Host": "drivora.example"},
    {"X-Forwarded-Proto": "https"},
    {"X-Forwarded-Server": "proxy"},
    {"X-Forwarded": "for=192.0.2.1"},
    {"x-FORWARDED-prefix": "/drivora"},
    {"X-Real-IP": "192.0.2.1"},
    {"Via": "1.1 caddy"},
    {"X-Client-IP": "192.0.2.1"},
    {"True-Client-IP": "192.0.2.1"},
    {"CF-Connecting-IP": "192.0.2.1"},
    {"X-Envoy-External-Address": "192.0.2.1"},
    {"X-Original-Forwarded-For": "192.0.2.1"},
    {"X_Forwarded_For": "192.0.2.1"},
    {"WL-Proxy-Client-IP": "192.0.2.1"},
    {"CDN-Loop": "cloudflare"},
)


@pytest.fixture
def tokens(tmp_path: Path) -> TokenFile:
    """Those of a service on loopback."""
    return TokenFile(tmp_path / "tokens.json", always_needed=False)


@pytest.fixture
def loopback(make_offline: MakeOffline, tokens: TokenFile) -> Offline:
    """A service on loopback, without tokens yet."""
    return make_offline(tokens=tokens)


@pytest.mark.parametrize("headers", FORWARDED, ids=lambda one: next(iter(one)))
def test_what_comes_through_a_proxy_needs_a_token(
    loopback: Offline, tokens: TokenFile, headers: dict[str, str]
) -> None:
    client = loopback.client
    assert client.get(JOBS).status_code == 200
    for path in (JOBS, "/", "/healthz", "/metrics"):
        refused = is_problem(client.get(path, headers=headers), 403)
        assert "through a proxy" in refused["detail"]
        assert "drivora tokens create" in refused["detail"]
    secret = tokens.create("me", Scope.READ)
    is_problem(client.get(JOBS, headers=headers), 401)
    assert client.get(JOBS, headers={**headers, **bearer(secret)}).status_code == 200


def test_what_comes_as_from_nginx_without_settings_needs_a_token(
    loopback: Offline, tokens: TokenFile
) -> None:
    # `proxy_pass http://127.0.0.1:PORT;` alone shows itself by the version only.
    address = loopback.client.base_url

    def ask(headers: str) -> bytes:
        with socket.create_connection((address.host, address.port or 0), timeout=30) as connection:
            connection.sendall(
                f"GET {JOBS} HTTP/1.0\r\nHost: {address.netloc.decode()}\r\n{headers}\r\n".encode()
            )
            with connection.makefile("rb") as answer:
                return answer.read()

    refused = ask("Connection: close\r\n")
    assert b" 403 " in refused.splitlines()[0]
    assert b"HTTP/1.0" in refused
    assert b"drivora tokens create" in refused
    secret = tokens.create("me", Scope.READ)
    assert b" 200 " in ask(f"Authorization: Bearer {secret}\r\n").splitlines()[0]


@pytest.mark.parametrize("host", ["drivora.example", "192.0.2.7:8000", "localhost.evil.com"])
def test_what_is_meant_for_another_host_needs_a_token(
    loopback: Offline, tokens: TokenFile, host: str
) -> None:
    refused = is_problem(loopback.client.get(JOBS, headers={"Host": host}), 421)
    assert "drivora tokens create" in refused["detail"]
    secret = tokens.create("me", Scope.READ)
    answer = loopback.client.get(JOBS, headers={"Host": host, **bearer(secret)})
    assert answer.status_code == 200


@pytest.mark.parametrize(
    "host", ["evil.com@localhost", "localhost:80@evil", "[::1].evil", "127.1", "localhost:99999"]
)
def test_what_is_no_host_is_refused_with_tokens_and_without(
    loopback: Offline, tokens: TokenFile, host: str
) -> None:
    is_problem(loopback.client.get(JOBS, headers={"Host": host}), 400)
    secret = tokens.create("me", Scope.ADMIN)
    is_problem(loopback.client.get(JOBS, headers={"Host": host, **bearer(secret)}), 400)


def test_a_token_is_needed_from_the_moment_it_is_made(loopback: Offline, tokens: TokenFile) -> None:
    client = loopback.client
    assert client.get("/api/v1/session").json()["tokens_needed"] is False
    assert client.get(JOBS).status_code == 200
    secret = tokens.create("me", Scope.READ)
    # Not even an answer that was kept a moment ago.
    is_problem(client.get(JOBS), 401)
    is_problem(client.post(JOBS, json=SCENARIO), 401)
    is_problem(client.get("/metrics"), 401)
    assert client.get("/api/v1/session").json()["tokens_needed"] is True
    assert client.get(JOBS, headers=bearer(secret)).status_code == 200
    assert client.post("/api/v1/session", json={"token": secret}).status_code == 204
    assert client.get(JOBS).status_code == 200


def test_a_service_whose_tokens_are_gone_stays_closed(
    loopback: Offline, tokens: TokenFile, tmp_path: Path
) -> None:
    client = loopback.client
    tokens.create("me", Scope.READ)
    is_problem(client.get(JOBS), 401)
    tokens.revoke("me")
    is_problem(client.get(JOBS), 401)
    (tmp_path / "tokens.json").unlink()
    is_problem(client.get(JOBS), 401)


def test_other_authorisation_does_not_replace_the_check_of_the_page(
    make_offline: MakeOffline, tmp_path: Path
) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    client = make_offline(tokens=tokens).client
    secret = tokens.create("page", Scope.SUBMIT)
    assert client.post("/api/v1/session", json={"token": secret}).status_code == 204
    origin = {"Origin": str(client.base_url).rstrip("/"), "Sec-Fetch-Site": "same-origin"}
    for kind in ("Basic dXNlcjpwYXNz", "Digest username=x", "basic", "", "Token x"):
        extra = {"Authorization": kind}
        is_problem(client.post(JOBS, json=SCENARIO, headers=extra), 403)
        assert client.get(JOBS, headers=extra).status_code == 200
        posted = client.post(JOBS, json=SCENARIO, headers={**extra, **origin})
        assert posted.status_code == 202, posted.text


@pytest.mark.parametrize("site", ["cross-site", "same-site", "other"])
def test_only_pages_of_the_service_change_something(loopback: Offline, site: str) -> None:
    def post(**headers: str) -> httpx.Response:
        return loopback.client.post(JOBS, json=SCENARIO, headers=headers)

    is_problem(post(**{"Sec-Fetch-Site": site}), 403)
    own = str(loopback.client.base_url).rstrip("/")
    port = own.rpartition(":")[2]
    for origin in (
        f"http://evil@127.0.0.1:{port}",
        f"http://127.0.0.1:{port}@evil",
        f"http://localhost:{port}",
        f"http://127.1:{port}",
        "http://127.0.0.1",
        "null",
    ):
        is_problem(post(Origin=origin), 403)
    assert post(Origin=own).status_code == 202
