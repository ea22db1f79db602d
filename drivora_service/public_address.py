"""Where clients find the service: its public address, and the path that it is under."""

from __future__ import annotations

import re
from urllib.parse import urlsplit

# Characters that no URL has to escape, so that the path is the same in every place it is written.
_PART = re.compile(r"[A-Za-z0-9][A-Za-z0-9._~-]*")
_SCHEMES = ("http", "https")
# Blanks and control characters are skipped by `urlsplit`, and so is the mark of an empty query.
_NO_ADDRESS = re.compile(r"[\s\x00-\x1f\x7f?#\\]")

OWN_NAMES = frozenset(
    {
        *("api", "docs", "assets", "help", "healthz", "readyz", "metrics", "icon.svg"),
        *("campaigns", "compare", "studies", "runs", "batches", "failures", "minimizations"),
        *("suites", "author", "networks", "agents", "workers", "session"),
    }
)
"""First parts of the service's own paths. With one of them as root path, a path would have two
meanings: that of a proxy that takes the root path off, and that of one that does not."""


def read_root_path(given: str) -> str:
    """Returns a root path without the slash at its end; "" for the root of the host.

    Raises:
        ValueError: It cannot be used as one.
    """
    path = given.rstrip("/")
    if not path:
        return ""
    first, *parts = path.split("/")
    if first or not all(_PART.fullmatch(part) for part in parts):
        raise ValueError(
            "a path starts with a slash; its parts have letters, digits and the characters . _ ~ - "
            "and start with a letter or digit, such as /drivora or /tools/drivora"
        )
    if parts[0] in OWN_NAMES:
        raise ValueError(f"/{parts[0]} is a path of the service itself; take another one")
    return path


def read_public_url(given: str) -> str:
    """Returns a public address without the slash at its end, its scheme in lower case.

    Raises:
        ValueError: It cannot be used as one.
    """
    if not given:
        return ""
    try:
        url = urlsplit(given)
        is_address = url.scheme in _SCHEMES and bool(url.hostname) and url.port != 0
    except ValueError:
        # Its port is no number, or its host no address in brackets.
        is_address = False
    if not is_address or _NO_ADDRESS.search(given):
        raise ValueError("an address is http:// or https://, a host and a path, without ? and #")
    read_root_path(url.path)
    return f"{url.scheme}{given[len(url.scheme) :]}".rstrip("/")


def path_of(public_url: str) -> str:
    """Returns the path of a public address that was read; "" for the root of the host."""
    return urlsplit(public_url).path
