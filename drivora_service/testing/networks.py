"""A small road network for tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.road_network import Connection, Lane, RoadNetwork

EAST, EAST_LEFT, WEST, CROSSING = 0, 1, 2, 3
"""Indices of the lanes of ``straight_road``."""

LANE_WIDTH = 3.5


def straight_road() -> RoadNetwork:
    """Builds a straight road along the x axis, from -500 m to 500 m, with a junction at its end.

    Two lanes lead east (``EAST`` at y = 0 m, ``EAST_LEFT`` at 3.5 m) and one west (``WEST`` at
    7 m), each 3.5 m wide, so that the road reaches from y = -1.75 m to 8.75 m. ``CROSSING`` is the
    lane through the junction, y = 0 m from x = 500 m to 520 m. The limit is 10 m/s.
    """
    lanes = (
        _lane(EAST, "east", 0, ((-500.0, 0.0), (500.0, 0.0)), left=EAST_LEFT),
        _lane(EAST_LEFT, "east", 1, ((-500.0, 3.5), (500.0, 3.5)), right=EAST),
        _lane(WEST, "west", 0, ((500.0, 7.0), (-500.0, 7.0))),
        _lane(CROSSING, ":end_0", 0, ((500.0, 0.0), (520.0, 0.0))),
    )
    return RoadNetwork(
        name="straight-road",
        path=Path("straight-road.net.xml"),
        sha256="0" * 64,
        net_offset=(0.0, 0.0),
        bounds=(-500.0, -1.75, 520.0, 8.75),
        lanes=lanes,
        lane_by_id={lane.id: lane.index for lane in lanes},
        edge_lanes={"east": (EAST, EAST_LEFT), "west": (WEST,), ":end_0": (CROSSING,)},
        junction_shapes={},
        programs={},
    )


def _lane(
    index: int,
    edge: str,
    number: int,
    points: tuple[tuple[float, float], ...],
    *,
    left: int = -1,
    right: int = -1,
) -> Lane:
    shape = np.array(points)
    arc = arc_lengths(shape)
    onwards = Connection(to_lane=CROSSING, traffic_light="", link_index=-1, direction="s")
    return Lane(
        index=index,
        id=f"{edge}_{number}",
        edge_id=edge,
        lane_number=number,
        shape=shape,
        arc=arc,
        length=float(arc[-1]),
        width=LANE_WIDTH,
        heights=np.zeros(len(shape)),
        speed_limit=10.0,
        is_internal=edge.startswith(":"),
        drivable=True,
        walkable=False,
        connections=(onwards,) if index == EAST else (),
        left=left,
        right=right,
        to_junction="end" if index in (EAST, EAST_LEFT) else "",
    )
