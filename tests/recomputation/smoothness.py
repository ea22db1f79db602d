"""The six signals of an ego's motion, by parabolas fitted to windows, and their bounds.

The windows are those that the reference of the oracle ``discomfort`` states: 0.4 s for signals,
0.75 s for their rates of change, in rows.
"""

from __future__ import annotations

import numpy as np

from tests.recomputation.recording import Drive, Flags, Floats

SIGNAL_SECONDS = 0.4
RATE_SECONDS = 0.75

SEGMENT = 20
"""Rows of a segment of Bench2Drive."""


def fitted(signal: Floats, rows: int, spacing: float, *, rate: bool) -> Floats:
    """Returns value or slope of the parabola that is fitted to the window around each row.

    The middle of an even window lies between two rows: it belongs to the former. Rows less than
    half a window from an end have the parabola of the first or last window.
    """
    times = (np.arange(rows) - 0.5 * (rows - 1)) * spacing
    windows = np.lib.stride_tricks.sliding_window_view(signal, rows)
    square, slope, value = np.polyfit(times, windows.T, 2)
    n, half = len(signal), rows // 2
    # Window and time within it of each row: the middle, but at the ends.
    first = np.clip(np.arange(n) - (rows - 1) // 2, 0, n - rows)
    at = np.zeros(n)
    first[:half], at[:half] = 0, times[:half]
    first[n - half :], at[n - half :] = n - rows, times[rows - half :]
    if rate:
        return np.asarray(slope[first] + 2.0 * square[first] * at)
    return np.asarray(value[first] + slope[first] * at + square[first] * at**2)


def rough_rows(drive: Drive, spacing: float) -> Flags | None:
    """Tells the (n,) rows in which a signal is out of its bounds; ``None`` if it is too short."""
    short, long = round(SIGNAL_SECONDS / spacing), round(RATE_SECONDS / spacing)
    if drive.count < long:
        return None
    forwards = np.exp(-1j * drive.yaw) * (drive.ax + 1j * drive.ay)
    along, across = forwards.real, forwards.imag
    ahead = fitted(along, short, spacing, rate=False)
    out = (ahead < -4.05) | (ahead > 2.40)
    out |= np.abs(fitted(across, short, spacing, rate=False)) > 4.89
    out |= np.abs(fitted(drive.yaw_rate, short, spacing, rate=False)) > 0.95
    out |= np.abs(fitted(drive.yaw_rate, long, spacing, rate=True)) > 1.93
    out |= np.abs(fitted(along, long, spacing, rate=True)) > 4.13
    out |= np.abs(fitted(np.abs(forwards), long, spacing, rate=True)) > 8.37
    return np.asarray(out)


def smooth_share(rough: Flags) -> float:
    """Returns the share of segments without a rough row; a drive shorter than one is one."""
    length = min(SEGMENT, len(rough))
    starts = range(0, len(rough) - length + 1, length)
    return sum(not rough[start : start + length].any() for start in starts) / len(starts)
