"""Road networks imported over HTTP."""

from __future__ import annotations

import copy
import socket
import sys
import threading
import time
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest

from drivora_service.api.documentation.recorded_examples import CAMPAIGN, SCENARIO
from drivora_service.api.guards import body_limit
from drivora_service.api.guards.api_tokens import Scope, TokenFile
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.networks.provenance import read_provenance
from tests.api.conftest import NETWORK_LIMIT, MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer
from tests.api.guards.test_client_connections import answer
from tests.api.test_minimizations import address, failed_run
from tests.networks.broken_sources import SOURCES
from tests.networks.importing.test_network_importing import OSM

NETWORKS = "/api/v1/networks"
XML = {"Content-Type": "application/xml"}
TEE = (shipped_networks() / "tee-town" / "tee-town.net.xml").read_bytes()
OTHER = TEE.replace(b"</net>", b"<!-- again --></net>")
ENDLESS = "OSM, way of one node over and over"


def post(
    client: httpx.Client,
    content: bytes | Iterator[bytes] = TEE,
    *,
    name: str = "town",
    form: str = "sumo",
    headers: dict[str, str] | None = None,
    **options: str,
) -> httpx.Response:
    return client.post(
        NETWORKS,
        params={"name": name, "format": form, **options},
        content=content,
        headers={**XML, **(headers or {})},
    )


def scenario_on(town: str) -> dict[str, Any]:
    scenario = copy.deepcopy(SCENARIO)
    scenario["map_region"]["town"] = town
    return scenario


def detail(got: httpx.Response) -> str:
    assert got.headers["Content-Type"] == "application/problem+json"
    said: str = got.json()["detail"]
    return said


@pytest.fixture
def folder(offline: Offline, tmp_path: Path) -> Path:
    """The folder of imported networks of the application."""
    del offline
    return tmp_path / "networks"


def test_an_imported_network_can_be_used_at_once(offline: Offline, folder: Path) -> None:
    client = offline.client
    assert client.post("/api/v1/scenarios:validate", json=scenario_on("town")).status_code == 422
    got = post(client)
    assert got.status_code == 201, got.text
    assert got.headers["Location"] == f"{NETWORKS}/town"
    described = client.get(got.headers["Location"])
    assert got.json() == described.json()
    known = client.get(f"{NETWORKS}/tee-town").json()
    assert described.json()["sha256"] == known["sha256"]
    names = [item["name"] for item in client.get(NETWORKS).json()["items"]]
    assert "town" in names
    assert len(client.get(f"{NETWORKS}/town/geometry").json()["lanes"]) == known["lanes"]
    assert client.post("/api/v1/scenarios:validate", json=scenario_on("town")).status_code == 200
    assert client.post("/api/v1/jobs", json=scenario_on("town")).status_code == 202
    assert read_provenance(folder / "town").source == "an uploaded file"
    assert sorted(path.name for path in folder.rglob("*")) == [
        "provenance.yaml",
        "town",
        "town.net.xml",
    ]


@pytest.mark.parametrize(
    "media_type", ["application/xml", "text/xml; charset=utf-8", "application/octet-stream"]
)
def test_media_types(offline: Offline, media_type: str) -> None:
    assert post(offline.client, headers={"Content-Type": media_type}).status_code == 201


def test_conversions(offline: Offline) -> None:
    pytest.importorskip("sumo")
    got = post(offline.client, OSM.encode(), form="openstreetmap")
    assert got.status_code == 201, got.text
    assert got.json()["traffic_lights"] == 1


def test_real_towns(make_offline: MakeOffline, shared_data: Path) -> None:
    pytest.importorskip("sumo")
    client = make_offline(network_bytes=1 << 26).client
    for town in ("Town01", "Town02", "Town04"):
        for form, suffix in (("sumo", ".net.xml"), ("opendrive", ".xodr")):
            data = (shared_data / "maps" / f"{town}{suffix}").read_bytes()
            got = post(client, data, name=f"{town}-{form}", form=form)
            assert got.status_code == 201, got.text
        lights = {
            client.get(f"{NETWORKS}/{town}-{form}").json()["traffic_lights"]
            for form in ("sumo", "opendrive")
        }
        assert len(lights) == 1


def test_the_format_is_that_of_the_root_element(offline: Offline) -> None:
    got = post(offline.client, form="opendrive")
    assert got.status_code == 422
    assert "is not OpenDRIVE: its root element is <net>" in detail(got)


def test_a_name_that_is_taken(offline: Offline) -> None:
    client = offline.client
    assert post(client).status_code == 201
    again = post(client, OTHER)
    assert again.status_code == 409
    assert "'town' is already imported; replace it" in detail(again)
    assert [problem["code"] for problem in again.json()["problems"]] == ["network_imported"]
    for replace in ("true", "false"):
        shipped = post(client, name="rural", replace=replace)
        assert shipped.status_code == 409
        assert "comes with Drivora" in detail(shipped)
        assert [problem["code"] for problem in shipped.json()["problems"]] == ["network_shipped"]


