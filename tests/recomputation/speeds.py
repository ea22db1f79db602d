"""The time for which an ego was faster than the limit of its lane."""

from __future__ import annotations

import numpy as np

from tests.recomputation.recording import Drive, Flags, Floats
from tests.recomputation.town import read_town

EXCESS = 0.05
SECONDS = 3.0


def limits(town: str, drive: Drive) -> Floats:
    """Returns the (n,) speed limit of the lane in each row, m/s; NaN off every lane."""
    lanes = read_town(town).lanes
    return np.array([lanes[name].limit if name else np.nan for name in drive.lanes])


def stretches(flags: Flags) -> list[tuple[int, int]]:
    """Returns first and last row of every run of rows in which a condition holds."""
    found: list[tuple[int, int]] = []
    for k in np.flatnonzero(flags).tolist():
        if found and found[-1][1] == k - 1:
            found[-1] = (found[-1][0], k)
        else:
            found.append((k, k))
    return found


def speeding(town: str, drive: Drive, step_length: float) -> list[tuple[int, float]]:
    """Returns step and duration in seconds of every time that the ego was too fast for too long."""
    with np.errstate(invalid="ignore"):
        over = drive.speed - limits(town, drive) > EXCESS * limits(town, drive)
    return [
        (drive.first + first, (last - first) * step_length)
        for first, last in stretches(over)
        if (last - first) * step_length >= SECONDS - 1e-6
    ]
