"""The page as files of the service."""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterator

import httpx
import pytest

from drivora_service.dashboard.page import BUILT, HELP, SECTIONS
from drivora_service.store.campaigns.campaign_warnings import PAGE

ROUTER = BUILT.with_name("web") / "src" / "router.tsx"


@pytest.fixture
def client(service_url: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=service_url, timeout=60) as found:
        yield found


def test_the_installed_package_has_the_page(client: httpx.Client) -> None:
    answer = client.get("/")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/html")
    assert answer.headers["cache-control"] == "no-cache"
    scripts = re.findall(r'src="(/assets/[^"]+)"', answer.text)
    assert scripts
    for script in scripts:
        found = client.get(script)
        assert found.status_code == 200
        assert "immutable" in found.headers["cache-control"]


def test_every_screen_is_the_same_document(client: httpx.Client) -> None:
    document = client.get("/").text
    for section in SECTIONS:
        assert client.get(f"/{section}").text == document
        assert client.get(f"/{section}/an-id/part").text == document


BROWSER = {"Accept": "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"}


@pytest.mark.parametrize("path", ["/nowhere", "/nowhere/else", "/run", "/documents", "/no.ico"])
def test_who_goes_nowhere_in_a_browser_gets_the_page_which_says_so(
    client: httpx.Client, path: str
) -> None:
    shown = client.get(path, headers=BROWSER)
    assert shown.status_code == 404
    assert shown.text == client.get("/").text
    assert shown.headers["content-security-policy"]
    assert "Accept" in ",".join(shown.headers.get_list("vary"))
    assert client.head(path, headers=BROWSER).status_code == 404
    fetched = BROWSER | {"Sec-Fetch-Mode": "cors"}
    others = [
        client.get(path),
        client.get(path, headers=fetched),
        client.post(path, headers=BROWSER),
        client.delete(path),
    ]
    for answer in others:
        assert answer.status_code == 404, answer.request
        assert answer.headers["content-type"] == "application/problem+json"
    assert client.get(path, headers={"If-None-Match": shown.headers["etag"], **BROWSER}).text


@pytest.mark.parametrize(
    "path",
    [
        *("/api/v1/nothing", "/api", "/docs/x", "/healthz/x", "/readyz/x", "/metrics/x"),
        *("/api/v1/runs/none", "/api/v1/nothing/at/all"),
    ],
)
def test_programs_are_told_in_their_form_what_is_not_there(client: httpx.Client, path: str) -> None:
    answer = client.get(path, headers=BROWSER)
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


def test_methods_are_told_as_before(client: httpx.Client) -> None:
    refused = client.delete("/api/v1/runs", headers=BROWSER)
    assert (refused.status_code, refused.headers["allow"]) == (405, "GET, HEAD")
    refused = client.get("/api/v1/scenarios:validate", headers=BROWSER)
    assert (refused.status_code, refused.headers["allow"]) == (405, "POST")


def test_the_sections_are_those_of_the_router() -> None:
    paths = re.findall(r'path: "/([a-z]+)', ROUTER.read_text())
    assert set(paths) <= set(SECTIONS)


def test_the_policy_allows_this_service_only(client: httpx.Client) -> None:
    answer = client.get("/runs")
    policy = dict(
        part.strip().split(" ", 1) for part in answer.headers["content-security-policy"].split(";")
    )
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    outside = re.compile(r"unsafe|https?:|\*")
    assert not any(outside.search(value) for value in policy.values())
    assert "<script>" not in answer.text
    assert "style=" not in answer.text


def test_files_are_sent_as_the_browser_accepts_them(client: httpx.Client) -> None:
    script = re.findall(r'src="(/assets/[^"]+)"', client.get("/").text)[0]
    plain = client.get(script, headers={"accept-encoding": "identity"})
    assert "content-encoding" not in plain.headers
    packed = client.get(script, headers={"accept-encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.content == plain.content
    name = script.rpartition("/")[2]
    assert gzip.decompress((BUILT / "assets" / f"{name}.gz").read_bytes()) == plain.content


@pytest.mark.parametrize("name", ["none.js", "..%2Findex.html", "%2e%2e%2findex.html"])
def test_other_files_are_not_sent(client: httpx.Client, name: str) -> None:
    assert client.get(f"/assets/{name}").status_code == 404


def test_the_service_has_the_pages_that_warnings_link_to(client: httpx.Client) -> None:
    answer = client.get("/help/when-everything-or-nothing-fails")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/plain; charset=utf-8"
    assert answer.text.startswith("# Your ADS fails everything (or nothing)\n")
    name, _, _ = PAGE.rpartition(".")
    assert name.rpartition("/")[2] in HELP


@pytest.mark.parametrize("name", ["add-an-agent", "nothing", "..%2Findex", "%2e%2e%2fREADME"])
def test_other_pages_are_not_sent(client: httpx.Client, name: str) -> None:
    assert client.get(f"/help/{name}").status_code == 404


def test_the_first_download_is_small() -> None:
    """The document, and all that it names: what a browser loads before the first screen."""
    document = (BUILT / "index.html").read_text()
    named = re.findall(r'(?:src|href)="/(assets/[^"]+\.(?:js|css))"', document)
    assert any(name.endswith(".js") for name in named)
    assert any(name.endswith(".css") for name in named)
    sizes = {
        name: (BUILT / f"{name}.gz").stat().st_size
        for name in ["index.html", *dict.fromkeys(named)]
    }
    assert sum(sizes.values()) < 600_000, sizes


def test_the_lock_file_names_no_address() -> None:
    lock = BUILT.with_name("web") / "package-lock.json"
    assert "://" not in lock.read_text(), "remove what npm wrote: resolved, funding"
