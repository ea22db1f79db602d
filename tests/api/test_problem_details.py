from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from tests.api.conftest import BODY_LIMIT, Offline

JSON = {"Content-Type": "application/json"}


def is_problem(answer: httpx.Response, status: int) -> dict[str, Any]:
    """Checks that an answer is an error in the shape of RFC 9457."""
    assert answer.status_code == status, answer.text
    assert answer.headers["Content-Type"] == "application/problem+json"
    body: dict[str, Any] = answer.json()
    assert body["status"] == status
    assert body["title"]
    assert body["detail"]
    return body


def test_what_is_not_there(offline: Offline) -> None:
    is_problem(offline.client.get("/nothing"), 404)
    is_problem(offline.client.get("/api/v1/jobs/0"), 404)
    is_problem(offline.client.get("/api/v1/batches/0"), 404)
    is_problem(offline.client.get("/api/v1/runs/0/scenario"), 404)
    body = is_problem(offline.client.get("/api/v1/networks/..%2f..%2fetc"), 404)
    assert body["instance"].startswith("/api/v1/networks/")


def test_wrong_methods_and_types(offline: Offline) -> None:
    refused = offline.client.delete("/api/v1/jobs")
    is_problem(refused, 405)
    assert refused.headers["Allow"]
    text = offline.client.post("/api/v1/jobs", content="{}", headers={"Content-Type": "text/plain"})
    is_problem(text, 415)
    zipped = offline.client.post(
        "/api/v1/jobs", content=b"", headers={**JSON, "Content-Encoding": "gzip"}
    )
    is_problem(zipped, 415)


def test_wrong_parameters_are_named(offline: Offline) -> None:
    body = is_problem(offline.client.get("/api/v1/jobs", params={"limit": "many"}), 422)
    assert "limit" in body["problems"][0]["message"]


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"map_region": {"town": "Nowhere"}}, "/map_region/town"),
        ({"map_region": {"town": "../../etc/passwd"}}, "/map_region/town"),
        ({"seed": "one"}, "/seed"),
        ({"seed": 10**40}, "/seed"),
        ({"ego_vehicles": []}, "/ego_vehicles"),
        ({"surprise": 1}, "/surprise"),
        ({"weather": {"wetness": 1e9}}, "/weather/wetness"),
    ],
)
def test_broken_scenarios_are_refused_with_the_place(
    offline: Offline, scenario: dict[str, Any], change: dict[str, Any], pointer: str
) -> None:
    body = is_problem(offline.client.post("/api/v1/jobs", json={**scenario, **change}), 422)
    assert pointer in {problem["pointer"] for problem in body["problems"]}


def test_mistakes_of_shape_and_place_are_named_together(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    scenario["seed"] = "one"
    scenario["ego_vehicles"][0]["agent"] = {"name": "nobody"}
    for parameters, expected in (
        ({}, {"/seed", "/ego_vehicles/0/agent/name"}),
        ({"agent": "idm"}, {"/seed"}),
    ):
        body = is_problem(
            offline.client.post("/api/v1/jobs", json=scenario, params=parameters), 422
        )
        assert {problem["pointer"] for problem in body["problems"]} == expected


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b"\xff\xfe",
        b"[" * 50_000,
        b'{"a":' * 20_000 + b"1" + b"}" * 20_000,
        b'{"seed": NaN}',
        b'{"seed": 1e999}',
        b'"text"',
    ],
)
def test_bodies_that_are_no_scenario_never_crash(offline: Offline, content: bytes) -> None:
    for path in ("/api/v1/jobs", "/api/v1/scenarios:validate"):
        body = is_problem(offline.client.post(path, content=content, headers=JSON), 422)
        assert body["problems"]


def test_a_large_body_is_refused_unread(offline: Offline) -> None:
    large = b" " * (BODY_LIMIT + 1)
    is_problem(offline.client.post("/api/v1/jobs", content=large, headers=JSON), 413)

    def chunks() -> Iterator[bytes]:
        for _ in range(10):
            yield b" " * (BODY_LIMIT // 5)

    is_problem(offline.client.post("/api/v1/jobs", content=chunks(), headers=JSON), 413)


@pytest.mark.parametrize("chunked", [False, True])
def test_a_client_that_sends_100_megabytes_gets_to_read_the_answer(
    service_url: str, chunked: bool
) -> None:
    sent = 0

    def megabytes() -> Iterator[bytes]:
        nonlocal sent
        for sent in range(100):  # noqa: B007 # counted for the test
            yield b" " * (1 << 20)

    headers = JSON if chunked else {**JSON, "Content-Length": str(100 << 20)}
    url = f"{service_url}/api/v1/batches"
    answer = httpx.post(url, content=megabytes(), headers=headers, timeout=60)
    assert is_problem(answer, 413)["problems"] == []
    assert answer.headers["Connection"] == "close"
    # 32 MiB are allowed, 16 MiB are thrown away, and some are on the way.
    assert sent < 90


def test_pages_of_other_sites_are_kept_away(offline: Offline, scenario: dict[str, Any]) -> None:
    origin = {"Origin": "https://example.org"}
    is_problem(offline.client.post("/api/v1/jobs", json=scenario, headers=origin), 403)
    cross = {"Sec-Fetch-Site": "cross-site"}
    is_problem(offline.client.post("/api/v1/jobs/0:cancel", headers=cross), 403)
    rebound = offline.client.get("/api/v1/jobs", headers={"Host": "evil.example:8000"})
    is_problem(rebound, 421)
    same = {"Origin": str(offline.client.base_url).rstrip("/")}
    assert offline.client.post("/api/v1/jobs", json=scenario, headers=same).status_code == 202


def test_an_origin_that_is_no_address_is_another_site(
    offline: Offline, scenario: dict[str, Any]
) -> None:
    for origin in (
        b"http://[",
        b"http://]:1",
        b"http://[::1",
        b"null",
        b"",
        b"://",
        b"http://\xff",
    ):
        headers = [(b"Origin", origin)]
        answer = offline.client.post("/api/v1/jobs", json=scenario, headers=headers)
        is_problem(answer, 403)
        assert offline.client.get("/api/v1/jobs", headers=headers).status_code == 200


def test_an_unexpected_error_tells_nothing_of_the_inside(offline: Offline) -> None:
    offline.context.database.engine.dispose()
    with offline.context.database.engine.begin() as connection:
        connection.exec_driver_sql("DROP TABLE runs")
    body = is_problem(offline.client.get("/api/v1/jobs"), 500)
    assert "runs" not in body["detail"]
