"""The phase of a worker, as an integer in shared memory."""

from __future__ import annotations

from enum import IntEnum

SETTING_UP = -1
"""The step that is shown during ``setup_env`` of an agent, which has its own deadline."""


class RunPhase(IntEnum):
    """The phase of a worker."""

    IDLE = 0
    PREPARING = 1
    SIMULATING = 2
    IN_AGENT = 3
    JUDGING = 4
