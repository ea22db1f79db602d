"""Clients that are many, slow or silent, on real sockets."""

from __future__ import annotations

import asyncio
import contextlib
import json
import resource
import select
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import pytest
import uvicorn

from drivora_service.api.guards import body_limit, client_connections
from drivora_service.api.guards.client_connections import (
    BoundedConnection,
    HeldFlow,
    raise_descriptor_limit,
)
from drivora_service.api.guards.client_waits import ClientWaits
from tests.api.conftest import Offline

HEAD = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"


@dataclass(frozen=True)
class Running:
    """A server that was started."""

    server: uvicorn.Server
    address: tuple[str, int]


@pytest.fixture
def running(offline: Offline, monkeypatch: pytest.MonkeyPatch) -> Iterator[Running]:
    """The application behind bounded connections, four of them."""
    monkeypatch.setattr(BoundedConnection, "most", 4)
    monkeypatch.setattr(BoundedConnection, "most_of_a_client", 1000)
    config = uvicorn.Config(
        offline.app, port=0, log_config=None, lifespan="off", ws="none", http=BoundedConnection
    )
    listener = config.bind_socket()
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    while not server.started:
        time.sleep(0.005)
    yield Running(server, listener.getsockname())
    server.should_exit = True
    thread.join()


@pytest.fixture
def address(running: Running) -> tuple[str, int]:
    return running.address


@contextmanager
def connected(address: tuple[str, int]) -> Iterator[socket.socket]:
    with socket.create_connection(address, timeout=30) as client:
        yield client


def is_cut_off(client: socket.socket) -> bool:
    """Whether the connection ends without a byte of an answer."""
    try:
        return client.recv(1) == b""
    except ConnectionResetError:
        return True


def answer(client: socket.socket) -> tuple[int, bytes, dict[str, object]]:
    """Reads one answer: status, head and the JSON of the body."""
    data = b""
    while b"\r\n\r\n" not in data:
        if not (more := client.recv(65536)):
            raise EOFError(data)
        data += more
    head, _, body = data.partition(b"\r\n\r\n")
    fields = dict(line.lower().split(b": ", 1) for line in head.split(b"\r\n")[1:])
    length = int(fields[b"content-length"])
    while len(body) < length:
        body += client.recv(65536)
    return int(head.split()[1]), head.lower(), json.loads(body[:length])


def test_a_head_that_never_ends_is_given_up(
    address: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client_connections, "HEAD_SECONDS", 0.3)
    for beginning in (b"", HEAD[:10], HEAD[:-2]):
        with connected(address) as client:
            client.sendall(beginning)
            status, head, body = answer(client)
            assert (status, body["status"]) == (408, 408)
            assert b"application/problem+json" in head
            assert client.recv(1) == b""


def test_bytes_in_drops_do_not_prolong_the_wait(
    address: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client_connections, "HEAD_SECONDS", 0.5)
    with connected(address) as client:
        client.sendall(HEAD)
        assert answer(client)[0] == 200
        sent = 0
        while not select.select([client], [], [], 0.05)[0]:
            client.sendall(HEAD[sent : sent + 1])
            sent += 1
            assert sent < len(HEAD) - 1
        assert answer(client)[0] == 408


