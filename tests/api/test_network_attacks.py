"""Hostile uploads of road networks to a real service, which must not notice them.

Each is refused with a reason. Meanwhile the service answers at once, its memory does not grow, and
nothing stays on the disk.
"""

from __future__ import annotations

import gzip
import io
import os
import signal
import socket
import threading
import time
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import psutil
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.networks.catalogue import shipped_networks
from tests.api.answers.test_network_imports import ENDLESS, NETWORKS, detail, post
from tests.api.guards.test_client_connections import answer
from tests.forked_service import killed_service
from tests.networks.broken_sources import SOURCES, opendrive, road
from tests.networks.importing.test_confined_import import many_lanes, processes_in
from tests.networks.importing.test_network_importing import OSM

TEE = (shipped_networks() / "tee-town" / "tee-town.net.xml").read_text()
LIMIT = 64 << 20
MOST_GROWTH = 48 << 20
"""Bytes that the server's memory may grow by: less than any of the large bodies."""
MOST_LATENCY_S = 2.0
"""Of a question about health, on a machine that is busy with other tests."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attacked:
    """A service.

    Attributes:
        pid: Of its process.
        networks: Its folder of imported networks.
    """

    client: httpx.Client
    pid: int
    networks: Path

    def files(self) -> set[Path]:
        """Returns what is in the folder of networks."""
        return set(self.networks.rglob("*"))

    def memory(self) -> int:
        """Returns the resident memory of the server, bytes."""
        memory: int = psutil.Process(self.pid).memory_info().rss
        return memory

    @contextmanager
    def unharmed(self) -> Iterator[None]:
        """Checks that the service does not notice what is done meanwhile."""
        ended = threading.Event()
        latencies: list[float] = []
        memories: list[int] = []

        def look() -> None:
            with httpx.Client(base_url=self.client.base_url, timeout=60.0) as client:
                while True:
                    begun = time.monotonic()
                    assert client.get("/healthz").status_code == 200
                    latencies.append(time.monotonic() - begun)
                    memories.append(self.memory())
                    if ended.wait(0.05):
                        return

        files, memory = self.files(), self.memory()
        looking = threading.Thread(target=look)
        looking.start()
        try:
            yield
        finally:
            ended.set()
            looking.join()
        assert max(latencies) < MOST_LATENCY_S
        assert max(memories) - memory < MOST_GROWTH
        assert self.files() == files
        for stage in self.networks.glob(".*"):
            assert processes_in(stage) == []

    def refusal(
        self,
        content: bytes | Callable[[], Iterator[bytes]],
        *,
        form: str = "sumo",
        status: int = 422,
        **headers: str,
    ) -> str:
        """Posts a file that must be refused, and returns the reason."""
        body = content if isinstance(content, bytes) else content()
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        with self.unharmed():
            got = post(self.client, body, name="attack", form=form, headers=given)
        assert got.status_code == status, got.text
        assert self.client.get(f"{NETWORKS}/attack").status_code == 404
        return detail(got)


@pytest.fixture(scope="module")
def attacked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Attacked]:
    data = tmp_path_factory.mktemp("attacked")
    with killed_service(data) as (begun, url), httpx.Client(base_url=url, timeout=180) as client:
        # What the first import loads is no growth by the attacks.
        assert post(client, TEE.encode(), name="first").status_code == 201
        assert begun.process.pid is not None
        yield Attacked(client=client, pid=begun.process.pid, networks=data / "networks")
    assert "Traceback" not in (data / "service.log").read_text()


ROOTS = {"sumo": "net", "opendrive": "OpenDRIVE", "openstreetmap": "osm"}
LAUGHS = '<!ENTITY a "aaaaaaaaaa">' + "".join(
    f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(9)
)
TYPES = {
    "entity bomb": (LAUGHS, "&j;"),
    "quadratic blow-up": (f'<!ENTITY a "{"a" * 100_000}">', "&a;" * 100_000),
    "external file": ('<!ENTITY a SYSTEM "file:///etc/passwd">', "&a;"),
    "external device": ('<!ENTITY a SYSTEM "file:///dev/zero">', "&a;"),
    "external address": ('<!ENTITY a SYSTEM "http://127.0.0.1:9/">', "&a;"),
    "parameter entity": ('<!ENTITY % a SYSTEM "file:///etc/passwd"> %a;', ""),
}


@pytest.mark.parametrize("form", ROOTS)
@pytest.mark.parametrize("kind", TYPES)
def test_entities(attacked: Attacked, kind: str, form: str) -> None:
    declared, used = TYPES[kind]
    root = ROOTS[form]
    bomb = f'<?xml version="1.0"?><!DOCTYPE {root} [{declared}]><{root}>{used}</{root}>'
    assert "document type declaration" in attacked.refusal(bomb.encode(), form=form)


def test_entities_in_another_encoding(attacked: Attacked) -> None:
    bomb = f'<?xml version="1.0" encoding="UTF-16"?><!DOCTYPE net [{LAUGHS}]><net>&j;</net>'
    assert "document type declaration" in attacked.refusal(bomb.encode("utf-16"))
    other = '<?xml version="1.0" encoding="UTF-7"?><net/>'
    assert "encoding 'UTF-7'" in attacked.refusal(other.encode())


@pytest.mark.parametrize("form", ROOTS)
def test_other_files_of_the_server(attacked: Attacked, form: str) -> None:
    root = ROOTS[form]
    include = '<include href="/etc/passwd" file="/etc/passwd"/>'
    said = attacked.refusal(f"<{root}>{include}</{root}>".encode(), form=form)
    assert "includes another file" in said


def test_files_that_runs_would_write(attacked: Attacked) -> None:
    for element, says in (
        ('<edgeData id="x" freq="1" file="../drivora.sqlite3"/>', "<edgeData>"),
        ('<tlLogic id="x" type="swarm" programID="0" offset="0"/>', "'swarm'"),
        ('<param key="file" value="../drivora.sqlite3"/>', "parameter 'file'"),
    ):
        assert says in attacked.refusal(TEE.replace("</net>", f"{element}</net>").encode())


def zeros(count: int) -> Iterator[bytes]:
    """A body in chunks, so that it is sent without its length."""
    piece = bytes(1 << 20)
    for _ in range(count >> 20):
        yield piece


@pytest.mark.parametrize("form", ROOTS)
def test_bodies_that_are_too_large(attacked: Attacked, form: str) -> None:
    declared = attacked.refusal(bytes(100 << 20), form=form, status=413)
    chunked = attacked.refusal(lambda: zeros(100 << 20), form=form, status=413)
    assert declared == chunked == f"the body is larger than the {LIMIT} bytes that are allowed"


_EDGE = b'<edge id="%b"/>' % (b"e" * 60)
LARGE: dict[str, Callable[[], Iterator[bytes]]] = {
    "zeros": lambda: zeros(LIMIT),
    "white space": lambda: iter([b"<net>", *[b" " * (1 << 20)] * 63, b"</net>"]),
    "one attribute": lambda: iter([b'<net a="', *[b"a" * (1 << 20)] * 63, b'"/>']),
    "elements without end": lambda: iter([b"<net>", *[_EDGE * 10_000] * 85]),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", LARGE)
def test_large_bodies_of_nothing(attacked: Attacked, kind: str) -> None:
    said = attacked.refusal(LARGE[kind])
    assert "not well-formed XML" in said or "MB without an element" in said


@cache
def bombs() -> tuple[bytes, bytes]:
    """Two hundred megabytes of zeros: compressed by gzip, and in a ZIP archive."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        file.writestr("town.net.xml", bytes(200 << 20))
    return gzip.compress(bytes(200 << 20), compresslevel=1), archive.getvalue()


