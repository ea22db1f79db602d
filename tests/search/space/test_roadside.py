"""Distances from the road to what is beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from drivora_service.networks.drivable_area import drivable_area
from drivora_service.search.space.roadside import OFF_ROAD, WIDEST, edge_distances
from tests.search.space.seeds import NETWORKS, SHIPPED

PLACES = 40


@pytest.mark.parametrize("town", SHIPPED)
def test_the_road_ends_where_the_first_place_is_outside_the_area(town: str) -> None:
    network, random = NETWORKS.get(town), np.random.default_rng(4)
    area, step = drivable_area(network), 0.5
    lanes = [lane for lane in network.lanes if lane.drivable]
    places = [
        lane.position_at(random.uniform(0.0, lane.arc[-1]))
        for lane in (lanes[random.integers(len(lanes))] for _ in range(PLACES))
    ]
    xy = np.array([(x, y) for x, y, _ in places])
    directions = random.uniform(-math.pi, math.pi, PLACES)
    found = edge_distances(network, xy, directions, step)
    for (x, y), direction, distance in zip(xy, directions, found, strict=True):
        gaps = [
            (ahead, area.distance(shapely.Point(x + ahead * dx, y + ahead * dy)))
            for dx, dy in [(math.cos(direction), math.sin(direction))]
            for ahead in np.arange(step, WIDEST + 0.5 * step, step)
        ]
        assert distance == min((at for at, gap in gaps if gap > OFF_ROAD), default=math.inf)
    assert np.isfinite(found).any()
