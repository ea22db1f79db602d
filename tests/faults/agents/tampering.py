"""Agents that turn against the worker that they run in: its channel, its board, its files.

They know nothing of how these are made: they find them in /proc/self and on the stack.
"""

from __future__ import annotations

import contextlib
import ctypes
import fcntl
import os
import pickle
import re
import socket
import stat
import struct
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

from drivora_service.runs.run_report import RunReport, RunStatus
from tests.faults.agents.driving import Hostile, evidence, plugin, workers_folder

_STANDARD = 3
"""Descriptors 0, 1 and 2 are no channel."""


def descriptors(matches: Callable[[int], bool]) -> list[int]:
    """Returns the descriptors of this process whose mode matches."""
    found = []
    for entry in Path("/proc/self/fd").iterdir():
        descriptor = int(entry.name)
        with contextlib.suppress(OSError):
            if descriptor >= _STANDARD and matches(os.fstat(descriptor).st_mode):
                found.append(descriptor)
    return found


def write_into_channels(data: bytes) -> None:
    """Writes into every socket and pipe, and waits for none."""
    for descriptor in descriptors(lambda mode: stat.S_ISSOCK(mode) or stat.S_ISFIFO(mode)):
        with contextlib.suppress(OSError):
            copy = os.dup(descriptor)
            flags = fcntl.fcntl(copy, fcntl.F_GETFL)
            try:
                fcntl.fcntl(copy, fcntl.F_SETFL, flags | os.O_NONBLOCK)
                os.write(copy, data)
            finally:
                fcntl.fcntl(copy, fcntl.F_SETFL, flags)
                os.close(copy)


def framed(message: bytes) -> Iterator[bytes]:
    """Yields a message with each usual way to say how long it is."""
    for form in ("!i", "<I", "!Q", "<Q"):
        yield struct.pack(form, len(message)) + message
    yield message + b"\n"


class MarkerMaker:
    """Makes a file where it is unpickled."""

    def __init__(self, path: str) -> None:
        self._path = path

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str, str]]:
        return open, (self._path, "w")


class Garbage(Hostile):
    """Writes random bytes into the worker's channel."""

    def harm(self) -> None:
        write_into_channels(bytes(range(256)) * 16)


class HalfMessage(Hostile):
    """Writes the length of a message into the worker's channel and never the message."""

    def harm(self) -> None:
        write_into_channels(struct.pack("!i", 5000) + b"half")


class HugeMessage(Hostile):
    """Announces a message of many gigabytes in the worker's channel."""

    def harm(self) -> None:
        write_into_channels(struct.pack("!iQ", -1, 1 << 45) + b"x" * 1000)


class Pickler(Hostile):
    """Writes a pickle into the worker's channel that makes a file where it is unpickled."""

    def harm(self) -> None:
        bomb = pickle.dumps(MarkerMaker(str(evidence() / "unpickled")))
        for message in framed(bomb):
            write_into_channels(message)
        for send in senders():
            with contextlib.suppress(Exception):
                send(MarkerMaker(str(evidence() / "unpickled")))


def senders() -> Iterator[Callable[..., object]]:
    """Yields what anything on the stack sends objects or bytes with."""
    frame: FrameType | None = sys._getframe()
    while frame is not None:
        for value in list(frame.f_locals.values()):
            kind = type(value).__name__.lower()
            if isinstance(value, socket.socket) or "channel" in kind or "connection" in kind:
                for name in ("send", "send_bytes", "sendall"):
                    if callable(method := getattr(value, name, None)):
                        yield method
        frame = frame.f_back


class Forger(Hostile):
    """Reports that another run, which it knows from the outside, is invalid."""

    def harm(self) -> None:
        with contextlib.suppress(OSError):
            target = (evidence() / "target").read_text()
            report = RunReport(run_id=target, status=RunStatus.INVALID)
            for send in senders():
                for message in (report, pickle.dumps(report)):
                    with contextlib.suppress(Exception):
                        send(message)


class Truncater(Hostile):
    """Empties every file and shared memory that it has open, and all in the workers' folder."""

    def harm(self) -> None:
        for descriptor in descriptors(stat.S_ISREG):
            with contextlib.suppress(OSError):
                os.ftruncate(descriptor, 0)
        for path in workers_folder().iterdir():
            with contextlib.suppress(OSError):
                os.truncate(path, 0)


_MAPPING = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) rw.s \S+ \S+ \d+ +(\S.*)$", re.MULTILINE)
_VALUES = (99, -(2**63), 2**63 - 1, 2**62)


class Scribbler(Hostile):
    """Writes an unknown phase and huge numbers into all shared memory, again and again."""

    def harm(self) -> None:
        self._done = False
        for begin, end, path in _MAPPING.findall(Path("/proc/self/maps").read_text()):
            size = int(end, 16) - int(begin, 16)
            if "memfd" in path or path.startswith(str(workers_folder().parent)):
                words = struct.pack(f"<{len(_VALUES)}q", *_VALUES)
                ctypes.memmove(int(begin, 16), words * (size // len(words)), size)


class LogReplacer(Hostile):
    """Puts links to the database in the place of all logs of workers, then dies."""

    def harm(self) -> None:
        folder = workers_folder()
        for log in folder.glob("*.log"):
            with contextlib.suppress(OSError):
                log.unlink()
                log.symlink_to(folder.parent / "drivora.sqlite3")
        os.write(1, b"a line for the log\n" * 1000)
        os._exit(4)


garbage = plugin("garbage", Garbage)
half_message = plugin("half-message", HalfMessage)
huge_message = plugin("huge-message", HugeMessage)
pickler = plugin("pickler", Pickler)
forger = plugin("forger", Forger)
truncater = plugin("truncater", Truncater)
scribbler = plugin("scribbler", Scribbler)
log_replacer = plugin("log-replacer", LogReplacer)
