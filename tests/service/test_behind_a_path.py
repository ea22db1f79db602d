"""A real service behind real proxies that have it under a path of their host."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from http.cookies import SimpleCookie
from pathlib import Path
from urllib.parse import urljoin, urlsplit

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.api.guards.page_sessions import COOKIE
from drivora_service.api.schemas.events import Begin, Changes
from drivora_service.client import Client, call
from drivora_service.errors import NotFound
from drivora_service.store.changes.change_lists import ChangedKind
from tests.command_process import begin
from tests.forked_service import forked_service
from tests.reverse_proxies import PROXIES, find_proxy, reverse_proxy

API = "/drivora/api/v1"
LARGE = 20 << 20
"""Bytes of a body: more than nginx takes unless it is configured, less than the service's limit."""


@dataclass(frozen=True)
class Place:
    """A service as its clients see it.

    Attributes:
        url: Its address, with the path.
        token: A token with all scopes.
    """

    url: str
    token: str

    @property
    def origin(self) -> str:
        """Scheme, host and port."""
        return self.url.removesuffix("/drivora")

    @property
    def bearer(self) -> dict[str, str]:
        """The header with the token."""
        return {"Authorization": f"Bearer {self.token}"}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Place]:
    """A service with the settings of the operators' page, asked without a proxy."""
    data = tmp_path_factory.mktemp("behind") / "data"
    data.mkdir(mode=0o700)
    token = TokenFile(data / "tokens.json").create("all", Scope.ADMIN)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DRIVORA_REQUIRE_TOKENS", "true")
        patch.setenv("DRIVORA_ROOT_PATH", "/drivora/")
        with forked_service(data, workers=1) as url:
            yield Place(url, token)


@pytest.fixture(scope="module", params=PROXIES)
def place(
    request: pytest.FixtureRequest, service: Place, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Place]:
    """The service behind a proxy of each kind."""
    kind: str = request.param
    if find_proxy(kind) is None:
        pytest.skip(f"{kind.partition('-')[0]} is not on this machine")
    folder = tmp_path_factory.mktemp("proxy") / kind
    with reverse_proxy(kind, urlsplit(service.url).netloc, folder) as url:
        yield Place(url, service.token)


@pytest.fixture
def http(place: Place) -> Iterator[httpx.Client]:
    """Asks the host of the proxy; paths are whole."""
    with httpx.Client(base_url=place.origin, timeout=60, verify=False) as client:
        yield client


def test_the_service_says_its_address_with_the_path(service: Place) -> None:
    assert urlsplit(service.url).path == "/drivora"


