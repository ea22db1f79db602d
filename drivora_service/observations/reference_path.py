"""The reference path of an ego, and the difference of its path from it.

A path is compared in pieces of equal length: two paths share those whose middles are beside the
other path. Cells of a fixed grid would depend on where the grid lies: two paths a few centimetres
apart, on either side of a border between cells, would share none.
"""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, PoseCol

MOST_POSES = 4000
"""Poses of a path at most, as in documents."""

_TOLERANCES = np.array([0.02, 0.02, 0.01, 0.05, 0.05])
"""Greatest error of interpolation of x, y (m), heading (rad), speed (m/s) and height (m)."""

_DECIMALS = 4
_XY = [PoseCol.X, PoseCol.Y]


def reference_of(ego: EgoView) -> FloatArray | None:
    """Returns the (p, 6) reference path of an ego, columns ``PoseCol``; ``None`` without one."""
    references = ego.trace.references
    return references[ego.row] if references and len(references[ego.row]) else None


def recorded_path(ego: EgoView) -> FloatArray:
    """Returns the (p, 6) path of an ego that has at least two rows, columns ``PoseCol``.

    Poses are left out where interpolation between others gives them.
    """
    states = ego.states
    path = np.stack(
        (
            ego.times,
            states[:, Col.X],
            states[:, Col.Y],
            np.unwrap(states[:, Col.YAW]),
            ego.speed,
            states[:, Col.Z],
        ),
        axis=1,
    )
    tolerances = _TOLERANCES
    while np.count_nonzero(kept := _select_rows(path, tolerances)) > MOST_POSES:
        tolerances = 2.0 * tolerances
    thinned = path[kept]
    # The same direction, within the bounds of documents however often the ego has turned.
    thinned[:, PoseCol.YAW] = (thinned[:, PoseCol.YAW] + np.pi) % (2.0 * np.pi) - np.pi
    return np.round(thinned, _DECIMALS) + 0.0


def poses_at(path: FloatArray, times: FloatArray) -> FloatArray:
    """Returns the (n, 6) poses of a (p, 6) path at (n,) times; before and after it, its ends."""
    poses = np.empty((len(times), len(PoseCol)))
    poses[:, PoseCol.TIME] = times
    for column in (PoseCol.X, PoseCol.Y, PoseCol.SPEED, PoseCol.Z):
        poses[:, column] = np.interp(times, path[:, PoseCol.TIME], path[:, column])
    poses[:, PoseCol.YAW] = np.interp(times, path[:, PoseCol.TIME], np.unwrap(path[:, PoseCol.YAW]))
    return poses


def line_of(path: FloatArray) -> FloatArray:
    """Returns the (n, 2) places of a (p, 6) path."""
    return path[:, _XY]


def piece_middles(line: FloatArray, piece: float) -> FloatArray:
    """Returns the (n, 2) middles of the pieces of an (m, 2) line, at least one.

    Args:
        line: Metres; at least one point.
        piece: Length of a piece, metres. A rest of less than half a piece is left out.
    """
    arc = arc_lengths(line)
    count = max(round(float(arc[-1]) / piece), 1)
    middles = np.minimum(piece * (np.arange(count) + 0.5), arc[-1])
    return np.stack([np.interp(middles, arc, line[:, axis]) for axis in (0, 1)], axis=1)


def distances_to_line(points: FloatArray, line: FloatArray) -> FloatArray:
    """Returns the (n,) metres from points (n, 2) to the nearest place of an (m, 2) line."""
    begins, steps = line[:-1], np.diff(line, axis=0)
    if not len(steps):
        begins, steps = line, np.zeros_like(line)
    squares = np.maximum((steps**2).sum(axis=1), 1e-12)
    nearest = np.empty(len(points))
    for index, point in enumerate(points):
        away = point - begins
        share = np.clip((away * steps).sum(axis=1) / squares, 0.0, 1.0)
        nearest[index] = ((away - share[:, None] * steps) ** 2).sum(axis=1).min()
    return np.sqrt(nearest)


def path_overlap(
    own: FloatArray, reference: FloatArray, *, piece: float, half_width: float
) -> tuple[float, float]:
    """Compares two lines.

    Args:
        own: (n, 2) metres.
        reference: (m, 2) metres.
        piece: Length of a piece, metres.
        half_width: Metres from a line up to which a piece of the other is shared.

    Returns:
        The pieces of the reference that are shared, over all pieces of the two, shared ones counted
        once (intersection over union); and the greatest distance from a piece of either to the
        other line, metres (Hausdorff distance).
    """
    of_own = distances_to_line(piece_middles(own, piece), reference)
    of_reference = distances_to_line(piece_middles(reference, piece), own)
    alone = np.count_nonzero(of_own > half_width)
    share = np.count_nonzero(of_reference <= half_width) / (len(of_reference) + alone)
    return float(share), float(max(of_own.max(), of_reference.max()))


def _select_rows(path: FloatArray, tolerances: FloatArray) -> BoolArray:
    """Returns the (n,) rows between which the others are interpolated within the tolerances.

    The row with the largest error is kept, and the rows on either side of it are treated likewise
    (Douglas and Peucker 1973, over time).
    """
    kept = np.zeros(len(path), dtype=np.bool_)
    kept[[0, -1]] = True
    waiting = [(0, len(path) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        inner = path[first + 1 : last]
        share = (inner[:, 0] - path[first, 0]) / (path[last, 0] - path[first, 0])
        between = path[first, 1:] + share[:, None] * (path[last, 1:] - path[first, 1:])
        errors = (np.abs(inner[:, 1:] - between) / tolerances).max(axis=1)
        worst = int(np.argmax(errors))
        if errors[worst] > 1.0:
            middle = first + 1 + worst
            kept[middle] = True
            waiting += [(first, middle), (middle, last)]
    return kept
