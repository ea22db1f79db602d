"""How many runs are to be held ready for the slots."""

from __future__ import annotations

import math

_AHEAD_S = 0.6
_MOST_A_SLOT = 16
_WEIGHT = 0.1


class Pace:
    """Learns how long runs take, and from it how many to hold ready.

    One more than each slot can do is the least. More are held ready if runs are short, enough for
    the time between two transactions; but not more, since an urgent run waits for those.
    """

    def __init__(self, slots: int) -> None:
        self._slots = slots
        self._mean_s: float | None = None

    def note(self, seconds: float) -> None:
        """Learns from a run that took ``seconds``."""
        if self._mean_s is None:
            self._mean_s = seconds
        else:
            self._mean_s += _WEIGHT * (seconds - self._mean_s)

    def wanted_in_flight(self) -> int:
        """Returns how many runs should be running or ready."""
        if self._mean_s is None:
            return 2 * self._slots
        ahead = math.ceil(_AHEAD_S / max(self._mean_s, 1e-3))
        return self._slots * (1 + min(max(ahead, 1), _MOST_A_SLOT))
