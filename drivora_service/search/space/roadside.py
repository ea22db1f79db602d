"""Places along an ego's route, and their distances to the edges of the carriageway."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.drivable_area import near_area
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.search.space.driven_path import DrivenPath

OFF_ROAD = 2.0
"""Metres outside the drivable area from which a place counts as beside the road."""
WIDEST = 25.0
"""Metres from the route's line to the edge of the carriageway, at most."""
_STEP = 0.5
_AT_ONCE = 16
"""Places that are sampled on a line before it is known whether more are needed."""
_REACH = 10.0
_STRAIGHT = 0.2
"""Radians by which a road may turn 10 metres before and after a place that counts as straight."""
_JUNCTION_MARGIN = 4.0
"""Metres between places and junctions, where the carriageway widens."""


class Roadside:
    """The places of one route outside junctions, a metre apart.

    Attributes:
        path: The route.
    """

    def __init__(self, path: DrivenPath) -> None:
        self.path = path

    @cached_property
    def open_road(self) -> FloatArray:
        """(n,) arc lengths of places outside junctions and not near them, ascending."""
        s = np.arange(0.0, self.path.length, 1.0)
        inside = self.path.arc[self.path.in_junction]
        if not len(inside):
            return s
        after = np.searchsorted(inside, s)
        ahead = np.abs(inside[np.minimum(after, len(inside) - 1)] - s)
        behind = np.abs(inside[np.maximum(after - 1, 0)] - s)
        return s[np.minimum(ahead, behind) >= _JUNCTION_MARGIN]

    @cached_property
    def straights(self) -> FloatArray:
        """(n,) arc lengths of the open places around which the road is straight, or nearly so."""
        s, path = self.open_road, self.path
        yaw = np.column_stack(
            [np.interp(s + aside, path.arc, path.yaw) for aside in (-_REACH, 0.0, _REACH)]
        )
        turn: FloatArray = np.ptp(yaw, axis=1)
        return s[turn <= _STRAIGHT]

    @cached_property
    def crossings(self) -> FloatArray:
        """(n,) arc lengths of every other from which both edges of the road are in reach."""
        s = self.open_road[::2]
        if not len(s):
            return s
        poses = [self.path.at(float(place)) for place in s]
        xy = np.array([(pose.x, pose.y) for pose in poses])
        yaw = np.array([pose.yaw for pose in poses])
        # An edge that is found with wide steps is found with the usual ones, too.
        wide = 2.0 * _STEP
        left = edge_distances(self.path.network, xy, yaw + 0.5 * math.pi, wide)
        right = edge_distances(self.path.network, xy, yaw - 0.5 * math.pi, wide)
        return s[np.isfinite(left) & np.isfinite(right)]


def edge_distances(
    network: RoadNetwork, xy: FloatArray, directions: FloatArray, step: float = _STEP
) -> FloatArray:
    """Returns the distances from places on the road to the first place beside it.

    Args:
        network: The road network.
        xy: (n, 2) places, metres.
        directions: (n,) directions, radians.
        step: Metres between the sampled places.

    Returns:
        (n,) metres; inf if the carriageway does not end within ``WIDEST``.
    """
    steps = np.arange(step, WIDEST + 0.5 * step, step)
    ahead = np.stack((elementary.cos(directions), elementary.sin(directions)), axis=-1)
    found = np.full(len(xy), np.inf)
    searching = np.arange(len(xy))
    # Most carriageways end soon: places beyond the end need not be compared with the area.
    for begin in range(0, len(steps), _AT_ONCE):
        part = steps[begin : begin + _AT_ONCE]
        points = xy[searching, None, :] + part[None, :, None] * ahead[searching, None, :]
        near = near_area(network, points.reshape(-1, 2), OFF_ROAD)
        beside = ~near.reshape(len(searching), len(part))
        ends = beside.any(axis=1)
        found[searching[ends]] = part[np.argmax(beside[ends], axis=1)]
        searching = searching[~ends]
        if not len(searching):
            break
    return found


def places_from(places: FloatArray, begin: float) -> FloatArray:
    """Returns those of ascending places that are at ``begin`` or beyond; the last if none is."""
    return places[min(int(np.searchsorted(places, begin)), len(places) - 1) :]


def place_at(places: FloatArray, share: float) -> float:
    """Returns the place at a share, 0..1, of several."""
    return float(places[round(share * (len(places) - 1))])
