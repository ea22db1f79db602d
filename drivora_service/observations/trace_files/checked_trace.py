"""Reading the trace of a stored run: only if it is the one whose hash is stored.

A file may be damaged or exchanged for that of another run. What is read from it, or sent, would
then be shown under the verdicts of a run that drove otherwise.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.observations.trace import Trace
from drivora_service.observations.trace_files.stored_trace import (
    StoredTrace,
    find_file,
    make_damage_error,
    make_missing_error,
)
from drivora_service.observations.trace_files.trace_file import DAMAGE, read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256

MOST_KNOWN = 4096
"""Files that are known to have the expected hash."""


@dataclass(frozen=True, slots=True)
class _Known:
    """A file in one state, with the hash that it has then.

    The time of change, unlike that of modification, cannot be set to an earlier one.
    """

    path: Path
    inode: int
    size: int
    modified_ns: int
    changed_ns: int
    sha256: str


class _KnownFiles:
    """The files that were checked last; used by several threads."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._files: OrderedDict[_Known, None] = OrderedDict()
        self._access = threading.Lock()

    def has(self, file: _Known) -> bool:
        with self._access:
            if file not in self._files:
                return False
            self._files.move_to_end(file)
            return True

    def add(self, file: _Known) -> None:
        with self._access:
            self._files[file] = None
            while len(self._files) > self._most:
                self._files.popitem(last=False)


_known_files = _KnownFiles(MOST_KNOWN)


def check_trace(stored: StoredTrace) -> None:
    """Checks that a file is the trace that was recorded; one that did not change is read once.

    Raises:
        TraceDamaged: It is another trace, cannot be read, or is missing.
    """
    state = _state_of(stored)
    if not _known_files.has(state):
        _read(stored, state)


def read_checked_trace(stored: StoredTrace) -> Trace:
    """Reads a trace, and checks that it is the one that was recorded.

    Raises:
        TraceDamaged: It is another trace, cannot be read, or is missing.
    """
    return _read(stored, _state_of(stored))


def _read(stored: StoredTrace, state: _Known) -> Trace:
    try:
        trace = read_trace(stored.path)
        found = "" if _known_files.has(state) else trace_sha256(trace)
    except (StoreError, *DAMAGE) as error:
        # What it was raised from, without another advice on what to do.
        reason = error.__cause__ or error
        raise make_damage_error(
            stored,
            "trace_unreadable",
            f"cannot be read ({reason}); a trace with the hash {stored.sha256} was recorded"
            f"{_written(state)}",
        ) from error
    if found:
        if found != stored.sha256:
            raise make_damage_error(
                stored,
                "trace_differs",
                f"is damaged or of another run: it has the hash {found}, and a trace with the hash "
                f"{stored.sha256} was recorded{_written(state)}",
            )
        # Its state is that from before it was read: if it changed meanwhile, it is read again.
        _known_files.add(state)
    return trace


def _state_of(stored: StoredTrace) -> _Known:
    there = find_file(stored.path)
    if there.is_missing:
        raise make_missing_error(stored)
    found = there.state
    if found is None:
        what = f"{there.fault}; a trace with the hash {stored.sha256} was recorded"
        raise make_damage_error(stored, "trace_unreadable", what)
    return _Known(
        path=stored.path,
        inode=found.st_ino,
        size=found.st_size,
        modified_ns=found.st_mtime_ns,
        changed_ns=found.st_ctime_ns,
        sha256=stored.sha256,
    )


def _written(state: _Known) -> str:
    written = datetime.fromtimestamp(state.modified_ns / 1e9, UTC)
    return f". The file was last written at {written:%Y-%m-%d %H:%M:%S} UTC"