@pytest.mark.parametrize("form", ROOTS)
def test_compressed_bombs(attacked: Attacked, form: str) -> None:
    bomb, archive = bombs()
    for data in (bomb, archive):
        assert "is compressed; unpack it" in attacked.refusal(data, form=form)
    for coding in ("gzip", "deflate", "br", "zstd", "identity, gzip"):
        said = attacked.refusal(bomb, form=form, status=415, Content_Encoding=coding)
        assert f"not encoded as '{coding}'" in said


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "not well-formed XML: no element found"),
        (b"no XML", "not well-formed XML"),
        (os.urandom(100_000), "not well-formed XML"),
        (b"<net><edge></net>", "mismatched tag"),
        (TEE.encode()[:50_000], "not well-formed XML"),
        (b"\xef\xbb\xbf<net>\xff\xfe</net>", "not well-formed XML"),
        (f'<?xml version="1.0" encoding="UTF-16"?>{TEE}'.encode(), "not well-formed XML"),
        (b"<net>" * 100_000 + b"</net>" * 100_000, "100 elements within one another"),
        (b"<net/>", "cannot import the file: network 'attack'"),
    ],
)
def test_broken_files(attacked: Attacked, content: bytes, says: str) -> None:
    assert says in attacked.refusal(content)


@pytest.mark.parametrize("form", ["opendrive", "openstreetmap"])
def test_broken_sources_of_conversions(attacked: Attacked, form: str) -> None:
    pytest.importorskip("sumo")
    whole = OSM if form == "openstreetmap" else opendrive(road())
    root = ROOTS[form].encode()
    for content in (
        whole.encode()[: len(whole) // 2],
        b"<%b>%b%b</%b>" % (root, b"<a>" * 100_000, b"</a>" * 100_000, root),
        b"<%b/>" % root,
    ):
        assert attacked.refusal(content, form=form)


FIRST_SHAPE = 'shape="'


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (FIRST_SHAPE, 'shape="nan,nan ', "found nan in"),
        (FIRST_SHAPE, 'shape="inf,0 ', "found inf in"),
        (FIRST_SHAPE, 'shape="1e300,1e300 ', "found 1e+300 in"),
        (FIRST_SHAPE, 'shape="1e7,1e7 ', "its lanes spread over"),
        (FIRST_SHAPE, 'shape="north,south ', "is not a SUMO network (ValueError"),
        ('length="', 'length="-', "has a length of -"),
        ('speed="', 'speed="nan" x="', "has a speed of nan"),
        ('via="', 'via="nowhere', "is not a SUMO network (KeyError"),
        (' to="', ' to="nowhere', "network 'attack'"),
    ],
)
def test_networks_of_nonsense(attacked: Attacked, old: str, new: str, says: str) -> None:
    assert old in TEE
    assert says in attacked.refusal(TEE.replace(old, new).encode())


