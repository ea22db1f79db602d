"""Boxes that overlap, for many pairs at once.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray


def overlap(
    poses: FloatArray, size: tuple[float, float], others: FloatArray, sizes: FloatArray
) -> BoolArray:
    """Returns whether a box overlaps others, by the theorem of separating axes.

    Args:
        poses: (t, 3) x, y and yaw of the box's centre.
        size: Its length and width.
        others: (n, t, 3) the same for each of the others.
        sizes: (n, 2) their lengths and widths.

    Returns:
        (n, t) flags.
    """
    away = others[:, :, :2] - poses[:, :2]
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    turn = others[:, :, 2] - poses[:, 2]
    cos_turn, sin_turn = np.cos(turn), np.sin(turn)
    along = away[:, :, 0] * cos + away[:, :, 1] * sin
    across = away[:, :, 1] * cos - away[:, :, 0] * sin
    long, wide = 0.5 * sizes[:, :1], 0.5 * sizes[:, 1:]
    my_long, my_wide = 0.5 * size[0], 0.5 * size[1]
    c, s = np.abs(cos_turn), np.abs(sin_turn)
    met: BoolArray = (
        (np.abs(along) < my_long + long * c + wide * s)
        & (np.abs(across) < my_wide + long * s + wide * c)
        & (np.abs(along * cos_turn + across * sin_turn) < long + my_long * c + my_wide * s)
        & (np.abs(across * cos_turn - along * sin_turn) < wide + my_long * s + my_wide * c)
    )
    return met
