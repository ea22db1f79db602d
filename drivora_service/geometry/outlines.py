"""Outlines of boxes."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray


def box_corners(
    x: FloatArray,
    y: FloatArray,
    yaw: FloatArray,
    length: float | FloatArray,
    width: float | FloatArray,
) -> FloatArray:
    """Returns the (n, 4, 2) corners of boxes, front left first, counter-clockwise.

    Args:
        x: (n,) centres, metres.
        y: (n,) centres, metres.
        yaw: (n,) headings, radians.
        length: Length of all boxes, or (n,) of each, metres.
        width: Width of all boxes, or (n,) of each, metres.
    """
    half_length, half_width = (0.5 * np.reshape(size, (-1, 1, 1)) for size in (length, width))
    ahead = np.stack((elementary.cos(yaw), elementary.sin(yaw)), axis=-1)[:, None, :] * half_length
    left = np.stack((-elementary.sin(yaw), elementary.cos(yaw)), axis=-1)[:, None, :] * half_width
    signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    centres = np.stack((x, y), axis=-1)[:, None, :]
    return centres + signs[None, :, :1] * ahead + signs[None, :, 1:] * left
