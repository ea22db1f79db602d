"""The system's data on processes: state, processor time, memory, descendants.

On Linux a reading takes two small files. Elsewhere psutil is used, which is slower.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import psutil

_LINUX = sys.platform == "linux"
_TICK_S = 1.0 / os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")
_CHUNK = 4096
_STOPPED = {psutil.STATUS_STOPPED: "T", psutil.STATUS_RUNNING: "R", psutil.STATUS_ZOMBIE: "Z"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessReading:
    """A process at one moment.

    Attributes:
        state: As in ``proc(5)``: R runs or could, S sleeps, D waits for a disk, T was stopped, Z
            has ended.
        cpu_s: Processor time of all its threads, seconds.
        memory_bytes: Resident memory.
        started: Start time in a unit of the system: with the process id, a unique identity of the
            process.
        name: Name of its program.
    """

    state: str
    cpu_s: float
    memory_bytes: int
    started: float
    name: str


def read_process(pid: int) -> ProcessReading | None:
    """Reads the state of a process; ``None`` if there is none."""
    if not _LINUX:
        return _ask_psutil(pid)
    try:
        text = _read(f"/proc/{pid}/stat").decode(errors="replace")
    except OSError:
        return None
    # The name may contain any characters, brackets and spaces too.
    name, _, rest = text.partition("(")[2].rpartition(")")
    fields = rest.split()
    return ProcessReading(
        state=fields[0],
        cpu_s=_TICK_S * (int(fields[11]) + int(fields[12])),
        memory_bytes=_PAGE * int(fields[21]),
        started=float(fields[19]),
        name=name,
    )


def _ask_psutil(pid: int) -> ProcessReading | None:
    try:
        process = psutil.Process(pid)
        with process.oneshot():
            times = process.cpu_times()
            return ProcessReading(
                state=_STOPPED.get(process.status(), "S"),
                cpu_s=times.user + times.system,
                memory_bytes=process.memory_info().rss,
                started=process.create_time(),
                name=process.name(),
            )
    except psutil.Error:
        return None


def _read(path: str) -> bytes:
    """Reads a small file of ``/proc``; a slot does so many times a second."""
    file = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        found = b""
        while more := os.read(file, _CHUNK):
            found += more
        return found
    finally:
        os.close(file)


def read_last_pid() -> int | None:
    """Returns a number that changes when any process or thread starts; ``None`` if unknown.

    It takes a microsecond, where a look at the children of two processes takes a hundred.
    """
    file = _last_pid_file()
    if file is None:
        return None
    try:
        return int(os.pread(file, _CHUNK, 0))
    except (OSError, ValueError):
        return None


@cache
def _last_pid_file() -> int | None:
    """Opens the system's last process id, which stays open; ``None`` if it does not tell it.

    ``/proc/loadavg`` has it, too, but containers replace that file by one that is refreshed late.
    """
    try:
        return os.open("/proc/sys/kernel/ns_last_pid", os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return None


def children_of(pid: int) -> list[int]:
    """Returns the children of a process, without listing all processes where possible."""
    listed = list_children(pid)
    if listed is not None:
        return listed
    try:
        return [child.pid for child in psutil.Process(pid).children()]
    except (OSError, psutil.Error):
        return []


def list_children(pid: int) -> list[int] | None:
    """Returns the children of a process; ``None`` if it has ended or the system lists none."""
    if not _LINUX:
        return None
    found: list[int] = []
    is_listed = False
    try:
        with os.scandir(f"/proc/{pid}/task") as tasks:
            for task in tasks:
                with contextlib.suppress(FileNotFoundError, ProcessLookupError):
                    found += map(int, _read(f"{task.path}/children").split())
                    is_listed = True
    except OSError:
        return None
    return found if is_listed else None


def descendants_of(pid: int, *, spare: Callable[[int], bool]) -> list[int]:
    """Returns the children of a process, their children, and so on.

    Args:
        pid: The process.
        spare: Whether to leave a process out, with its own descendants.
    """
    found: dict[int, None] = {}
    coming = children_of(pid)
    while coming:
        child = coming.pop()
        if child not in found and not spare(child):
            found[child] = None
            coming += children_of(child)
    return list(found)


def proportional_memory(pids: Iterable[int]) -> int:
    """Returns the bytes of memory of some processes, pages that several share counted once.

    It takes milliseconds for each; where the system does not tell, resident memory counts.
    """
    total = 0
    for pid in pids:
        try:
            text = Path(f"/proc/{pid}/smaps_rollup").read_text()
            total += next(
                1024 * int(line.split()[1]) for line in text.splitlines() if line.startswith("Pss:")
            )
        except (OSError, StopIteration):
            reading = read_process(pid)
            total += 0 if reading is None else reading.memory_bytes
    return total


class ProcessHandle:
    """A process that can be signalled without reaching another that has reused its id."""

    def __init__(self, pid: int) -> None:
        """Opens a process that lives, or has not been reaped."""
        self.pid = pid
        self._file = -1
        with contextlib.suppress(OSError):
            if hasattr(os, "pidfd_open"):
                self._file = os.pidfd_open(pid)
        reading = read_process(pid)
        self._started = None if reading is None else reading.started

    @property
    def lives(self) -> bool:
        """Whether the process has not ended."""
        reading = read_process(self.pid)
        return reading is not None and reading.started == self._started and reading.state != "Z"

    @property
    def is_stopped(self) -> bool:
        """Whether the process was stopped by a signal."""
        reading = read_process(self.pid)
        return reading is not None and reading.state in "Tt" and reading.started == self._started

    def kill(self) -> None:
        """Kills the process, if it still exists."""
        with contextlib.suppress(OSError):
            if self._file >= 0:
                signal.pidfd_send_signal(self._file, signal.SIGKILL)
            elif self.lives:
                os.kill(self.pid, signal.SIGKILL)

    def close(self) -> None:
        """Closes the handle."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
