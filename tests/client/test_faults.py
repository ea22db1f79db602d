"""Clients of servers that refuse, close connections or answer garbage."""

from __future__ import annotations

import asyncio
import socket
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from pathlib import Path
from typing import Any

import httpx
import pytest

from drivora_service.client import ApplicationTransport, AsyncClient, Client
from drivora_service.client.replies import Reply
from drivora_service.errors import (
    ConfigurationError,
    InvalidDocument,
    NotAuthorised,
    NotFound,
    Problem,
    RequestConflict,
    ServiceError,
    ServiceUnavailable,
    StoreError,
)
from tests.client.conftest import MakeClient
from tests.client.examples import BATCH, JOB
from tests.client.scripted_server import Hangup, free_port, ok, page, problem, scripted
from tests.client.scripted_server import Scripted as Answer

HEALTH = ok({"status": "ok", "version": "1"})
POSTED = Answer(202, ok({**JOB, "run_url": ""}).body)


@pytest.mark.parametrize("status", [429, 503])
def test_a_refusal_for_now_is_tried_again_when_the_service_says(
    client_at: MakeClient, status: int
) -> None:
    told: list[tuple[ServiceError, float]] = []
    refusal = problem(status, "not now", **{"Retry-After": "1"})
    with scripted(refusal, HEALTH) as server:
        client = client_at(server.url, on_retry=lambda error, s: told.append((error, s)))
        assert client.health().status == "ok"
        first, second = server.asked
    assert second.at - first.at >= 1.0
    ((error, seconds),) = told
    assert isinstance(error, ServiceUnavailable)
    assert (error.status, str(error)) == (status, "the service refused: not now")
    assert 1.0 < seconds < 1.5


def test_what_queues_something_is_sent_again_under_the_same_key(client_at: MakeClient) -> None:
    answers = (
        Hangup(),
        problem(409, "the first request is still being done", **{"Retry-After": "1"}),
        problem(503, "busy"),
        POSTED,
        POSTED,
    )
    with scripted(*answers) as server:
        client = client_at(server.url)
        assert client.post_job({"a": 1}, label="x").id == "1"
        client.post_job({"a": 1}, label="x")
    keys = [asked.headers["idempotency-key"] for asked in server.asked]
    assert len(keys) == 5
    assert len(set(keys[:4])) == 1
    assert keys[4] != keys[0]
    assert {asked.body for asked in server.asked} == {b'{"a": 1}'}
    assert {asked.target for asked in server.asked} == {"/api/v1/jobs?label=x"}
    assert {asked.headers["content-type"] for asked in server.asked} == {"application/json"}


def test_a_conflict_is_not_tried_again(client_at: MakeClient) -> None:
    with scripted(problem(409, "it is cancelled")) as server:
        with pytest.raises(RequestConflict, match="the service refused: it is cancelled"):
            client_at(server.url).post_job({})
        assert len(server.asked) == 1


@pytest.mark.parametrize("answer", [Hangup(), problem(503, "busy"), problem(429, "full")])
def test_what_changes_something_is_never_sent_twice(
    client_at: MakeClient, answer: Answer | Hangup
) -> None:
    with scripted(answer) as server:
        client = client_at(server.url)
        acts: tuple[Callable[[str], object], ...] = (
            client.cancel_job,
            client.cancel_batch,
            client.pause_batch,
            client.resume_batch,
            client.pause_campaign,
            client.resume_campaign,
            client.cancel_campaign,
        )
        for act in acts:
            with pytest.raises(ServiceUnavailable):
                act("1")
        assert len(server.asked) == len(acts)
        assert all("idempotency-key" not in asked.headers for asked in server.asked)


@pytest.mark.parametrize("status", [429, 503])
def test_a_change_that_a_service_refused_for_now_is_tried_again_when_it_says(
    client_at: MakeClient, status: int
) -> None:
    refusal = problem(status, "not now", **{"Retry-After": "1"})
    with scripted(refusal, ok({**JOB, "run_url": ""})) as server:
        assert client_at(server.url).cancel_job("1").id == "1"
        first, second = server.asked
    assert second.at - first.at >= 1.0


def test_a_closed_client_is_refused() -> None:
    async def ask_awaited(url: str) -> None:
        async with AsyncClient(url) as client:
            await client.health()
        await client.health()

    with scripted(HEALTH) as server:
        with Client(server.url) as client:
            client.health()
        with pytest.raises(ServiceError, match="the client is closed"):
            client.health()
        with pytest.raises(ServiceError, match="the client is closed"):
            asyncio.run(ask_awaited(server.url))
        assert len(server.asked) == 2


