"""What a worker is doing, as one integer that can be read from outside."""

from __future__ import annotations

from enum import IntEnum


class Phase(IntEnum):
    """What a worker is doing."""

    IDLE = 0
    PREPARING = 1
    SIMULATING = 2
    IN_AGENT = 3
    JUDGING = 4
