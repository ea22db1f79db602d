"""The progress of a worker, as integers in shared memory."""

from __future__ import annotations

from enum import IntEnum

SETTING_UP = -1
"""The step that is shown during ``setup_env`` of an agent, which has its own deadline."""


class BoardCell(IntEnum):
    """Cells of a worker's progress in shared memory."""

    PHASE = 0
    """``RunPhase``."""
    STEP = 1
    EGO = 2
    """Row of the ego whose agent is called."""
    RUN = 3
    """Number of the run on this worker."""
    IN_PROCESS = 4
    """1 if an agent of the run is in the worker's process."""


class RunPhase(IntEnum):
    """The phase of a worker."""

    IDLE = 0
    PREPARING = 1
    SIMULATING = 2
    IN_AGENT = 3
    JUDGING = 4
