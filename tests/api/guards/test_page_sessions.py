"""Sessions of web pages."""

from __future__ import annotations

import json
import stat
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from http.cookies import SimpleCookie
from pathlib import Path
from typing import Any

import httpx
import pytest
from filelock import UnixFileLock

from drivora_service.api.answers import event_stream
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards import page_sessions
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.api.guards.page_sessions import COOKIE, MOST_SESSIONS, SessionFile
from drivora_service.api.routes import sessions as session_routes
from drivora_service.errors import ConfigurationError
from tests.api.conftest import MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer
from tests.api.test_problem_details import is_problem
from tests.forked_service import forked_service

SESSION = "/api/v1/session"
JOBS = "/api/v1/jobs"


@pytest.fixture
def tokens(tmp_path: Path) -> TokenFile:
    return TokenFile(tmp_path / "tokens.json")


@pytest.fixture
def secret(tokens: TokenFile) -> str:
    """A token that submits."""
    return tokens.create("page", Scope.SUBMIT)


@pytest.fixture
def offline(make_offline: MakeOffline, tokens: TokenFile, secret: str) -> Offline:
    """An application that needs tokens."""
    return make_offline(tokens=tokens)


def begin(client: httpx.Client, secret: str, **headers: str) -> httpx.Response:
    """Begins a session; the client keeps the cookie as a browser would."""
    return client.post(SESSION, json={"token": secret}, headers=headers)


def origin(client: httpx.Client) -> dict[str, str]:
    """What a browser says of a request from a page of the service."""
    return {"Origin": str(client.base_url).rstrip("/"), "Sec-Fetch-Site": "same-origin"}


def attributes(answer: httpx.Response) -> dict[str, Any]:
    return dict(SimpleCookie(answer.headers["Set-Cookie"])[COOKIE])


def test_a_page_gives_its_token_once(offline: Offline, secret: str) -> None:
    client = offline.client
    is_problem(client.get(JOBS), 401)
    nothing = {"tokens_needed": True, "scope": None, "name": None}
    assert client.get(SESSION).json() == nothing
    answer = begin(client, secret)
    assert (answer.status_code, answer.content) == (204, b"")
    assert answer.headers["Cache-Control"] == "no-store"
    cookie = attributes(answer)
    assert (cookie["httponly"], cookie["samesite"], cookie["path"]) == (True, "strict", "/")
    assert cookie["secure"] == ""
    assert int(cookie["max-age"]) == 14 * 24 * 3600
    assert client.get(JOBS).status_code == 200
    known = {"tokens_needed": True, "scope": "submit", "name": "page"}
    assert client.get(SESSION).json() == known
    posted = client.post(JOBS, json=SCENARIO, headers=origin(client))
    assert posted.status_code == 202, posted.text
    with client.stream("GET", "/api/v1/events") as stream:
        assert next(stream.iter_bytes()).startswith(b"event: begin")
    ended = client.delete(SESSION)
    assert ended.status_code == 204
    assert attributes(ended)["max-age"] == "0"
    assert COOKIE not in client.cookies
    assert client.get(SESSION).json() == nothing


def test_an_ended_session_is_of_no_use_to_who_kept_its_cookie(
    offline: Offline, secret: str
) -> None:
    kept = begin(offline.client, secret).cookies[COOKIE]
    assert offline.client.get(JOBS).status_code == 200
    offline.client.delete(SESSION)
    is_problem(offline.client.get(JOBS, headers={"Cookie": f"{COOKIE}={kept}"}), 401)


def test_a_session_has_the_scope_of_its_token_and_ends_with_it(
    offline: Offline, tokens: TokenFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream, "HEARTBEAT_S", 0.2)
    client = offline.client
    begin(client, tokens.create("viewer", Scope.READ))
    assert client.get(JOBS).status_code == 200
    refused = is_problem(client.post(JOBS, json=SCENARIO, headers=origin(client)), 403)
    assert "submit is needed" in refused["detail"]
    with client.stream("GET", "/api/v1/events", params={"kind": "run"}) as stream:
        parts = stream.iter_bytes()
        next(parts)
        tokens.revoke("viewer")
        assert all(b"heartbeat" in part for part in parts), "the stream has ended with it"
    is_problem(client.get(JOBS), 401)
    # A new token of the same name is another one.
    tokens.create("viewer", Scope.READ)
    is_problem(client.get(JOBS), 401)


