"""Requests that wait for their clients: few of one client, and few in all."""

from __future__ import annotations

import asyncio
import ipaddress
from collections.abc import Callable, Iterator
from contextlib import contextmanager

MOST_OF_A_CLIENT = 64
"""Waiting at the same moment, not open at the same time: a client that sends does not wait."""
MOST_OF_ALL = 256


def client_key(client: tuple[str, int] | None) -> str:
    """Returns what stands for a client: its address; of IPv6 the network that one customer has."""
    if client is None:
        return ""
    try:
        address = ipaddress.ip_address(client[0])
    except ValueError:
        return client[0]
    if isinstance(address, ipaddress.IPv6Address):
        if address.ipv4_mapped is not None:
            return str(address.ipv4_mapped)
        return str(ipaddress.ip_network((address, 64), strict=False))
    return str(address)


class ClientWaits:
    """Bounds how many requests wait for their clients, by giving up those that wait longest.

    So a client that opens many requests and completes none loses its own, and a request whose bytes
    come is served, whatever others hold open. What does not wait when the event loop has its next
    turn, as a small body that came with its head, is not counted.
    """

    def __init__(
        self, *, most_of_a_client: int = MOST_OF_A_CLIENT, most: int = MOST_OF_ALL
    ) -> None:
        """Creates the bound.

        Args:
            most_of_a_client: Requests of one client.
            most: Requests of all clients.
        """
        self._most_of_a_client, self._most = most_of_a_client, most
        # The first of a client has waited longest.
        self._waiting: dict[str, dict[object, Callable[[], None]]] = {}
        self._count = 0

    @contextmanager
    def wait(self, client: str, give_up: Callable[[], None]) -> Iterator[None]:
        """Counts a wait for a client while the context lasts.

        Args:
            client: The client, see :func:`client_key`.
            give_up: Ends the wait; called at most once.
        """
        end = self.begin(client, give_up)
        try:
            yield
        finally:
            end()

    def begin(self, client: str, give_up: Callable[[], None]) -> Callable[[], None]:
        """Counts a wait as :meth:`wait` does, until the function that is returned is called."""
        token = object()
        entering = asyncio.get_running_loop().call_soon(self._enter, client, token, give_up)

        def end() -> None:
            entering.cancel()
            self._leave(client, token)

        return end

    def _enter(self, client: str, token: object, give_up: Callable[[], None]) -> None:
        own = self._waiting.setdefault(client, {})
        own[token] = give_up
        self._count += 1
        if len(own) > self._most_of_a_client:
            self._give_up_first(client)
        elif self._count > self._most:
            self._give_up_first(max(self._waiting, key=lambda one: len(self._waiting[one])))

    def _give_up_first(self, client: str) -> None:
        token, give_up = next(iter(self._waiting[client].items()))
        self._leave(client, token)
        give_up()

    def _leave(self, client: str, token: object) -> None:
        own = self._waiting.get(client)
        if own is not None and own.pop(token, None) is not None:
            self._count -= 1
            if not own:
                del self._waiting[client]