def test_a_closed_connection_is_tried_again_where_that_does_no_harm(
    client_at: MakeClient,
) -> None:
    with scripted(Hangup(), Hangup(), HEALTH) as server:
        assert client_at(server.url).health().status == "ok"
        assert len(server.asked) == 3


def test_nothing_is_tried_again_without_patience(client_at: MakeClient) -> None:
    with scripted(Hangup(), HEALTH) as server:
        with pytest.raises(ServiceUnavailable) as raised:
            client_at(server.url, retry_s=0.0).health()
        assert len(server.asked) == 1
    assert str(raised.value).startswith(f"the service at {server.url} does not answer: ")
    assert raised.value.status == 0
    assert isinstance(raised.value.__cause__, httpx.RemoteProtocolError)


def test_patience_is_bounded(client_at: MakeClient) -> None:
    waits: list[float] = []
    with scripted(problem(503, "busy")) as server:
        client = client_at(server.url, retry_s=1.0, on_retry=lambda _, s: waits.append(s))
        with pytest.raises(ServiceUnavailable, match="busy"):
            client.health()
        assert len(server.asked) == len(waits) + 1
    assert 1 <= len(waits) <= 8
    assert sum(waits) <= 1.0


def test_a_service_that_is_away_for_too_long_is_not_waited_for(client_at: MakeClient) -> None:
    begun = time.monotonic()
    with scripted(problem(503, "busy", **{"Retry-After": "3600"})) as server:
        with pytest.raises(ServiceUnavailable, match="busy"):
            client_at(server.url).health()
        assert len(server.asked) == 1
    assert time.monotonic() - begun < 30.0


def test_a_service_that_starts_meanwhile_is_found(client_at: MakeClient) -> None:
    port = free_port()
    refused, answered = threading.Event(), threading.Event()

    def serve() -> None:
        assert refused.wait(30)
        with scripted(HEALTH, port=port):
            assert answered.wait(60)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        client = client_at(f"http://127.0.0.1:{port}", on_retry=lambda *_: refused.set())
        assert client.health().status == "ok"
    finally:
        answered.set()
        thread.join()


def test_no_service_at_an_address(client_at: MakeClient) -> None:
    url = f"http://127.0.0.1:{free_port()}"
    with pytest.raises(ServiceUnavailable, match=f"the service at {url} does not answer"):
        client_at(url, retry_s=0.5).health()


def test_a_service_that_says_nothing(client_at: MakeClient) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        url = f"http://127.0.0.1:{listener.getsockname()[1]}"
        client = client_at(url, retry_s=0.0, timeout_s=0.2)
        with pytest.raises(ServiceUnavailable, match="does not answer"):
            client.health()


@pytest.mark.parametrize(
    "answer",
    [
        Answer(200, b"\xff\x00garbage"),
        Answer(200, b'{"status": "ok"}'),
        Answer(200, b"[]"),
        Answer(200),
        page(200),
    ],
)
def test_an_answer_that_cannot_be_read_names_the_address(
    client_at: MakeClient, answer: Answer
) -> None:
    with scripted(answer) as server:
        with pytest.raises(ServiceError) as raised:
            client_at(server.url).health()
        assert len(server.asked) == 1
    assert f"the service at {server.url} answered GET /healthz with what" in str(raised.value)
    assert raised.value.status == 200
    assert len(str(raised.value)) < 700


@pytest.mark.parametrize("status", [502, 503, 504])
def test_a_proxy_whose_service_is_away_is_asked_again(client_at: MakeClient, status: int) -> None:
    with scripted(page(status), HEALTH) as server:
        assert client_at(server.url).health().status == "ok"
    with scripted(page(status)) as server:
        with pytest.raises(ServiceUnavailable) as raised:
            client_at(server.url, retry_s=0.0).health()
        assert raised.value.status == status
    assert f"the service at {server.url} answered {status}" in str(raised.value)
    assert "text/html" in str(raised.value)


@pytest.mark.parametrize(
    ("status", "kind"),
    [
        (400, ServiceError),
        (401, NotAuthorised),
        (403, NotAuthorised),
        (404, NotFound),
        (409, RequestConflict),
        (422, ServiceError),
        (500, ServiceError),
        (599, ServiceError),
    ],
)
def test_refusals_have_kinds(client_at: MakeClient, status: int, kind: type[ServiceError]) -> None:
    odd = Answer(status, b'{"detail": 3, "problems": "many"}')
    for answer in (problem(status, "so it is"), page(status), odd):
        with scripted(answer) as server:
            with pytest.raises(ServiceError) as raised:
                client_at(server.url).health()
            assert type(raised.value) is kind
            assert raised.value.status == status
            assert len(server.asked) == 1