@pytest.mark.parametrize("path", ["", "/runs/0123abcd", "/batches/x/y?status=failed"])
def test_the_page_finds_its_files_from_every_address(http: httpx.Client, path: str) -> None:
    document = http.get(f"/drivora{path or '/'}")
    assert document.status_code == 200
    files = re.findall(r'<(?:script|link)[^>]* (?:src|href)="([^"]+)"', document.text)
    assert len(files) >= 5
    for file in files:
        assert file.startswith("/drivora/"), file
        assert http.get(file).status_code == 200, file
    policy = document.headers["content-security-policy"].split("; ")
    assert "base-uri 'none'" in policy
    assert "script-src 'self'" in policy
    assert "<base" not in document.text
    packed = http.get(f"/drivora{path or '/'}", headers={"Accept-Encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.text == document.text


def test_the_path_without_its_slash_leads_to_the_page(http: httpx.Client) -> None:
    answer = http.get("/drivora", follow_redirects=True)
    assert answer.status_code == 200
    assert 'id="page"' in answer.text


def test_no_script_or_style_names_a_file_by_a_whole_path(http: httpx.Client) -> None:
    left = re.findall(r'"/drivora(/assets/[^"]+\.(?:js|css))"', http.get("/drivora/").text)
    seen: dict[str, str] = {}
    while left:
        name = left.pop()
        if name in seen:
            continue
        text = seen[name] = http.get(f"/drivora{name}").text
        assert not re.search(r'["\'(`]/assets/', text), name
        found = re.findall(r'["\'`](?:\./|assets/)?([\w.-]+-[\w-]{8}\.(?:js|css))["\'`]', text)
        left += [f"/assets/{one}" for one in found]
    # With those of the screens, and of the worker that has the events.
    assert len(seen) > 50
    assert any("/hub.worker-" in name for name in seen)


def test_addresses_in_answers_lead_back(place: Place, http: httpx.Client) -> None:
    http.headers.update(place.bearer)
    posted = http.post(f"{API}/jobs", json=SCENARIO)
    assert posted.status_code == 202, posted.text
    job = posted.json()
    assert posted.headers["location"] == f"{API}/jobs/{job['id']}"
    assert http.get(urljoin(f"{place.url}/", posted.headers["location"])).json()["id"] == job["id"]
    run = http.get(job["run_url"])
    assert run.status_code == 200
    assert http.get(run.json()["scenario_url"]).status_code == 200
    networks = http.get(f"{API}/networks").json()["items"]
    assert http.get(http.get(networks[0]["url"]).json()["geometry_url"]).status_code == 200

    batch = http.post(f"{API}/batches", json=[SCENARIO])
    assert batch.headers["location"].startswith(f"{API}/batches/")
    assert http.get(batch.json()["batch"]["jobs_url"]).status_code == 200
    http.post(f"{batch.headers['location']}:cancel")


def test_problems_have_the_path_that_was_asked_for(place: Place, http: httpx.Client) -> None:
    unknown = http.get(f"{API}/jobs/{'0' * 24}", headers=place.bearer)
    assert unknown.status_code == 404
    assert unknown.json()["instance"] == f"{API}/jobs/{'0' * 24}"
    nowhere = http.get("/drivora/api/nothing")
    assert nowhere.json()["instance"] == "/drivora/api/nothing"
    assert "/drivora/docs" in nowhere.json()["detail"]
    refused = http.get(f"{API}/jobs")
    assert (refused.status_code, refused.json()["instance"]) == (401, f"{API}/jobs")
    denied = http.delete(f"{API}/jobs", headers={"Origin": "http://evil.example"})
    assert (denied.status_code, denied.json()["instance"]) == (403, f"{API}/jobs")
    wrong = http.delete(f"{API}/jobs", headers=place.bearer)
    assert (wrong.status_code, wrong.headers["allow"]) == (405, "GET, HEAD, POST")


def test_the_description_of_the_api_has_the_path(http: httpx.Client) -> None:
    docs = http.get("/drivora/docs").text
    (address,) = re.findall(r'href="([^"]+openapi\.json)"', docs)
    document = http.get(address).json()
    assert document["servers"] == [{"url": "/drivora"}]
    assert "/api/v1/jobs" in document["paths"]
    assert "<code>/drivora/api/v1/jobs</code>" in docs


def test_a_session_is_for_the_path_only(place: Place, http: httpx.Client) -> None:
    own = {"Origin": place.origin, "Sec-Fetch-Site": "same-origin"}
    began = http.post(f"{API}/session", json={"token": place.token}, headers=own)
    assert began.status_code == 204, began.text
    cookie = SimpleCookie(began.headers["set-cookie"])[COOKIE]
    assert (cookie["path"], cookie["secure"]) == ("/drivora", "")
    assert http.get(f"{API}/jobs").status_code == 200
    posted = http.post(f"{API}/jobs", json=SCENARIO, headers=own)
    assert posted.status_code == 202, posted.text
    for other in (
        {"Origin": "http://evil.example", "Sec-Fetch-Site": "cross-site"},
        {"Origin": f"{place.origin}0"},
    ):
        assert http.post(f"{API}/jobs", json=SCENARIO, headers=other).status_code == 403
    # Another service at the root of the same host has a cookie of the same name.
    both = f"{COOKIE}={cookie.value}; {COOKIE}=of-the-other"
    with httpx.Client(base_url=place.origin, verify=False) as browser:
        assert browser.get(f"{API}/jobs", headers={"Cookie": both}).status_code == 200
    assert http.delete(f"{API}/session", headers=own).status_code == 204
    assert COOKIE not in http.cookies
    assert http.get(f"{API}/jobs").status_code == 401


def test_headers_do_not_say_where_the_service_is(place: Place, http: httpx.Client) -> None:
    said = {"X-Forwarded-Prefix": "/evil", "X-Forwarded-Path": "/evil", "X-Script-Name": "/evil"}
    plain = http.get("/drivora/runs")
    assert http.get("/drivora/runs", headers=said).text == plain.text
    networks = http.get(f"{API}/networks", headers={**place.bearer, **said}).json()["items"]
    assert networks[0]["url"].startswith(f"{API}/networks/")


@pytest.mark.parametrize("end", ["", "/"])
def test_the_client_lists_listens_and_saves(
    place: Place, end: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Client(place.url + end, token=place.token) as client:
        assert client.readiness().ready
        events = client.events([ChangedKind.RUN])
        assert isinstance(next(events).data, Begin)
        posted = [client.post_job({**SCENARIO, "seed": seed}).id for seed in range(2)]
        ended: set[str] = set()
        for event in events:
            if isinstance(event.data, Changes):
                ended |= {one.id for one in event.data.changes if one.status == "finished"}
            if ended >= set(posted):
                break
        client.save_run_observations(tmp_path / "run.parquet", posted[0])
        assert (tmp_path / "run.parquet").read_bytes().startswith(b"PAR1")
        monkeypatch.setattr(call, "_MOST_ITEMS", 1)
        assert [run.id for run in client.runs(limit=2)] == posted[::-1]
        with pytest.raises(NotFound):
            client.run("0" * 24)


@pytest.mark.parametrize("end", ["", "/"])
def test_commands_take_the_address_with_the_path(place: Place, end: str, tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.json"
    scenario.write_text(json.dumps(SCENARIO))
    out, err = tmp_path / "out", tmp_path / "err"
    command = begin(
        *("run", scenario, "--server", place.url + end, "--json"),
        folder=tmp_path,
        environment={**os.environ, "DRIVORA_TOKEN": place.token},
        out=out,
        err=err,
    )
    assert command.wait(120) in (0, 1), err.read_text()
    assert json.loads(out.read_text())


def test_large_bodies_pass(place: Place, http: httpx.Client) -> None:
    http.headers.update({**place.bearer, "Content-Type": "application/json"})
    document = json.dumps(SCENARIO).encode()
    gap = b" " * (1 << 16)

    def parts() -> Iterator[bytes]:
        yield b"[" + document
        for _ in range(LARGE // len(gap)):
            yield gap
        yield b"]"

    for body in (b"".join(parts()), parts()):
        posted = http.post(f"{API}/batches", content=body)
        assert posted.status_code == 202, posted.text
    refused = http.post(f"{API}/batches", content=gap * (33 << 4))
    assert refused.status_code == 413
    assert refused.json()["instance"] == f"{API}/batches"


def test_probes_ask_the_service_without_the_path(service: Place) -> None:
    origin = service.origin
    for path in ("/healthz", "/readyz", "/drivora/readyz", "/api/v1/readyz"):
        assert httpx.get(f"{origin}{path}", verify=False).status_code == 200, path
    assert httpx.get(f"{origin}/drivoraX/readyz", verify=False).status_code == 404
