from __future__ import annotations

from typing import Any

import httpx
import pytest

from drivora_service.api.guards.load_guard import refuse_overload
from tests.api.conftest import Offline, served

PATHS = (
    "/",
    "/icon.svg",
    "/assets/none.js",
    "/help/none",
    "/docs",
    "/healthz",
    "/readyz",
    "/metrics",
    "/nothing",
    "/api/v1/openapi.json",
    "/api/v1/jobs",
    "/api/v1/jobs/none",
    "/api/v1/session",
    "/api/v1/nothing",
)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("method", ["GET", "HEAD", "POST", "PATCH"])
def test_every_answer_of_a_service_protects_its_reader(
    http: httpx.Client, path: str, method: str
) -> None:
    answer = http.request(method, path)
    assert answer.headers.get_list("X-Content-Type-Options") == ["nosniff"]
    assert answer.headers["Referrer-Policy"] == "same-origin"
    assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
    policies = answer.headers.get_list("Content-Security-Policy")
    assert len(policies) == 1
    assert "default-src 'none'" in policies[0]
    assert "frame-ancestors 'none'" in policies[0]
    if path.startswith("/api/"):
        assert answer.headers["Cache-Control"] in ("no-store", "private, no-cache")


def test_pictures_run_no_scripts(http: httpx.Client, finished_run: dict[str, Any]) -> None:
    for path in (f"/api/v1/runs/{finished_run['id']}/picture", "/icon.svg"):
        answer = http.get(path)
        if path == "/icon.svg" and answer.status_code == 404:
            continue
        assert answer.status_code == 200, answer.text
        assert answer.headers["Content-Type"].startswith("image/svg+xml")
        (policy,) = answer.headers.get_list("Content-Security-Policy")
        assert "sandbox" in policy
        assert "script-src" not in policy
        assert answer.headers["X-Content-Type-Options"] == "nosniff"


def test_files_of_runs_are_not_kept_by_caches_of_others(
    http: httpx.Client, finished_run: dict[str, Any]
) -> None:
    answer = http.get(
        f"/api/v1/runs/{finished_run['id']}/observations",
        headers={"Accept": "application/vnd.apache.parquet"},
    )
    assert answer.status_code == 200
    assert "private" in answer.headers["Cache-Control"]


def test_errors_outside_of_the_application_say_it_too(offline: Offline) -> None:
    """An unexpected error, an overload, and bytes that are no request."""
    with offline.context.database.engine.begin() as connection:
        connection.exec_driver_sql("DROP TABLE runs")
    broken = offline.client.get("/api/v1/jobs")
    assert (broken.status_code, broken.headers["X-Content-Type-Options"]) == (500, "nosniff")
    with served(refuse_overload) as url:  # type: ignore[arg-type] # an ASGI application, too
        busy = httpx.get(url)
    assert (busy.status_code, busy.headers["X-Content-Type-Options"]) == (503, "nosniff")


def test_what_is_no_request_is_refused_with_them(service_url: str) -> None:
    import socket

    host, _, port = service_url.removeprefix("http://").partition(":")
    with socket.create_connection((host, int(port)), timeout=20) as connection:
        connection.sendall(b"NONSENSE\r\n\r\n")
        answer = connection.makefile("rb").read()
    assert answer.startswith(b"HTTP/1.1 400")
    assert b"x-content-type-options: nosniff" in answer.lower()


def test_the_openapi_document_is_sent_once(http: httpx.Client) -> None:
    first = http.get("/api/v1/openapi.json")
    assert first.status_code == 200
    assert first.headers["Content-Type"] == "application/json"
    again = http.get("/api/v1/openapi.json", headers={"If-None-Match": first.headers["ETag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["ETag"] == first.headers["ETag"]
    assert again.headers["X-Content-Type-Options"] == "nosniff"
    other = http.get("/api/v1/openapi.json", headers={"If-None-Match": '"other"'})
    assert other.json() == first.json()
