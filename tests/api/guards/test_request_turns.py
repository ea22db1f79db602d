from __future__ import annotations

import asyncio

import pytest

from drivora_service.api.guards.request_turns import Turns, urgent_requests


def test_a_turn_of_the_loop_begins_a_few_and_all_in_their_order() -> None:
    turns = Turns(most=4)
    begun: list[int] = []

    async def scene() -> list[int]:
        sizes = []
        for number in range(10):
            turns.begin(lambda number=number: begun.append(number))  # type: ignore[misc]  # a default binds the number
        while len(begun) < 12:
            sizes.append(len(begun))
            if len(begun) == 4:
                # Later requests wait behind those that wait already.
                turns.begin(lambda: begun.append(10))
                turns.begin(lambda: begun.append(11))
            await asyncio.sleep(0)
        return sizes

    assert asyncio.run(scene()) == [4, 8]
    assert begun == list(range(12))


def test_one_that_fails_keeps_no_other_from_its_turn() -> None:
    turns = Turns(most=1)
    begun: list[str] = []

    def fail() -> None:
        raise ValueError("on purpose")

    async def scene() -> None:
        asyncio.get_running_loop().set_exception_handler(lambda *_: None)
        turns.begin(lambda: begun.append("first"))
        turns.begin(fail)
        turns.begin(lambda: begun.append("last"))
        for _ in range(5):
            await asyncio.sleep(0)

    asyncio.run(scene())
    assert begun == ["first", "last"]
    # A loop that has ended keeps those of the next one from nothing.
    asyncio.run(scene())
    assert begun == ["first", "last"] * 2


@pytest.mark.parametrize(
    ("request_line", "urgent"),
    [
        (b"GET /healthz HTTP/1.1\r\n", True),
        (b"HEAD /api/v1/readyz HTTP/1.1\r\n", True),
        (b"GET /api/v1/jobs HTTP/1.1\r\n", False),
        (b"POST /healthz HTTP/1.1\r\n", False),
        (b"GET", False),
    ],
)
def test_questions_about_health_are_urgent(request_line: bytes, urgent: bool) -> None:
    assert request_line.startswith(urgent_requests()) is urgent
    assert request_line.startswith(urgent_requests("/drivora")) is urgent
    below = request_line.replace(b" /", b" /drivora/")
    assert below.startswith(urgent_requests("/drivora")) is urgent
    assert not below.startswith(urgent_requests())