def test_a_redirection_is_not_followed(client_at: MakeClient) -> None:
    with scripted(Answer(302, b"", {"Location": "/login"}), HEALTH) as server:
        with pytest.raises(ServiceError, match="302 Found"):
            client_at(server.url).health()
        assert len(server.asked) == 1


def test_the_problems_of_a_document_are_named(client_at: MakeClient) -> None:
    named = [{"pointer": "/a", "code": "odd", "message": "no", "later": 1}]
    with (
        scripted(problem(422, "1 problem", named)) as server,
        pytest.raises(InvalidDocument) as raised,
    ):
        client_at(server.url).post_job({})
    assert raised.value.problems == (Problem(pointer="/a", code="odd", message="no"),)


def test_keys_of_newer_servers_are_left_out(client_at: MakeClient) -> None:
    check = {"name": "workers", "ok": True, "detail": "", "since": "2027"}
    answer = ok({"ready": True, "checks": [check], "later": {"a": 1}})
    items = ok({"items": [{**JOB, "colour": "red"}], "next_page_token": "", "total": 1})
    with scripted(answer, items) as server:
        client = client_at(server.url)
        assert client.readiness().checks[0].ok
        assert [job.id for job in client.jobs()] == ["1"]


def test_a_service_that_is_not_ready_is_an_answer(client_at: MakeClient) -> None:
    check = {"name": "workers", "ok": False, "detail": "libsumo is missing"}
    answer = Answer(503, ok({"ready": False, "checks": [check]}).body)
    with scripted(answer) as server:
        client = client_at(server.url)
        assert not client.readiness().ready
        assert len(server.asked) == 1
        with pytest.raises(ServiceUnavailable) as raised:
            client.expect_workers()
    assert str(raised.value) == (
        f"the service at {server.url} cannot begin runs: libsumo is missing\n"
        "What is queued there stays queued, and begins once the fault is corrected"
    )


def test_a_service_that_is_not_ready_for_another_reason_can_begin_runs(
    client_at: MakeClient,
) -> None:
    checks = [
        {"name": "workers", "ok": True, "detail": ""},
        {"name": "campaigns", "ok": False, "detail": "no"},
    ]
    with scripted(Answer(503, ok({"ready": False, "checks": checks}).body)) as server:
        client_at(server.url).expect_workers()


def test_waiting_ends_when_no_run_can_be_begun(client_at: MakeClient) -> None:
    batch = ok(BATCH, **{"Retry-After": "2"})
    check = {"name": "workers", "ok": False, "detail": "libsumo is missing"}
    not_ready = Answer(503, ok({"ready": False, "checks": [check]}).body)
    seen: list[Any] = []
    no_events = Answer(404, b"{}")
    with scripted(no_events, batch, batch, not_ready) as server:
        waiting = client_at(server.url).wait_for_batch("b", on_progress=seen.append)
        with pytest.raises(ServiceUnavailable, match="cannot begin runs: libsumo is missing"):
            tuple(waiting)
        assert [asked.target for asked in server.asked] == [
            "/api/v1/events?kind=batch&kind=workers&of=b",
            "/api/v1/batches/b",
            "/api/v1/batches/b",
            "/readyz",
        ]
    assert [batch.counts for batch in seen] == [{"queued": 1}] * 2


def test_pages_are_asked_for_as_they_are_wanted(client_at: MakeClient) -> None:
    pages = [
        ok({"items": [{**JOB, "id": str(n)} for n in range(first, first + 500)], **token})
        for first, token in (
            (0, {"next_page_token": "t1"}),
            (500, {"next_page_token": "t2"}),
        )
    ]
    rest = ok({"items": [{**JOB, "id": "1000"}]})
    with scripted(*pages, rest) as server:
        jobs = iter(client_at(server.url).jobs())
        assert len(server.asked) == 0
        assert [next(jobs).id for _ in range(500)][-1] == "499"
        assert len(server.asked) == 1
        assert [job.id for job in jobs] == [str(number) for number in range(500, 1001)]
        assert [asked.target for asked in server.asked] == [
            "/api/v1/jobs?limit=500",
            "/api/v1/jobs?limit=500&page_token=t1",
            "/api/v1/jobs?limit=500&page_token=t2",
        ]
    with scripted(*pages, rest) as server:
        assert len(tuple(client_at(server.url).jobs(limit=700))) == 700
        assert [asked.target for asked in server.asked] == [
            "/api/v1/jobs?limit=500",
            "/api/v1/jobs?limit=200&page_token=t1",
        ]


