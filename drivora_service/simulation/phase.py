"""What a worker is doing, as one integer that can be read from outside."""

from __future__ import annotations

from enum import IntEnum

SETTING_UP = -1
"""The step that is shown while an agent sets up: a call of its own, with a deadline of its own."""


class RunPhase(IntEnum):
    """What a worker is doing."""

    IDLE = 0
    PREPARING = 1
    SIMULATING = 2
    IN_AGENT = 3
    JUDGING = 4
