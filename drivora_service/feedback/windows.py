"""Statistics of an ego's motion in windows of time.

After BehAVExplor's BehaviorMiner (Cheng, Zhou, Xie, ISSTA 2023): eight signals, eight statistics of
each in a window. The statistics are defined as in tsfresh 0.21 (``mean_change``,
``mean_abs_change``, ``c3`` with lag 1, ``cid_ce`` with ``normalize``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView

SIGNALS = ("speed", "acceleration", "vx", "vy", "ax", "ay", "yaw_rate", "yaw")
"""Columns of the signals; velocity and acceleration are in the vehicle's own frame."""

STATISTICS = (
    "mean",
    "variance",
    "min",
    "max",
    "mean_change",
    "mean_abs_change",
    "c3",
    "cid_ce",
)
"""Statistics of each signal, in the order of columns."""

DECIMALS = 6
"""Decimals of the statistics: short to store, and equal on machines that round differently."""

_FLAT = 1e-6
"""Standard deviation up to which a signal counts as constant: below are only rounding errors, which
normalising would scale up to noise."""


def motion_signals(ego: EgoView, sample: float) -> FloatArray:
    """Returns an ego's signals at even times, interpolated linearly.

    Args:
        ego: An ego that has at least one row.
        sample: Seconds between the samples.

    Returns:
        (n, 8) columns ``SIGNALS``: m/s, m/s², m/s, m/s, m/s², m/s², rad/s, rad. The acceleration is
        the magnitude of the vector, negative while the speed falls; the yaw does not jump.
    """
    vx, vy = ego.states[:, Col.VX], ego.states[:, Col.VY]
    ax, ay = ego.states[:, Col.AX], ego.states[:, Col.AY]
    yaw = ego.states[:, Col.YAW]
    cos, sin = elementary.cos(yaw), elementary.sin(yaw)
    recorded = (
        ego.speed,
        np.where(ax * vx + ay * vy < 0.0, -1.0, 1.0) * np.hypot(ax, ay),
        vx * cos + vy * sin,
        vy * cos - vx * sin,
        ax * cos + ay * sin,
        ay * cos - ax * sin,
        ego.states[:, Col.YAW_RATE],
        np.unwrap(yaw),
    )
    count = int(ego.duration / sample + 1e-6) + 1
    times = ego.times[0] + sample * np.arange(count)
    return np.stack([np.interp(times, ego.times, signal) for signal in recorded], axis=1)


def window_statistics(signals: FloatArray, window: int, stride: int) -> FloatArray:
    """Returns the statistics of each signal in each window.

    A window that the samples do not fill is padded with the last of them, so that the end of a run,
    where it failed, is in a window, too.

    Args:
        signals: (n, c), n >= 1.
        window: Samples of a window, at least 3.
        stride: Samples from the start of a window to that of the next, at most ``window``.

    Returns:
        (m, c * 8): of every signal in turn the columns ``STATISTICS``. m is 1 where n <= window.
    """
    count = 1 + max(-(-(len(signals) - window) // stride), 0)
    missing = (count - 1) * stride + window - len(signals)
    filled = np.concatenate((signals, np.repeat(signals[-1:], missing, axis=0)))
    x = np.lib.stride_tricks.sliding_window_view(filled, window, axis=0)[::stride]
    change = np.diff(x, axis=2)
    deviation = x.std(axis=2)
    is_flat = deviation <= _FLAT
    roughness = np.sqrt((change**2).sum(axis=2)) / np.where(is_flat, 1.0, deviation)
    statistics = (
        x.mean(axis=2),
        x.var(axis=2),
        x.min(axis=2),
        x.max(axis=2),
        (x[:, :, -1] - x[:, :, 0]) / (window - 1),
        np.abs(change).mean(axis=2),
        (x[:, :, 2:] * x[:, :, 1:-1] * x[:, :, :-2]).mean(axis=2),
        np.where(is_flat, 0.0, roughness),
    )
    table = np.stack(statistics, axis=2).reshape(count, -1)
    # Adding 0 turns the -0 of rounding into 0.
    return np.round(table, DECIMALS) + 0.0
