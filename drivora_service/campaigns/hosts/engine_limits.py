"""The limits of a campaign's process, checked from outside while it runs."""

from __future__ import annotations

import contextlib
import os
import struct
from dataclasses import dataclass
from pathlib import Path

from drivora_service.campaigns.search.tester_calls import MEMORY_SETTING, TesterCall
from drivora_service.execution.own_time import OwnTime
from drivora_service.worker.process_readings import ProcessReading

DEADLINE_SETTING = "DRIVORA_TESTER_DEADLINE_S"
"""The setting that limits the time of a call of a tester."""

_BOARD = struct.Struct("=qq")
_CALLS = {int(call): call for call in TesterCall}


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineLimits:
    """What a campaign's process may use.

    Attributes:
        memory_bytes: Memory of the process with all that it starts.
        call_s: Seconds of the process's own time that one call of a tester may take.
        grace_s: Seconds after a request to pause or cancel until the process, which has not
            followed it, is asked to end (``SIGTERM``).
        end_s: Seconds after that until it is killed.
    """

    memory_bytes: int = 4096 << 20
    call_s: float = 600.0
    grace_s: float = 5.0
    end_s: float = 3.0


class CallBoard:
    """The engine's side of the call of its tester, which its supervisor reads from a file.

    A supervisor must see a call that never releases the interpreter lock, so that it cannot be
    sent when it has taken long; and a message for every call would wake the supervisor each time.
    """

    def __init__(self, path: Path) -> None:
        """Makes the file anew."""
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        self._count = 0
        self.write(TesterCall.NONE)

    def write(self, call: TesterCall) -> None:
        """Writes the call that begins, or ``NONE`` when one ends."""
        self._count += 1
        # On a full disk the limit of time is less exact; a campaign does not fail of that.
        with contextlib.suppress(OSError):
            os.pwrite(self._file, _BOARD.pack(self._count, call), 0)


def read_board(path: Path) -> tuple[int, TesterCall]:
    """Returns the number of calls and ends so far, and the present call; 0 if there is no file."""
    try:
        data = path.read_bytes()[: _BOARD.size]
    except OSError:
        data = b""
    if len(data) < _BOARD.size:
        return 0, TesterCall.NONE
    count, call = _BOARD.unpack(data)
    return count, _CALLS.get(call, TesterCall.NONE)


class EngineWatch:
    """The limits of one process, with the time that its tester has used for the present call."""

    def __init__(self, limits: EngineLimits, *, now: float) -> None:
        """Creates the watch of a process that begins at ``now``, in monotonic seconds."""
        self._limits = limits
        self._time = OwnTime(now=now)
        self._count = 0
        self._in_call = 0.0

    def check(
        self,
        process: ProcessReading | None,
        started_bytes: int,
        board: tuple[int, TesterCall],
        now: float,
    ) -> str:
        """Accounts for a sample.

        Args:
            process: The system's data on the process, ``None`` if unknown.
            started_bytes: Memory of the processes that it has started.
            board: As from :func:`read_board`.
            now: Seconds of the clock.

        Returns:
            The limit that is exceeded, in words; "" for none.
        """
        _, own = self._time.add(process, now)
        count, call = board
        if count != self._count or call is TesterCall.NONE:
            self._count, self._in_call = count, 0.0
        else:
            self._in_call += own
        limits = self._limits
        used = started_bytes + (0 if process is None else process.memory_bytes)
        if used > limits.memory_bytes:
            where = "" if call is TesterCall.NONE else f", when its tester {call.words}"
            return (
                f"its process grew to {-(-used >> 20)} MiB{where}; {limits.memory_bytes >> 20} "
                f"MiB are allowed. Choose smaller parameters, or raise {MEMORY_SETTING} and resume "
                "the campaign"
            )
        if self._in_call > limits.call_s:
            return (
                f"its tester has not come back since it {call.words}; {limits.call_s:g} s are "
                f"allowed for a call. Choose other parameters, or raise {DEADLINE_SETTING} and "
                "resume the campaign"
            )
        return ""
