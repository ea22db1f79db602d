"""The bound on requests that wait for their clients."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

import pytest

from drivora_service.api.guards.client_waits import ClientWaits, client_key


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("127.0.0.1", "127.0.0.2", False),
        ("::ffff:10.0.0.1", "10.0.0.1", True),
        ("2001:db8:1:2::1", "2001:db8:1:2:ffff::9", True),
        ("2001:db8:1:2::1", "2001:db8:1:3::1", False),
        ("unix", "unix", True),
    ],
)
def test_what_is_one_client(one: str, other: str, same: bool) -> None:
    assert (client_key((one, 1)) == client_key((other, 2))) is same


def test_those_that_wait_longest_are_given_up() -> None:
    async def scene() -> list[str]:
        waits = ClientWaits(most_of_a_client=2, most=3)
        given_up: list[str] = []

        def begin(client: str, name: str) -> Callable[[], None]:
            return waits.begin(client, lambda: given_up.append(name))

        # One that ends within the turn of the event loop has not waited.
        begin("a", "short")()
        ends = {name: begin("a", name) for name in ("a1", "a2")}
        await asyncio.sleep(0)
        assert given_up == []
        begin("a", "a3")
        await asyncio.sleep(0)
        assert given_up == ["a1"]
        # The end of what was given up frees nothing more.
        ends["a1"]()
        begin("b", "b1")
        await asyncio.sleep(0)
        assert given_up == ["a1"]
        # Of all too many, the client with the most loses one.
        begin("c", "c1")
        await asyncio.sleep(0)
        assert given_up == ["a1", "a2"]
        return given_up

    asyncio.run(scene())
