"""Where a worker is in its run, readable from outside while the worker is busy or hung.

The worker writes a few integers into a memory-mapped file; the slot's supervisor reads them. So a
worker that spins in an ADS, even in C code that never lets go of the interpreter, can be told from
one that hangs elsewhere.
"""

from __future__ import annotations

import mmap
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivora_service.simulation.phase import SETTING_UP, Phase

_FIELDS = 4
_LARGEST = 2**31 - 1
"""Largest number that an INTEGER column of the database holds."""
_PHASES = frozenset(int(phase) for phase in Phase)


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """A reading: the phase, the row of the trace, the index of the ego whose agent is called."""

    phase: Phase
    step: int
    ego: int
    run_counter: int

    @property
    def call(self) -> str:
        """Names the call of an agent that goes on, in the phase ``IN_AGENT``."""
        return "setup_env" if self.step == SETTING_UP else f"step {self.step}"


class ProgressBoard:
    """The shared integers.

    Attributes:
        cells: (4,) int64: phase, step, ego, number of the run on this worker. Written directly by
            the step loop, where a method call would cost more than the write.
    """

    def __init__(self, path: Path) -> None:
        """Maps ``path``, making it if it does not exist."""
        size = _FIELDS * 8
        with path.open("a+b") as file:
            file.truncate(size)
            self._map = mmap.mmap(file.fileno(), size)
        self.cells: NDArray[np.int64] = np.frombuffer(self._map, dtype=np.int64)

    def read(self) -> Progress:
        """Returns the current reading: an unknown phase as ``IDLE``, numbers within 31 bits."""
        phase, step, ego, counter = (int(cell) for cell in self.cells)
        return Progress(
            # Code under test can write here: what it writes must not harm the reader.
            phase=Phase(phase) if phase in _PHASES else Phase.IDLE,
            step=_bounded(step),
            ego=_bounded(ego),
            run_counter=_bounded(counter),
        )


def _bounded(value: int) -> int:
    return min(max(value, -_LARGEST), _LARGEST)
