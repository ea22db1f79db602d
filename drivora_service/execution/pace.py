"""The number of runs to claim ahead for the slots."""

from __future__ import annotations

import math

_AHEAD_S = 0.8
_MOST_A_SLOT = 16
_WEIGHT = 0.1


class Pace:
    """Estimates the number of runs to claim ahead from the duration of runs.

    At least one run more than there are slots is claimed. Short runs are claimed for the time
    between two transactions, and no more, since an urgent run waits for those.
    """

    def __init__(self) -> None:
        self._mean_s: float | None = None

    def note(self, seconds: float) -> None:
        """Adds a run that took ``seconds`` to the estimate."""
        if self._mean_s is None:
            self._mean_s = seconds
        else:
            self._mean_s += _WEIGHT * (seconds - self._mean_s)

    def target_in_flight(self, slots: int) -> int:
        """Returns how many runs should be running or claimed for so many slots."""
        if self._mean_s is None:
            return 2 * slots
        ahead = math.ceil(_AHEAD_S / max(self._mean_s, 1e-3))
        return slots * (1 + min(max(ahead, 1), _MOST_A_SLOT))