def test_a_token_counts_before_a_session(offline: Offline, tokens: TokenFile, secret: str) -> None:
    begin(offline.client, secret)
    viewer = tokens.create("viewer", Scope.READ)
    state = offline.client.get(SESSION, headers=bearer(viewer)).json()
    assert (state["name"], state["scope"]) == ("viewer", "read")
    is_problem(offline.client.get(JOBS, headers=bearer("wrong")), 401)


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://elsewhere.example"},
        {"Origin": "null"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
        {},
    ],
)
def test_what_changes_something_must_come_from_a_page_of_the_service(
    offline: Offline, secret: str, headers: dict[str, str]
) -> None:
    begin(offline.client, secret)
    is_problem(offline.client.post(JOBS, json=SCENARIO, headers=headers), 403)
    # A token is sent by no browser by itself.
    with httpx.Client(base_url=offline.client.base_url) as program:
        assert program.post(JOBS, json=SCENARIO, headers=bearer(secret)).status_code == 202
    assert offline.client.get(JOBS).json()["items"][1:] == []


def test_other_sites_begin_and_end_no_session(offline: Offline, secret: str) -> None:
    elsewhere = {"Origin": "http://elsewhere.example"}
    is_problem(begin(offline.client, secret, **elsewhere), 403)
    begin(offline.client, secret)
    is_problem(offline.client.delete(SESSION, headers=elsewhere), 403)
    assert offline.client.get(JOBS).status_code == 200


@pytest.mark.parametrize("forwarded", ["https", "https, http"])
def test_the_cookie_is_for_encrypted_connections_where_there_are(
    offline: Offline, secret: str, forwarded: str
) -> None:
    answer = begin(offline.client, secret, **{"X-Forwarded-Proto": forwarded})
    assert attributes(answer)["secure"] is True


def test_the_cookie_is_for_encrypted_connections_where_the_public_address_is_one(
    make_offline: MakeOffline, tokens: TokenFile, secret: str
) -> None:
    # The proxy does not say so.
    answer = begin(make_offline(tokens=tokens, is_public_https=True).client, secret)
    assert attributes(answer)["secure"] is True


def test_of_two_cookies_the_first_counts_which_has_the_longer_path(
    offline: Offline, secret: str
) -> None:
    own = begin(offline.client, secret).cookies[COOKIE]
    offline.client.cookies.clear()
    for cookies, status in (
        (f"theme=dark; {COOKIE}={own}; {COOKIE}=of-another-service", 200),
        (f"{COOKIE}=of-another-service; {COOKIE}={own}", 401),
        (f"x{COOKIE}={own}", 401),
    ):
        assert offline.client.get(JOBS, headers={"Cookie": cookies}).status_code == status


def test_only_hashes_are_kept_and_only_for_the_owner(
    tmp_path: Path, tokens: TokenFile, secret: str
) -> None:
    token = tokens.find(secret)
    assert token is not None
    file = SessionFile(tmp_path / "sessions.json", tokens)
    session = file.begin(token)
    text = (tmp_path / "sessions.json").read_text()
    assert session not in text
    assert secret not in text
    assert stat.S_IMODE((tmp_path / "sessions.json").stat().st_mode) == 0o600
    # It outlasts a restart.
    assert SessionFile(tmp_path / "sessions.json", tokens).find(session) == token
    assert file.find(session[:-1]) is None
    # What has expired is of no use, and goes with the next one that begins.
    stored = json.loads(text)
    stored[0]["expires"] = (datetime.now(UTC) - timedelta(seconds=1)).isoformat()
    (tmp_path / "sessions.json").write_text(json.dumps(stored))
    later = SessionFile(tmp_path / "sessions.json", tokens)
    assert later.find(session) is None
    newer = later.begin(token)
    assert len(json.loads((tmp_path / "sessions.json").read_text())) == 1
    assert later.find(newer) == token