def test_a_download_that_breaks_off_begins_again(client_at: MakeClient, tmp_path: Path) -> None:
    content = bytes(range(256)) * 1000
    path = tmp_path / "trace"
    path.write_bytes(b"old")
    broken = Answer(200, content[:1000], promised=len(content))
    with scripted(broken, Answer(200, content)) as server:
        client_at(server.url).save_run_observations(path, "1", first=3)
        assert {asked.target for asked in server.asked} == {"/api/v1/runs/1/observations?first=3"}
        assert {asked.headers["accept"] for asked in server.asked} == {
            "application/vnd.apache.parquet"
        }
    assert path.read_bytes() == content
    path.write_bytes(b"old")
    with scripted(broken) as server, pytest.raises(ServiceUnavailable):
        client_at(server.url, retry_s=0.0).save_run_observations(path, "1")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_download_that_cannot_be_written(client_at: MakeClient, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with scripted(Answer(200, b"x")) as server:
        with pytest.raises(StoreError, match="cannot write"):
            client_at(server.url).save_run_observations(tmp_path / "file" / "trace", "1")
        assert len(server.asked) == 1


def test_the_token_is_that_of_the_environment_unless_it_is_given(
    client_at: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_TOKEN", "of-the-environment")
    with scripted(HEALTH) as server:
        for options in ({}, {"token": "given"}, {"token": ""}):
            client_at(server.url, **options).health()
        assert [asked.headers.get("authorization") for asked in server.asked] == [
            "Bearer of-the-environment",
            "Bearer given",
            None,
        ]


def test_an_address_with_a_path_is_kept(client_at: MakeClient) -> None:
    with scripted(HEALTH) as server:
        client_at(f"{server.url}/drivora/").health()
        assert server.asked[0].target == "/drivora/healthz"


@pytest.mark.parametrize(
    "url",
    [
        *("", "127.0.0.1:8000", "ftp://x", "http://", "http://a:b", "x"),
        *("https://host/drivora?a=b", "https://host/drivora/#runs"),
    ],
)
def test_what_is_no_address_is_refused(client_at: MakeClient, url: str) -> None:
    with pytest.raises(ConfigurationError, match="no address of a service"):
        client_at(url)


@pytest.mark.parametrize("token", ["a b", "a\nb", "schlüssel"])
def test_what_is_no_token_is_refused(client_at: MakeClient, token: str) -> None:
    with pytest.raises(ConfigurationError, match="token") as raised:
        client_at("http://127.0.0.1", token=token)
    assert token not in str(raised.value)


def test_the_application_in_this_process_gets_no_key_and_no_second_request() -> None:
    asked: list[dict[bytes, bytes]] = []

    async def app(scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] != "http":
            return
        asked.append(dict(scope["headers"]))
        answer = problem(429, "1000 runs wait")
        await send({"type": "http.response.start", "status": answer.status, "headers": []})
        await send({"type": "http.response.body", "body": answer.body})

    with Client(transport=ApplicationTransport(app)) as client:
        with pytest.raises(ServiceUnavailable) as raised:
            client.post_job({})
        assert str(raised.value) == "1000 runs wait"
    (headers,) = asked
    assert b"idempotency-key" not in headers


def test_an_application_in_this_process_that_breaks_off_is_not_asked_again() -> None:
    asked: list[str] = []

    async def app(scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "http":
            asked.append(scope["path"])

    with (
        Client(transport=ApplicationTransport(app)) as client,
        pytest.raises(ServiceUnavailable, match="the application does not answer"),
    ):
        client.health()
    assert asked == ["/healthz"]


@pytest.mark.parametrize(
    ("text", "low", "high"),
    [
        (lambda: "3", 3.0, 3.0),
        (lambda: format_datetime(datetime.now(UTC) + timedelta(hours=1)), 3000.0, 3600.0),
        (lambda: format_datetime(datetime.now(UTC) - timedelta(hours=1), usegmt=True), 0.0, 0.0),
        (lambda: "Wed, 21 Oct 2015 07:28:00 -0000", 0.0, 0.0),
    ],
    ids=["seconds", "date", "past", "no-zone"],
)
def test_retry_after_is_seconds_or_a_date(
    # A time of collection would be long ago when the test runs.
    text: Callable[[], str],
    low: float,
    high: float,
) -> None:
    reply = Reply(status=503, headers=httpx.Headers({"Retry-After": text()}), content=b"")
    seconds = reply.retry_after_s
    assert seconds is not None
    assert low <= seconds <= high


@pytest.mark.parametrize("text", ["", "soon", "-1", "1.5", "٣", "Mon, 99 Foo"])
def test_another_retry_after_says_nothing(text: str) -> None:
    reply = Reply(status=503, headers=httpx.Headers([(b"Retry-After", text.encode())]), content=b"")
    assert reply.retry_after_s is None
