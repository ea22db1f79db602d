from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from drivora_service.api.guards.host_names import is_origin_of, read_host

LOCAL = ("localhost", "127.0.0.1", "[::1]")

HOSTILE = (
    "evil.com@localhost",
    "localhost:80@evil.com",
    "localhost:80@evil",
    "user:pass@127.0.0.1:8000",
    "localhost.evil.com",
    "localhost.evil.com:8000",
    "evil.com:127.0.0.1",
    "127.0.0.1.evil.com",
    "127.0.0.1.nip.io",
    "evil.com#localhost",
    "evil.com/localhost",
    "localhost/",
    "localhost?",
    "localhost#",
    "localhost\\evil.com",
    "localhost,evil.com",
    "localhost evil.com",
    " localhost",
    "localhost ",
    "localhost\t",
    "localhost\x00",
    "localhost%00.evil.com",
    "%6cocalhost",
    "localhost.",
    "localhost..",
    ".localhost",
    "evil.localhost",
    "-localhost",
    "localhost:",
    "localhost:-1",
    "localhost:+80",
    "localhost:80:80",
    "localhost:65536",
    "localhost:999999",
    "localhost:8o",
    "localhost:\u0668\u0660",
    "\u217docalhost",
    "loc\u0430lhost",
    "\u212aocalhost",
    "127.1",
    "127.0.1",
    "2130706433",
    "0x7f000001",
    "0x7f.0.0.1",
    "0177.0.0.1",
    "017700000001",
    "127.0.0.01",
    "127.0.0.1.",
    "127.0.0.256",
    "127.0.0.1.1",
    "127.0.0.0x1",
    "0.0.0.0",
    "0",
    "10.0.0.1",
    "192.168.1.1:8000",
    "::1",
    "::1:8000",
    "[::1",
    "::1]",
    "[::1].evil.com",
    "[::1]evil",
    "[::1]@evil.com",
    "evil.com@[::1]",
    "[::1%25lo]",
    "[::1%lo]",
    "[::]",
    "[::ffff:127.0.0.1]",
    "[::ffff:7f00:1]",
    "[::127.0.0.1]",
    "[fe80::1]",
    "[localhost]",
    "[127.0.0.1]",
    "[]",
    "[[::1]]",
    "[v1.localhost]",
    "http://localhost",
    "//localhost",
    "",
    ":",
    ":80",
    "*",
    "a" * 64 + ".example",
    ".".join(["a" * 60] * 5),
)


@pytest.mark.parametrize("header", HOSTILE)
def test_hostile_hosts_are_not_this_machine(header: str) -> None:
    found = read_host(header)
    assert found is None or not found.is_local
    for local in LOCAL:
        assert not is_origin_of(f"http://{header}", local)
        assert not is_origin_of(f"http://{local}", header)


@pytest.mark.parametrize(
    "header",
    [
        "localhost",
        "LOCALHOST",
        "LocalHost:8000",
        "127.0.0.1",
        "127.0.0.1:1",
        "127.0.0.2:8000",
        "[::1]",
        "[::1]:65535",
        "[0:0:0:0:0:0:0:1]",
        "[0000::0001]:80",
        "[::0.0.0.1]",
    ],
)
def test_names_of_this_machine(header: str) -> None:
    found = read_host(header)
    assert found is not None
    assert found.is_local


@pytest.mark.parametrize("header", ["server-1:8000", "drivora_server", "xn--bcher-kva.example:443"])
def test_names_of_others_are_hosts(header: str) -> None:
    found = read_host(header)
    assert found is not None
    assert not found.is_local


@pytest.mark.parametrize(
    ("origin", "host", "expected"),
    [
        ("http://localhost:8000", "localhost:8000", True),
        ("http://LOCALHOST:8000", "localhost:8000", True),
        ("http://localhost", "localhost:80", True),
        ("https://drivora.example", "drivora.example", True),
        ("https://drivora.example", "drivora.example:443", True),
        ("https://drivora.example:443", "drivora.example", True),
        ("http://[::1]:8000", "[0:0::1]:8000", True),
        ("http://localhost:8001", "localhost:8000", False),
        ("http://localhost", "localhost:8000", False),
        ("http://127.0.0.1:8000", "localhost:8000", False),
        ("http://localhost.:8000", "localhost:8000", False),
        ("http://localhost:8000/", "localhost:8000", False),
        ("http://evil.com@localhost:8000", "localhost:8000", False),
        ("http://localhost:8000@evil.com", "localhost:8000", False),
        ("http://localhost:8000, http://evil.com", "localhost:8000", False),
        ("localhost:8000", "localhost:8000", False),
        ("//localhost:8000", "localhost:8000", False),
        ("file://localhost", "localhost", False),
        ("chrome-extension://localhost:8000", "localhost:8000", False),
        ("null", "localhost:8000", False),
        ("", "", False),
    ],
)
def test_origins_of_a_service(origin: str, host: str, expected: bool) -> None:
    assert is_origin_of(origin, host) is expected


@example("0", "127.0.0.1", 9)
@example(":80", "[::1]", 5)
@given(st.text(min_size=1, max_size=6), st.sampled_from(LOCAL), st.integers(0, 22))
def test_a_local_host_with_anything_more_is_not_one(more: str, local: str, at: int) -> None:
    at = min(at, len(local))
    header = local[:at] + more + local[at:]
    found = read_host(header)
    if found is not None and found.is_local:
        # All that may come in is a port, or a digit of an address.
        has_port = ":" in header and not header.endswith("]")
        host, port = header.rsplit(":", 1) if has_port else (header, "")
        assert set(more) <= set("0123456789:.")
        assert not port or port.isdecimal()
        assert host.lower().startswith(("localhost", "127.", "["))


@given(st.text(max_size=40))
def test_every_text_is_read(header: str) -> None:
    found = read_host(header)
    if found is not None:
        again = read_host(header.upper().lower())
        assert again == found
