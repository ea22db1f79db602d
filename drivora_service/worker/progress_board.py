"""The progress of a worker in its run, readable from outside while the worker is busy or hung.

The worker writes a few integers into memory that it shares with its slot's supervisor, which reads
them. So a worker that spins in an ADS, even in C code that never releases the interpreter lock, can
be told from one that hangs elsewhere. A note of any length follows them, which the supervisor reads
after the run, even if the worker has died: a message would wake it during each run.

Code under test can write to the memory, too, and resize it. So the supervisor reads it as a file
and does not map it: at any size, a read is short at most. It has no name in any folder.
"""

from __future__ import annotations

import contextlib
import fcntl
import mmap
import os
import struct
import sys
import tempfile
import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.simulation.run_phase import SETTING_UP, BoardCell, RunPhase

_CELLS = struct.Struct(f"={len(BoardCell)}q")
"""All of ``BoardCell``, as on the board."""
_PHASE = struct.Struct("=q")
"""The first cell alone."""
_NOTE = struct.Struct("=Q")
_NOTE_AT = _CELLS.size
_USUAL_NOTE = 1 << 14
"""Bytes that are read of a note at first."""
_LARGEST = 2**31 - 1
"""Largest number that an INTEGER column of the database holds."""
_PHASES = {int(phase): phase for phase in RunPhase}


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """A reading.

    Attributes:
        phase: Phase of the worker.
        step: Row of the trace.
        ego: Index of the ego whose agent is called.
        run_counter: Number of runs that the worker has started.
        in_process: Whether an agent of the run lives in the worker process.
    """

    phase: RunPhase
    step: int
    ego: int
    run_counter: int
    in_process: bool = False

    @property
    def call(self) -> str:
        """The name of the current call of an agent, in the phase ``IN_AGENT``."""
        return "setup_env" if self.step == SETTING_UP else f"step {self.step}"


NO_PROGRESS = Progress(phase=RunPhase.IDLE, step=0, ego=0, run_counter=0)
"""The reading of an empty board."""


class ProgressBoard:
    """The worker's side of the shared integers.

    Attributes:
        cells: (5,) int64, columns ``BoardCell``. Written directly by the step loop, where a method
            call would cost more than the write.
    """

    def __init__(self, file: int) -> None:
        """Maps the file that a :class:`BoardReader` has made.

        Args:
            file: Its descriptor, which may be closed afterwards.
        """
        self._file = os.dup(file)
        self._map = mmap.mmap(file, _CELLS.size)
        self.cells: NDArray[np.int64] = np.frombuffer(self._map, dtype=np.int64)

    def leave(self, note: bytes) -> None:
        """Leaves a note for the supervisor, in place of the one before."""
        os.pwrite(self._file, _NOTE.pack(len(note)) + note, _NOTE_AT)


class BoardReader:
    """The supervisor's side of the shared integers. Thread-safe."""

    def __init__(self) -> None:
        """Creates the shared memory, filled with zeros."""
        self._file = _shared_file()
        self._lock = threading.Lock()

    def fileno(self) -> int:
        """Returns the descriptor for the worker."""
        return self._file

    def read(self) -> Progress:
        """Returns the current reading: an unknown phase as ``IDLE``, numbers within 31 bits."""
        with self._lock:
            data = b"" if self._file < 0 else os.pread(self._file, _CELLS.size, 0)
        if len(data) < _CELLS.size:
            return NO_PROGRESS
        cells = _CELLS.unpack(data)
        return Progress(
            phase=_phase(cells[BoardCell.PHASE]),
            step=_clip_number(cells[BoardCell.STEP]),
            ego=_clip_number(cells[BoardCell.EGO]),
            run_counter=_clip_number(cells[BoardCell.RUN]),
            in_process=bool(cells[BoardCell.IN_PROCESS]),
        )

    def phase(self) -> RunPhase:
        """Returns the phase of the current reading."""
        with self._lock:
            data = b"" if self._file < 0 else os.pread(self._file, _PHASE.size, 0)
        return _phase(_PHASE.unpack(data)[0]) if len(data) == _PHASE.size else RunPhase.IDLE

    def note(self, longest: int) -> bytes:
        """Returns the note that the worker has left; "" without one, or if it is too long.

        Args:
            longest: Bytes that a note may have.
        """
        with self._lock:
            if self._file < 0:
                return b""
            # Nearly all notes are shorter, and read at once.
            data = os.pread(self._file, _USUAL_NOTE, _NOTE_AT)
            length = _NOTE.unpack_from(data)[0] if len(data) >= _NOTE.size else 0
            if not 0 < length <= longest:
                return b""
            if _NOTE.size + length > len(data):
                return os.pread(self._file, length, _NOTE_AT + _NOTE.size)
            return data[_NOTE.size : _NOTE.size + length]

    def close(self) -> None:
        """Closes the memory; from now on readings are empty."""
        with self._lock:
            file, self._file = self._file, -1
        if file >= 0:
            os.close(file)


def _phase(value: int) -> RunPhase:
    return _PHASES.get(value, RunPhase.IDLE)


def _clip_number(value: int) -> int:
    return min(max(value, -_LARGEST), _LARGEST)


def _shared_file() -> int:
    """Returns the descriptor of a file for the cells, all 0, that has no name and can grow."""
    if sys.platform != "linux":
        with tempfile.TemporaryFile() as file:
            file.truncate(_CELLS.size)
            return os.dup(file.fileno())
    memory = os.memfd_create("drivora-board", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    try:
        os.ftruncate(memory, _CELLS.size)
        # The reader does not need it, but a worker that truncates its own board would crash.
        with contextlib.suppress(OSError):
            fcntl.fcntl(memory, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_SEAL)
    except BaseException:
        os.close(memory)
        raise
    return memory