@pytest.mark.slow(seconds=60)
def test_a_network_of_a_million_lanes(attacked: Attacked) -> None:
    lanes = "".join(
        f'<lane id="{i}" index="0" speed="9" length="9" shape="0,0 9,0"/>' for i in range(1_000_000)
    )
    network = f'<net version="1.20"><edge id="e" from="a" to="b">{lanes}</edge></net>'
    assert len(network) < LIMIT
    assert "needs more memory than the 1024 MiB" in attacked.refusal(network.encode())


@pytest.mark.parametrize("name", ["", "../x", "..%2Fx", "/etc/x", "a\0b", "x" * 65, "CON.", "ü"])
def test_names(attacked: Attacked, name: str) -> None:
    with attacked.unharmed():
        got = post(attacked.client, TEE.encode(), name=name)
    assert got.status_code == 422


def begun(attacked: Attacked) -> socket.socket:
    """A connection that has sent the begin of a network."""
    url = urlsplit(str(attacked.client.base_url))
    connection = socket.create_connection((url.hostname, url.port), timeout=60)
    connection.sendall(
        f"POST {NETWORKS}?name=attack&format=sumo HTTP/1.1\r\nHost: localhost\r\n"
        f"Content-Type: application/xml\r\nContent-Length: {32 << 20}\r\n\r\n".encode()
        + TEE.encode()
    )
    return connection


def wait_for(holds: Callable[[], object]) -> None:
    deadline = time.monotonic() + 60.0
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.05)


