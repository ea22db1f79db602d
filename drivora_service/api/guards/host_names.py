"""Strict reading of the ``Host`` and ``Origin`` headers.

A lenient parser finds a host in ``evil.example@localhost``, and another program may find another
one. What is not exactly a name or an address with an optional port (RFC 9110, section 7.2) is none.
"""

from __future__ import annotations

import ipaddress
import re
from dataclasses import dataclass

_AUTHORITY = re.compile(r"(?P<host>\[[0-9a-f:.]+\]|[a-z0-9._-]+)(?::(?P<port>[0-9]{1,5}))?")
_LABEL = re.compile(r"[a-z0-9_]([a-z0-9_-]{0,61}[a-z0-9_])?")
_NUMBER = re.compile(r"[0-9]+|0x[0-9a-f]*")
_MOST_PORT = 65_535
_MOST_NAME = 253
_USUAL_PORTS = {"http": 80, "https": 443}
_LOCAL_NAME = "localhost"
_V6_LOOPBACK = ipaddress.IPv6Address("::1")


@dataclass(frozen=True, slots=True)
class HostPort:
    """A host with its port.

    Attributes:
        host: Name in lower case, or address.
        port: ``None``: not stated.
    """

    host: str | ipaddress.IPv4Address | ipaddress.IPv6Address
    port: int | None

    @property
    def is_local(self) -> bool:
        """Whether the host is this machine, whatever a name server says."""
        match self.host:
            case ipaddress.IPv4Address():
                return self.host.is_loopback
            case ipaddress.IPv6Address():
                # Not ::ffff:127.0.0.1: versions of Python differ on what that is.
                return self.host == _V6_LOOPBACK
            case _:
                return self.host == _LOCAL_NAME


def read_host(header: str) -> HostPort | None:
    """Returns the host that a ``Host`` header names; ``None``: it is no host."""
    found = _AUTHORITY.fullmatch(header.lower()) if header.isascii() else None
    if found is None:
        return None
    port = None if found["port"] is None else int(found["port"])
    host = _read_address_or_name(found["host"])
    if host is None or (port is not None and port > _MOST_PORT):
        return None
    return HostPort(host, port)


def is_origin_of(origin: str, host: str) -> bool:
    """Returns whether an ``Origin`` header is the origin of the service at a ``Host``.

    The scheme is not compared: a proxy may end the encryption.
    """
    scheme, separator, authority = origin.lower().partition("://")
    usual = _USUAL_PORTS.get(scheme)
    theirs, ours = read_host(authority), read_host(host)
    if not separator or usual is None or theirs is None or ours is None:
        return False
    # Without a port, the host has that of the scheme by which the client came.
    return (theirs.host, theirs.port or usual) == (ours.host, ours.port or usual)


def _read_address_or_name(
    host: str,
) -> str | ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    if host.startswith("["):
        try:
            return ipaddress.IPv6Address(host[1:-1])
        except ValueError:
            return None
    labels = host.split(".")
    if _NUMBER.fullmatch(labels[-1]):
        # Browsers read 127.1, 0x7f.1 and 2130706433 as addresses; here only four numbers are one.
        try:
            return ipaddress.IPv4Address(host)
        except ValueError:
            return None
    if labels[-1] == "" and len(labels) > 1:
        # A name from the root, which is another origin than the name without the last dot.
        labels = labels[:-1]
    is_name = len(host) <= _MOST_NAME and all(_LABEL.fullmatch(label) for label in labels)
    return host if is_name else None