def test_the_number_of_sessions_is_bounded(
    tmp_path: Path, tokens: TokenFile, secret: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert MOST_SESSIONS == 1000
    monkeypatch.setattr(page_sessions, "MOST_SESSIONS", 3)
    token = tokens.find(secret)
    assert token is not None
    file = SessionFile(tmp_path / "sessions.json", tokens)
    begun = [file.begin(token) for _ in range(5)]
    assert [file.find(session) is not None for session in begun] == [False] * 2 + [True] * 3


def test_a_session_is_found_while_another_one_waits_to_be_written(
    tmp_path: Path, tokens: TokenFile, secret: str
) -> None:
    sessions = SessionFile(tmp_path / "sessions.json", tokens)
    token = tokens.find(secret)
    assert token is not None
    first = sessions.begin(token)
    with ThreadPoolExecutor(2) as pool:
        # Another server of the folder writes for long, as on a slow disk.
        with UnixFileLock(tmp_path / "sessions.lock"):
            second = pool.submit(sessions.begin, token)
            with pytest.raises(TimeoutError):
                second.result(0.1)
            found = pool.submit(sessions.find, first).result(10.0)
        assert found == token
        assert sessions.find(second.result()) == token


def test_a_file_that_cannot_be_used_is_named(tmp_path: Path, tokens: TokenFile) -> None:
    (tmp_path / "sessions.json").write_text("[{")
    with pytest.raises(ConfigurationError, match=r"(?s)sessions\.json .*removing it"):
        SessionFile(tmp_path / "sessions.json", tokens).find("x")


def test_wrong_tokens_are_slowed_down_and_hold_up_no_other(
    offline: Offline, secret: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session_routes, "_WRONG_S", 1.5)
    statuses: list[int] = []

    def guess(number: int) -> None:
        with httpx.Client(base_url=offline.client.base_url, timeout=30, verify=False) as client:
            statuses.append(begin(client, f"drv_{number}").status_code)

    begun = time.monotonic()
    guesses = [threading.Thread(target=guess, args=(number,)) for number in range(12)]
    for thread in guesses:
        thread.start()
    while len(statuses) < 4:
        assert time.monotonic() < begun + 10.0
        time.sleep(0.01)
    assert set(statuses) == {429}
    assert begin(offline.client, secret).status_code == 204
    assert time.monotonic() - begun < 1.5, "before the first wrong one was answered"
    for thread in guesses:
        thread.join()
    assert sorted(statuses) == [401] * 8 + [429] * 4
    assert time.monotonic() - begun >= 1.5


def test_where_no_token_is_needed_there_is_no_session(make_offline: MakeOffline) -> None:
    client = make_offline().client
    assert client.get(SESSION).json() == {"tokens_needed": False, "scope": "admin", "name": None}
    is_problem(client.post(SESSION, json={"token": "x"}), 409)
    assert client.delete(SESSION).status_code == 204


@pytest.mark.parametrize("body", [{}, {"token": ""}, {"token": "x" * 201}, {"token": 1}, []])
def test_requests_of_another_form_are_refused(offline: Offline, body: object) -> None:
    is_problem(offline.client.post(SESSION, json=body), 422)


@pytest.mark.parametrize("body", [b"{", b'{"token": "\xef\xf4"}', b"[" * 60_000])
def test_bodies_that_are_no_json_are_refused(offline: Offline, body: bytes) -> None:
    headers = {"Content-Type": "application/json"}
    refused = is_problem(offline.client.post(SESSION, content=body, headers=headers), 422)
    assert [problem["code"] for problem in refused["problems"]] == ["json_invalid"]


def test_odd_cookies_are_no_session(offline: Offline) -> None:
    for cookie in (COOKIE, f"{COOKIE}=", f"{COOKIE}=\xff", f"a={COOKIE}", f'{COOKIE}="x; y"'):
        answer = offline.client.get(JOBS, headers={b"Cookie": cookie.encode("latin-1")})
        is_problem(answer, 401)


def test_answers_from_memory_are_for_the_session_that_asked(
    offline: Offline, tokens: TokenFile, secret: str
) -> None:
    begin(offline.client, secret)
    first = offline.client.get(JOBS)
    assert "Cookie" in first.headers["Vary"]
    with httpx.Client(base_url=offline.client.base_url) as other:
        for cookie in ("", f"{COOKIE}=wrong"):
            is_problem(other.get(JOBS, headers={"Cookie": cookie}), 401)
    tokens.revoke("page")
    tokens.create("another", Scope.READ)
    is_problem(offline.client.get(JOBS), 401)


def test_a_session_outlasts_a_restart_of_the_service(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_REQUIRE_TOKENS", "true")
    data = tmp_path / "data"
    secret = TokenFile(data / "tokens.json").create("page", Scope.ADMIN)
    monkeypatch.setenv("DRIVORA_TOKEN", secret)
    cookie = ""
    for _ in range(2):
        with (
            forked_service(data, workers=1) as url,
            httpx.Client(base_url=url, timeout=30) as client,
        ):
            if not cookie:
                cookie = begin(client, secret).cookies[COOKIE]
            client.cookies.clear()
            answer = client.get(JOBS, headers={"Cookie": f"{COOKIE}={cookie}"})
            assert answer.status_code == 200
    assert stat.S_IMODE((data / "sessions.json").stat().st_mode) == 0o600


def test_servers_that_share_a_folder_share_sessions(
    tmp_path: Path, tokens: TokenFile, secret: str
) -> None:
    token = tokens.find(secret)
    assert token is not None
    one, other = (SessionFile(tmp_path / "sessions.json", tokens) for _ in range(2))
    of_one, of_other = one.begin(token), other.begin(token)
    for file in (one, other):
        assert file.find(of_one) == file.find(of_other) == token
    other.end(of_one)
    assert one.find(of_one) is None
    assert one.find(of_other) == token