def test_a_body_that_never_ends_is_given_up(
    address: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(body_limit, "BODY_SECONDS", 0.3)
    monkeypatch.setattr(body_limit, "DRAIN_SECONDS", 0.1)
    start = b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    for rest in (b"Content-Length: 100\r\n\r\n{", b"Transfer-Encoding: chunked\r\n\r\n1\r\n{\r\n"):
        with connected(address) as client:
            client.sendall(start + rest)
            status, head, body = answer(client)
            assert (status, body["status"]) == (408, 408)
            assert b"connection: close" in head
            assert client.recv(1) == b""


def test_a_connection_too_many_is_told_to_come_back(address: tuple[str, int]) -> None:
    clients = [socket.create_connection(address, timeout=30) for _ in range(4)]
    try:
        for client in clients:
            client.sendall(HEAD)
            assert answer(client)[0] == 200
        with connected(address) as late:
            # Beyond an eighth more than are served, none gets an answer at all.
            assert is_cut_off(late)
        clients.pop().close()
        clients.append(socket.create_connection(address, timeout=30))
        clients[-1].sendall(HEAD)
        assert answer(clients[-1])[0] == 200
    finally:
        for client in clients:
            client.close()


def test_a_connection_beyond_those_that_are_served_gets_503(
    address: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BoundedConnection, "most", 8)
    clients = [socket.create_connection(address, timeout=30) for _ in range(9)]
    try:
        statuses = []
        for client in clients:
            client.sendall(HEAD)
            status, head, _ = answer(client)
            statuses.append(status)
            assert (b"retry-after: 1" in head) is (status == 503)
        assert sorted(statuses) == [200] * 8 + [503]
    finally:
        for client in clients:
            client.close()


def test_what_is_no_http_is_refused_as_a_problem(address: tuple[str, int]) -> None:
    for garbage in (b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", b"GET /\r\n\r\n", b"\0" * 100):
        with connected(address) as client:
            client.sendall(garbage)
            status, head, _ = answer(client)
            assert status == 400
            assert b"application/problem+json" in head
            assert client.recv(1) == b""


def test_connections_leave_descriptors_for_the_service() -> None:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (256, before[1]))
        most = raise_descriptor_limit()
        soft = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
        assert soft >= min(65_536, before[1] if before[1] > 0 else 65_536)
        assert 0 < most < soft
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_a_request_that_waits_for_its_turn_is_answered_before_the_connection_ends(
    running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: list[Callable[[], None]] = []
    monkeypatch.setattr(BoundedConnection.turns, "begin", held.append)
    monkeypatch.setattr(client_connections, "HEAD_SECONDS", 0.2)
    head = HEAD.replace(b"/healthz", b"/api/v1/towns")
    with connected(running.address) as client:
        client.sendall(head)
        # The deadline of a head that has come already ends nothing.
        assert select.select([client], [], [], 0.6)[0] == []
        # What follows is not read before.
        client.setblocking(False)
        sent = 0
        with contextlib.suppress(BlockingIOError):
            while sent < 64 << 20:
                sent += client.send(bytes(1 << 16))
        assert sent < 32 << 20
        client.setblocking(True)
        client.settimeout(30)
        held[0]()
        assert answer(client)[0] == 404
    with connected(running.address) as client:
        client.sendall(head)
        while len(held) < 2:
            time.sleep(0.005)
        running.server.should_exit = True
        assert answer(client)[0] == 404
        assert client.recv(1) == b""


POST = b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
MANY = 300
"""More than requests are served at once."""


def counted(of: str, kind: str) -> float:
    """Returns how many clients have left, or were cut off."""
    name = {"left": "during", "cut_off": "reason"}[of]
    value = BoundedConnection.counts.registry.get_sample_value(
        f"drivora_clients_{of}_total", {name: kind}
    )
    assert value is not None
    return value


def wait_for(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30.0
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_many_heads_without_bodies_hold_up_no_one(
    running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BoundedConnection, "most", 2 * MANY)
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(connected(running.address)) for _ in range(MANY)]
        for client in clients:
            client.sendall(POST + b"Content-Length: 100\r\n\r\n")
        # The oldest of them is given up before its time.
        status, head, body = answer(clients[0])
        assert status == 503
        assert b"retry-after: 1" in head
        assert "too many requests without sending their bodies" in str(body["detail"])
        for request in (
            HEAD.replace(b"/healthz", b"/api/v1/jobs"),
            POST + b"Content-Length: 2\r\n\r\n{}",
        ):
            with connected(running.address) as other:
                other.sendall(request)
                assert answer(other)[0] == (200 if request.startswith(b"GET") else 422)


def test_bodies_in_chunks_of_one_byte_hold_up_no_one(
    running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BoundedConnection, "most", 2 * MANY)
    chunks = b"1\r\n \r\n" * 40_000
    ended = threading.Event()

    def send() -> None:
        with contextlib.suppress(OSError), connected(running.address) as client:
            client.sendall(POST + b"Transfer-Encoding: chunked\r\n\r\n")
            while not ended.is_set():
                client.sendall(chunks)

    senders = [threading.Thread(target=send) for _ in range(8)]
    for sender in senders:
        sender.start()
    try:
        time.sleep(0.5)
        begun = time.monotonic()
        for _ in range(3):
            with connected(running.address) as other:
                other.sendall(HEAD)
                assert answer(other)[0] == 200
        # Otherwise the first request waits for eight times forty thousand chunks, and longer than
        # its socket does.
        assert time.monotonic() - begun < 20
    finally:
        ended.set()
        running.server.should_exit = True
        for sender in senders:
            sender.join()


def test_nothing_more_is_taken_while_what_has_come_waits_to_be_read() -> None:
    taken: list[bool] = []

    class Transport(asyncio.Transport):
        def pause_reading(self) -> None:
            taken.append(False)

        def resume_reading(self) -> None:
            taken.append(True)

    flow = HeldFlow(Transport())
    flow.hold()
    # As the application does whenever it waits for a body.
    flow.resume_reading()
    assert taken == [False]
    flow.release()
    assert taken == [False, True]


def test_a_body_in_small_chunks_arrives_as_it_was_sent(address: tuple[str, int]) -> None:
    text = json.dumps({"nothing": "known", "padding": "x" * 20_000}).encode()
    with connected(address) as client:
        client.sendall(
            POST
            + b"Transfer-Encoding: chunked\r\n\r\n"
            + b"".join(b"1\r\n%c\r\n" % byte for byte in text)
            + b"0\r\n\r\n"
            + HEAD
        )
        # Both answers may come at once.
        got = b""
        while got.count(b"HTTP/1.1 ") < 2:
            more = client.recv(65536)
            assert more, got
            got += more
        first, _, second = got.rpartition(b"HTTP/1.1 ")
        assert first.startswith(b"HTTP/1.1 422 ")
        assert b"nothing" in first
        assert second.startswith(b"200 ")


def test_a_client_with_too_many_connections_loses_its_own(
    address: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BoundedConnection, "most", 1000)
    monkeypatch.setattr(BoundedConnection, "most_of_a_client", 3)
    cut_off = counted("cut_off", "connections")
    with contextlib.ExitStack() as stack:
        slow = [stack.enter_context(connected(address)) for _ in range(3)]
        for client in slow:
            # A head that never ends.
            client.sendall(HEAD[:10])
        late = stack.enter_context(connected(address))
        late.sendall(HEAD)
        assert answer(late)[0] == 200
        assert is_cut_off(slow[0])
        slow[1].sendall(HEAD[10:])
        assert answer(slow[1])[0] == 200
    assert counted("cut_off", "connections") == cut_off + 1


def test_a_connection_is_refused_if_all_others_of_its_client_have_a_request(
    address: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BoundedConnection, "most", 1000)
    monkeypatch.setattr(BoundedConnection, "most_of_a_client", 8)
    with contextlib.ExitStack() as stack:
        busy = [stack.enter_context(connected(address)) for _ in range(8)]
        for client in busy:
            client.sendall(POST + b"Content-Length: 2\r\n\r\n{")
        time.sleep(0.2)
        late = stack.enter_context(connected(address))
        late.sendall(HEAD)
        status, head, _ = answer(late)
        assert status == 503
        assert b"retry-after: 1" in head
        for client in busy:
            client.sendall(b"}")
            assert answer(client)[0] == 422


RESET = struct.pack("ii", 1, 0)
"""Of ``SO_LINGER``: the connection is reset when it is closed."""


@pytest.mark.parametrize("resets", [False, True])
@pytest.mark.parametrize(
    ("request_bytes", "during"),
    [
        (POST + b"Content-Length: 100\r\n\r\n{", "request"),
        (POST + b"Transfer-Encoding: chunked\r\n\r\n1\r\n{\r\n", "request"),
        (HEAD.replace(b"/healthz", b"/api/v1/events"), "events"),
    ],
)
def test_a_client_that_leaves_is_counted_and_no_error(
    address: tuple[str, int],
    caplog: pytest.LogCaptureFixture,
    capfd: pytest.CaptureFixture[str],
    request_bytes: bytes,
    during: str,
    resets: bool,
) -> None:
    before = counted("left", during)
    with connected(address) as client:
        client.sendall(request_bytes)
        if during == "events":
            assert client.recv(100).startswith(b"HTTP/1.1 200")
        else:
            # Until the endpoint waits for the rest.
            time.sleep(0.2)
        if resets:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET)
    wait_for(lambda: counted("left", during) == before + 1)
    with connected(address) as client:
        client.sendall(HEAD)
        assert answer(client)[0] == 200
    said = capfd.readouterr()
    assert "Traceback" not in said.out + said.err
    assert [record for record in caplog.records if record.levelname in ("ERROR", "WARNING")] == []


def test_clients_that_take_no_answer_hold_up_no_one(
    running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(BoundedConnection, "most", 2 * MANY)
    monkeypatch.setattr(BoundedConnection, "_stalled", ClientWaits(most_of_a_client=2, most=4))
    page = HEAD.replace(b"/healthz", b"/api/v1/openapi.json")
    cut_off = counted("cut_off", "answers")
    with contextlib.ExitStack() as stack:
        for _ in range(4):
            client = stack.enter_context(connected(running.address))
            # They ask again and again, until the buffers of the sockets are full.
            client.setblocking(False)
            with contextlib.suppress(BlockingIOError):
                client.send(page * 40)
        wait_for(lambda: counted("cut_off", "answers") >= cut_off + 2)
        with connected(running.address) as other:
            other.sendall(HEAD)
            assert answer(other)[0] == 200
