"""The calls of a tester, and what a campaign says when one of them runs out of memory."""

from __future__ import annotations

import contextlib
import resource
import threading
from collections.abc import Callable, Iterator
from enum import IntEnum

MEMORY_SETTING = "DRIVORA_CAMPAIGN_MEMORY_MB"
"""The setting that limits the memory of a campaign's process."""

_ROOM_BYTES = 64 << 20
"""Memory beyond the limit with which a campaign that has reached it stores its end."""


class TesterCall(IntEnum):
    """Where the code of a tester runs."""

    __test__ = False

    NONE = 0
    """Not at present."""
    MAKE = 1
    ASK = 2
    TELL = 3

    @property
    def words(self) -> str:
        """What the tester is doing, after "when it"."""
        return _WORDS[self]


_WORDS = {
    TesterCall.NONE: "was not called",
    TesterCall.MAKE: "was made",
    TesterCall.ASK: "was asked",
    TesterCall.TELL: "was given results",
}


def limit_memory(limit_bytes: int) -> None:
    """Has this process refuse itself more memory: what needs it raises ``MemoryError``.

    The limit is on the memory that it reserves for data, so that one large request is refused
    before it takes anything.
    """
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    wanted = limit_bytes if most == resource.RLIM_INFINITY else min(limit_bytes, most)
    resource.setrlimit(resource.RLIMIT_DATA, (wanted, most))


class CallMemory:
    """Limits the memory of this process while any of its threads is in a call of a tester.

    For a process that does more than to run one campaign, and starts others, which inherit limits.
    """

    def __init__(self, limit_bytes: int) -> None:
        """Creates the limit, which does not hold yet."""
        self._limit = limit_bytes
        self._calls = 0
        self._lock = threading.Lock()
        self._before = 0

    def on_call(self, call: TesterCall) -> None:
        """Takes the begin of a call, or with ``NONE`` the end of one."""
        with self._lock:
            if call is not TesterCall.NONE:
                self._calls += 1
                if self._calls == 1:
                    self._before, _ = resource.getrlimit(resource.RLIMIT_DATA)
                    limit_memory(self._limit)
            elif self._calls:
                self._calls -= 1
                if not self._calls:
                    _, most = resource.getrlimit(resource.RLIMIT_DATA)
                    resource.setrlimit(resource.RLIMIT_DATA, (self._before, most))


def out_of_memory(call: TesterCall) -> str:
    """Returns the message for a tester that needed more memory than there is.

    Where the memory is limited, also gives the process a little room to store the message.
    """
    limit, most = resource.getrlimit(resource.RLIMIT_DATA)
    where = f"its tester ran out of memory when it {call.words}"
    if limit == resource.RLIM_INFINITY:
        return f"{where}. Choose smaller parameters"
    with contextlib.suppress(ValueError, OSError):
        wanted = limit + _ROOM_BYTES
        raised = wanted if most == resource.RLIM_INFINITY else min(wanted, most)
        resource.setrlimit(resource.RLIMIT_DATA, (raised, most))
    return (
        f"{where}; {limit >> 20} MiB are allowed for a campaign's process. Choose smaller "
        f"parameters, or raise {MEMORY_SETTING} and resume the campaign"
    )


@contextlib.contextmanager
def called(on_call: Callable[[TesterCall], None], call: TesterCall) -> Iterator[None]:
    """Reports the begin and the end of a call."""
    on_call(call)
    try:
        yield
    finally:
        on_call(TesterCall.NONE)