def test_every_answer_about_a_replaced_network_is_a_new_one(offline: Offline) -> None:
    client = offline.client
    assert post(client).status_code == 201
    addresses = (f"{NETWORKS}/town", f"{NETWORKS}/town/geometry")
    before = [client.get(address) for address in addresses]
    replaced = post(client, OTHER, replace="true")
    assert replaced.status_code == 201, replaced.text
    for url, old in zip(addresses, before, strict=True):
        # At once: answers are kept for a moment, but not beyond a change.
        new = client.get(url, headers={"If-None-Match": old.headers["ETag"]})
        assert new.status_code == 200
        assert new.headers["ETag"] != old.headers["ETag"]
        assert new.json()["sha256"] == replaced.json()["sha256"] != old.json()["sha256"]


def test_a_new_network_is_in_the_list_at_once(offline: Offline) -> None:
    for number in range(3):
        before = offline.client.get(NETWORKS).json()["items"]
        assert post(offline.client, name=f"town-{number}").status_code == 201
        assert len(offline.client.get(NETWORKS).json()["items"]) == len(before) + 1


def test_a_network_of_unfinished_runs_is_not_replaced(offline: Offline) -> None:
    client = offline.client
    assert post(client).status_code == 201
    job = client.post("/api/v1/jobs", json=scenario_on("town")).json()["id"]
    before = client.get(f"{NETWORKS}/town").json()
    refused = post(client, OTHER, replace="true")
    assert refused.status_code == 409
    assert "while work on it is unfinished (1 run); wait until it has ended" in detail(refused)
    assert client.get(f"{NETWORKS}/town").json() == before
    # Another network is no concern of these runs.
    assert post(client, name="other").status_code == 201
    client.post(f"/api/v1/jobs/{job}:cancel")
    assert post(client, OTHER, replace="true").status_code == 201


def test_a_network_of_unfinished_campaigns_is_not_replaced(offline: Offline) -> None:
    client = offline.client
    assert post(client).status_code == 201
    campaign = {**CAMPAIGN, "scenario": scenario_on("town")}
    posted = client.post("/api/v1/campaigns", json=campaign)
    assert posted.status_code == 202, posted.text
    refused = post(client, OTHER, replace="true")
    assert (refused.status_code, "(1 campaign)" in detail(refused)) == (409, True)
    client.post(f"/api/v1/campaigns/{posted.json()['id']}:cancel")
    assert post(client, OTHER, replace="true").status_code == 201


def test_a_network_of_unfinished_minimisations_is_not_replaced(offline: Offline) -> None:
    client = offline.client
    assert post(client).status_code == 201
    run = failed_run(offline, "collision", town="town")
    minimization = client.post(address(run)).json()["id"]
    refused = post(client, OTHER, replace="true")
    assert (refused.status_code, "(1 minimisation)" in detail(refused)) == (409, True)
    client.post(f"/api/v1/minimizations/{minimization}:cancel")
    assert post(client, OTHER, replace="true").status_code == 201


