"""The socket of a server: taking its address, and who has it otherwise."""

from __future__ import annotations

import contextlib
import errno
import http.client
import json
import socket
from collections.abc import Iterator
from pathlib import Path

from drivora_service.errors import AddressTaken, ConfigurationError

_ASK_S = 1.0
"""Seconds within which a server that has the address must say what it is."""

_LISTENS = "0A"
"""State of listening sockets in ``/proc/net/tcp``."""

_SYSTEM_PORTS = 1024
"""Ports below this one are for processes with the right to use them."""


def bind_address(host: str, port: int) -> socket.socket:
    """Returns a socket that has an address; it does not listen yet.

    Args:
        host: Name or address of an interface.
        port: Port; 0: a free one.

    Raises:
        AddressTaken: Another process has the address; the message says which, as far as that can be
            known.
        ConfigurationError: The address cannot be used here.
    """
    try:
        family, kind, _, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except OSError as error:
        raise ConfigurationError(
            f"--host {host}: {error.strerror or error}; name an address of this machine, such as "
            "127.0.0.1"
        ) from error
    listener = socket.socket(family, kind)
    try:
        # Else the port could not be used for a minute after a server with open connections ended.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
    except OSError as error:
        listener.close()
        if error.errno == errno.EADDRINUSE:
            raise _taken_error(host, port) from None
        advice = "choose a port from 1024 with --port or DRIVORA_PORT"
        if error.errno == errno.EADDRNOTAVAIL:
            advice = "name an address of this machine with --host, such as 127.0.0.1"
        elif not 0 < port < _SYSTEM_PORTS:
            advice = "choose another one with --host and --port"
        raise ConfigurationError(
            f"the service cannot listen on port {port} of {host}: {error.strerror}; {advice}"
        ) from None
    return listener


def start_listening(listener: socket.socket, host: str) -> None:
    """Lets clients connect.

    Args:
        listener: A socket of :func:`bind_address`.
        host: As it was given there.

    Raises:
        AddressTaken: Another process has begun to listen on the address meanwhile.
    """
    try:
        listener.listen()
    except OSError as error:
        if error.errno != errno.EADDRINUSE:
            raise
        raise _taken_error(host, listener.getsockname()[1]) from None


def _taken_error(host: str, port: int) -> AddressTaken:
    return AddressTaken(
        f"port {port} of {host} is in use by {_describe_holder(host, port)}; stop it, or choose "
        "another port with --port or DRIVORA_PORT (0: a free one)"
    )


def _describe_holder(host: str, port: int) -> str:
    """Returns what has the address: a Drivora with its version, or another program."""
    process = _find_process(port)
    version = _ask_version(host, port)
    where = f" ({process})" if process else ""
    if version:
        return f"a service of Drivora {version}{where}"
    return f"another program{where}"


def _ask_version(host: str, port: int) -> str:
    """Returns the version of a service of Drivora; "" if the address has another program."""
    ask = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
    connection = http.client.HTTPConnection(ask, port, timeout=_ASK_S)
    # ValueError: what it answers is no JSON, or not that of Drivora.
    with (
        contextlib.suppress(OSError, http.client.HTTPException, ValueError),
        contextlib.closing(connection),
    ):
        connection.request("GET", "/healthz")
        answer = json.loads(connection.getresponse().read(10_000))
        if isinstance(answer, dict) and {"status", "version"} <= answer.keys():
            return str(answer["version"])[:40]
    return ""


def _find_process(port: int) -> str:
    """Returns id and name of the process that listens on a port; "" if that is not visible."""
    inodes = {f"socket:[{inode}]" for inode in _listening(port)}
    for folder in Path("/proc").glob("[0-9]*"):
        # Processes end meanwhile, and those of other users are not readable.
        with contextlib.suppress(OSError):
            if any(str(one.readlink()) in inodes for one in (folder / "fd").iterdir()):
                return f"process {folder.name}, {(folder / 'comm').read_text().strip()}"
    return ""


def _listening(port: int) -> Iterator[str]:
    """Yields the inodes of the sockets that listen on a port."""
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        with contextlib.suppress(OSError):
            for line in Path(table).read_text().splitlines()[1:]:
                columns = line.split()
                if columns[3] == _LISTENS and int(columns[1].rpartition(":")[2], 16) == port:
                    yield columns[9]
