"""What a catalogue lists, a service's or one's own, in the printed form of the HTTP API."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from drivora_service.errors import UnknownName


def entries_of_service(server: str, path: str) -> list[dict[str, Any]]:
    """Asks a service for all that it lists under a path.

    Raises:
        DrivoraError: It cannot be reached, or refuses.
    """
    from drivora_service.cli.client import ServiceClient

    with ServiceClient(server) as client:
        listed: list[dict[str, Any]] = client.get(path)["items"]
        return listed


def entry_named(kind: str, name: str, entries: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Returns the entry of a name.

    Args:
        kind: What is listed, for the message.
        name: Wanted.
        entries: All.

    Raises:
        UnknownName: There is none of that name.
    """
    known = {entry["name"]: entry for entry in entries}
    if name not in known:
        raise UnknownName(kind, name, tuple(known))
    return known[name]