def test_only_administrators_import(make_offline: MakeOffline, tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    client = make_offline(tokens=tokens).client
    assert post(client).status_code == 401
    for scope, status in ((Scope.READ, 403), (Scope.SUBMIT, 403), (Scope.ADMIN, 201)):
        secret = tokens.create(scope.name, scope)
        got = post(client, headers=bearer(secret))
        assert got.status_code == status
        if status == 403:
            assert f"has scope {scope.name.lower()}; admin is needed" in detail(got)


def test_conversions_without_netconvert(offline: Offline, monkeypatch: pytest.MonkeyPatch) -> None:
    # None in sys.modules is how Python marks a package that cannot be imported.
    monkeypatch.setitem(sys.modules, "sumo", None)
    for form in ("opendrive", "openstreetmap"):
        # Nothing of the body is needed for the answer.
        with partial(offline.client, form=form) as connection:
            status, _, body = answer(connection)
        assert status == 422
        assert "netconvert is not installed; it comes with an extra" in str(body["detail"])
    assert post(offline.client).status_code == 201


@pytest.mark.parametrize("name", ["", "../x", "a/b", "a.b", ".", "..", "ä", "a b", "x" * 65, "a\n"])
def test_names_that_are_not_allowed(offline: Offline, folder: Path, name: str) -> None:
    got = post(offline.client, name=name)
    assert got.status_code == 422
    assert "cannot name a network: use 1 to 64 letters" in detail(got)
    assert not folder.exists()


def test_what_a_request_lacks(offline: Offline) -> None:
    client = offline.client
    assert client.post(NETWORKS, content=TEE, headers=XML).status_code == 422
    wrong = post(client, form="shapefile")
    assert "'sumo', 'opendrive' or 'openstreetmap'" in wrong.json()["problems"][0]["message"]
    path = post(client, path="/etc/passwd")
    assert "'path'; " in path.json()["problems"][0]["message"]


@pytest.mark.parametrize(
    ("headers", "found"),
    [
        ({"Content-Type": "application/json"}, "not 'application/json'"),
        ({"Content-Type": "multipart/form-data; boundary=x"}, "not 'multipart/form-data'"),
        ({"Content-Encoding": "gzip"}, "not encoded as 'gzip'"),
        ({"Content-Encoding": "br"}, "not encoded as 'br'"),
    ],
)
def test_bodies_that_are_not_plain_files(
    offline: Offline, headers: dict[str, str], found: str
) -> None:
    got = post(offline.client, headers=headers)
    assert got.status_code == 415
    assert found in detail(got)
    assert "application/xml" in got.headers["Accept-Post"]


def test_its_body_has_a_limit_of_its_own(offline: Offline, folder: Path) -> None:
    client = offline.client
    filled = TEE + b" " * (NETWORK_LIMIT - len(TEE))
    assert post(client, filled).status_code == 201
    for content in (filled + b" ", iter([filled, b" "])):
        got = post(client, content, name="large")
        assert got.status_code == 413
        assert f"larger than the {NETWORK_LIMIT} bytes" in detail(got)
    assert [path.name for path in folder.iterdir()] == ["town"]
    other = client.post(
        "/api/v1/jobs", content=filled, headers={"Content-Type": "application/json"}
    )
    assert other.status_code == 413


def test_a_second_import_is_told_to_come_back(offline: Offline, folder: Path) -> None:
    ended = threading.Event()
    answers: list[httpx.Response] = []

    def body() -> Iterator[bytes]:
        yield TEE[:100]
        ended.wait(60.0)
        yield TEE[100:]

    def first() -> None:
        with httpx.Client(base_url=offline.client.base_url, timeout=60) as client:
            answers.append(post(client, body()))

    importing = threading.Thread(target=first)
    importing.start()
    # What was sent may still be on its way: a second one before it would take its turn.
    wait_until_begun(folder)
    second = post(offline.client, name="other")
    ended.set()
    importing.join()
    assert second.status_code == HTTPStatus.TOO_MANY_REQUESTS
    assert second.headers["Retry-After"] == "5"
    assert "another network is being imported" in detail(second)
    assert answers[0].status_code == 201
    assert post(offline.client, name="other").status_code == 201


def partial(client: httpx.Client, rest: bytes = b"", *, form: str = "sumo") -> socket.socket:
    """A connection on which a body of 1000 bytes was begun."""
    address = urlsplit(str(client.base_url))
    connection = socket.create_connection((address.hostname, address.port), timeout=60)
    connection.sendall(
        f"POST {NETWORKS}?name=town&format={form} HTTP/1.1\r\nHost: localhost\r\n"
        f"Content-Type: application/xml\r\nContent-Length: 1000\r\n\r\n".encode()
        + rest
    )
    return connection


def wait_until_begun(folder: Path) -> None:
    """Waits until an import is being received."""
    deadline = time.monotonic() + 30.0
    while not folder.exists() or not any(folder.iterdir()):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def wait_until_empty(folder: Path) -> None:
    """Waits until an import was begun, and has ended."""
    deadline = time.monotonic() + 30.0
    while not folder.exists() or any(folder.iterdir()):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_client_that_leaves_while_it_sends(offline: Offline, folder: Path) -> None:
    with partial(offline.client, b"<net>"):
        wait_until_begun(folder)
    wait_until_empty(folder)
    assert post(offline.client).status_code == 201


def test_a_client_that_stops_sending(
    offline: Offline, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(body_limit, "BODY_SECONDS", 0.5)
    with partial(offline.client, b"<net>" + b" " * 900) as connection:
        assert answer(connection)[0] == 408
    wait_until_empty(folder)
    assert post(offline.client).status_code == 201


def test_a_client_that_leaves_while_its_network_is_converted(
    make_offline: MakeOffline, tmp_path: Path
) -> None:
    pytest.importorskip("sumo")
    client = make_offline(network_bytes=1 << 26).client
    with pytest.raises(httpx.ReadTimeout):
        client.post(
            NETWORKS,
            params={"name": "town", "format": "openstreetmap"},
            content=SOURCES[ENDLESS].make(),
            headers=XML,
            timeout=3.0,
        )
    wait_until_empty(tmp_path / "networks")
    assert post(client).status_code == 201


def test_a_folder_that_cannot_be_written(offline: Offline, folder: Path) -> None:
    folder.write_text("no folder")
    got = post(offline.client)
    assert got.status_code == 503
    assert "the network cannot be stored now: " in detail(got)
