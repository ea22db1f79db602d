from __future__ import annotations

import threading
from collections.abc import Iterator

from drivora_service.execution.supervised import Backoff, SupervisedThread

QUICK = Backoff(first_s=0.001, longest_s=0.002, failures=4)


class Flaky:
    """Raises the given exceptions, one each turn, and then works for a number of turns."""

    def __init__(self, errors: list[Exception]) -> None:
        self.errors: Iterator[Exception] = iter(errors)
        self.worked = threading.Event()
        self.turns = 0

    def turn(self) -> None:
        self.turns += 1
        for error in self.errors:
            raise error
        self.worked.set()
        threading.Event().wait(0.005)


def test_it_goes_on_after_failures() -> None:
    flaky, ended = Flaky([OSError("full"), ValueError("odd"), MemoryError()]), threading.Event()
    thread = SupervisedThread("flaky", flaky.turn, at_end=ended.set, backoff=QUICK)
    thread.start()
    assert flaky.worked.wait(10)
    assert thread.is_alive
    thread.stop()
    assert thread.join(10)
    assert ended.is_set()


def test_it_gives_up_and_says_why_after_too_many_failures_in_a_row() -> None:
    told: list[str] = []
    ended = threading.Event()
    flaky = Flaky([ValueError("odd")] * 100)
    thread = SupervisedThread(
        "flaky", flaky.turn, at_end=ended.set, on_fatal=told.append, backoff=QUICK
    )
    thread.start()
    assert thread.join(10)
    assert flaky.turns == QUICK.failures
    assert ended.is_set()
    (message,) = told
    assert "'flaky' failed 4 times in a row, the last time with ValueError: odd" in message


def test_failures_that_a_known_fault_explains_never_end_it() -> None:
    told: list[str] = []
    flaky = Flaky([OSError("full")] * 30)
    thread = SupervisedThread(
        "flaky", flaky.turn, explained=lambda: True, on_fatal=told.append, backoff=QUICK
    )
    thread.start()
    assert flaky.worked.wait(10)
    thread.stop()
    assert thread.join(10)
    assert told == []


def test_pauses_grow_to_a_limit() -> None:
    backoff = Backoff(first_s=0.5, longest_s=15.0)
    assert [backoff.pause_s(n) for n in (1, 2, 3, 6, 5000)] == [0.5, 1.0, 2.0, 15.0, 15.0]