@pytest.mark.slow(seconds=20)
def test_clients_that_leave_or_stop(attacked: Attacked) -> None:
    def is_receiving() -> bool:
        return any(attacked.networks.glob(".*/source"))

    with attacked.unharmed():
        for _ in range(5):
            with begun(attacked):
                wait_for(is_receiving)
            wait_for(lambda: not is_receiving())
        # It has sent much, and then nothing: it is not waited for as long as it was fast.
        with begun(attacked) as connection:
            connection.sendall(b" " * (16 << 20))
            wait_for(is_receiving)
            refused = post(attacked.client, TEE.encode(), name="other")
            assert refused.status_code == 429
            assert answer(connection)[0] == 408
        wait_for(lambda: not is_receiving())


def test_many_uploads_at_once(attacked: Attacked) -> None:
    statuses: list[int] = []

    def upload(number: int) -> None:
        with httpx.Client(base_url=attacked.client.base_url, timeout=120) as client:
            statuses.append(post(client, many_lanes(5000), name=f"many-{number}").status_code)

    threads = [threading.Thread(target=upload, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(statuses) == {201, 429}
    made = [path.name for path in attacked.networks.iterdir() if path.name.startswith("many-")]
    assert len(made) == statuses.count(201)
    assert list(attacked.networks.glob(".*")) == []


def test_runs_go_on_while_networks_are_uploaded(attacked: Attacked) -> None:
    client = attacked.client
    posted = client.post("/api/v1/batches", json=[SCENARIO] * 12).json()["batch"]["id"]
    bombs = [(LAUGHS, 422), ("", 201)] * 3
    for number, (declared, status) in enumerate(bombs):
        head = f"<!DOCTYPE net [{declared}]>" if declared else ""
        body = TEE[TEE.index("<net") :]
        got = post(client, f"{head}{body}".encode(), name=f"beside-{number}")
        assert got.status_code == status, got.text
    wait_for(lambda: client.get(f"/api/v1/batches/{posted}").json()["done"])
    assert client.get(f"/api/v1/batches/{posted}").json()["counts"] == {"finished": 12}
    # Workers find the new networks.
    on_new = {**SCENARIO, "map_region": {"town": "beside-1"}}
    job = client.post("/api/v1/jobs", json=on_new).json()["id"]
    wait_for(lambda: client.get(f"/api/v1/jobs/{job}").json()["status"] == "finished")


def test_a_service_that_was_killed_leaves_nothing_for_long(tmp_path: Path) -> None:
    with (
        killed_service(tmp_path) as (service, url),
        httpx.Client(base_url=url, timeout=60) as client,
    ):
        assert service.process.pid is not None
        killed = Attacked(client=client, pid=service.process.pid, networks=tmp_path / "networks")
        with begun(killed):
            wait_for(lambda: any(killed.networks.glob(".*/source")))
            service.kill()
    assert list(killed.networks.glob(".*"))
    with killed_service(tmp_path):
        assert list(killed.networks.iterdir()) == []


def test_a_service_that_is_stopped_does_not_wait_for_an_import(tmp_path: Path) -> None:
    pytest.importorskip("sumo")
    networks = tmp_path / "networks"
    answers: list[httpx.Response] = []

    def upload(url: str) -> None:
        with httpx.Client(base_url=url, timeout=60) as client:
            answers.append(post(client, SOURCES[ENDLESS].make(), form="openstreetmap"))

    with killed_service(tmp_path) as (service, url):
        uploading = threading.Thread(target=upload, args=(url,))
        uploading.start()
        wait_for(lambda: any(networks.glob(".*/source.xml")))
        (stage,) = networks.glob(".*")
        service.send_signal(signal.SIGTERM)
        assert service.wait(20.0) == 0
        uploading.join()
    assert answers[0].status_code == 503
    assert "the service is being stopped" in detail(answers[0])
    assert list(networks.iterdir()) == []
    assert processes_in(stage) == []
    assert "Traceback" not in (tmp_path / "service.log").read_text()
