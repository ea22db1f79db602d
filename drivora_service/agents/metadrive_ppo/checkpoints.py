"""A route as in MetaDrive's navigation: straight pieces and arcs, with a checkpoint after each.

MetaDrive's maps consist of straight roads, arcs of 25 to 60 m radius and junctions; its
navigation names the end of the piece that the ego is on and the end of the next one, with the bend
of each. Here the pieces are derived from the bends of the route.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from itertools import pairwise

import numpy as np

from drivora_service.agents.route_corridor import RouteCorridor
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.products import moving_mean

_SPACING = 1.0
_SMOOTHING = 9
"""Points of the moving average over headings: centre lines are polylines with sharp corners."""
_LEAST_BEND = 0.01
"""1/m; a weaker bend counts as straight."""
_LEAST_TURN = 0.26
"""Radians, 15 degrees; a piece with a smaller total turn is straight."""
_SHORTEST_STRAIGHT = 8.0
"""Metres; a shorter straight piece between two arcs belongs to the first of them."""
_TIGHTEST = 5.0
"""Least radius in metres, for corners of a centre line."""


class PieceCol(IntEnum):
    """Columns of ``Checkpoints.pieces``."""

    X = 0
    Y = 1
    """Of the checkpoint: the middle of the corridor at the piece's end, metres."""
    RADIUS = 2
    """Metres; 0 where the piece is straight."""
    ANGLE = 3
    """Radians by which it turns, positive to the left."""
    WIDTH = 4
    """Of the corridor at its end, metres."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Checkpoints:
    """The pieces of a route, in order.

    Attributes:
        ends: (k,) arc length on the route's reference line at which each piece ends, metres.
        pieces: (k, 5), columns ``PieceCol``.
    """

    ends: FloatArray
    pieces: FloatArray


def find_checkpoints(corridor: RouteCorridor) -> Checkpoints:
    """Cuts a corridor into straight pieces and arcs."""
    length = float(corridor.arc[-1])
    bounds: list[tuple[float, float, float]] = []
    for begin, end, angle in _turns(corridor):
        before = bounds[-1][0] if bounds else 0.0
        if begin - before >= _SHORTEST_STRAIGHT or not bounds:
            if begin > before:
                bounds.append((begin, 0.0, 0.0))
        else:
            bounds[-1] = (begin, *bounds[-1][1:])
        bounds.append((end, max((end - begin) / abs(angle), _TIGHTEST), angle))
    if not bounds or length - bounds[-1][0] > 1e-6:
        bounds.append((length, 0.0, 0.0))
    ends = np.array([bound[0] for bound in bounds])
    radius, angle = np.array([bound[1:] for bound in bounds]).T
    x, y = (np.interp(ends, corridor.arc, corridor.middle[:, k]) for k in (0, 1))
    width = np.interp(ends, corridor.arc, corridor.width)
    return Checkpoints(ends=ends, pieces=np.column_stack((x, y, radius, angle, width)))


def _turns(corridor: RouteCorridor) -> list[tuple[float, float, float]]:
    """Returns begin and end of each arc, metres, and its turn, radians."""
    count = max(int(np.ceil(corridor.arc[-1] / _SPACING)) + 1, 2)
    s = np.linspace(0.0, float(corridor.arc[-1]), count)
    heading = np.interp(s, corridor.arc, corridor.heading)
    half = _SMOOTHING // 2
    smooth = moving_mean(np.pad(heading, half, mode="edge"), _SMOOTHING)
    bend = np.gradient(smooth, s)
    side = np.where(np.abs(bend) > _LEAST_BEND, np.sign(bend), 0.0)
    cuts = [0, *(np.flatnonzero(np.diff(side)) + 1).tolist(), count]
    turns: list[tuple[float, float, float]] = []
    for first, last in pairwise(cuts):
        angle = float(smooth[last - 1] - smooth[first])
        if side[first] == 0.0 or abs(angle) < _LEAST_TURN:
            continue
        # The average spreads a tight turn: its middle eight tenths are in their unsmoothed place.
        turned = np.maximum.accumulate(np.sign(angle) * heading[first:last])
        low, high = (turned[0] + share * (turned[-1] - turned[0]) for share in (0.1, 0.9))
        begin, end = (float(s[first + int(np.searchsorted(turned, x))]) for x in (low, high))
        margin = (end - begin) / 8.0
        earliest = turns[-1][1] if turns else 0.0
        turns.append((max(begin - margin, earliest), min(end + margin, float(s[-1])), angle))
    return turns
