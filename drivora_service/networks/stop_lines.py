"""Stop lines: the ends of lanes before junctions, with the movements from there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.road_network import Connection, Lane, RoadNetwork


@dataclass(frozen=True, slots=True, kw_only=True)
class WayThrough:
    """A permitted movement from a stop line through its junction.

    Attributes:
        connection: Connection from the lane before the line.
        inside: Lanes inside the junction in order; empty if the network has none.
        exit_edge: The edge after the junction.
    """

    connection: Connection
    inside: tuple[int, ...]
    exit_edge: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StopLines:
    """The ends of all lanes that lead cars into a junction, one in each row.

    Attributes:
        lanes: (n,) the lane that ends at the line.
        points: (n, 2) middle of the line, metres.
        headings: (n, 2) unit vector along the lane.
        half_widths: (n,) metres, half the width of the lane.
        heights: (n,) metres.
        ways: The movements from each line.
    """

    lanes: IntArray
    points: FloatArray
    headings: FloatArray
    half_widths: FloatArray
    heights: FloatArray
    ways: tuple[tuple[WayThrough, ...], ...]


@lru_cache(maxsize=128)
def stop_lines(network: RoadNetwork) -> StopLines:
    """Returns the stop lines of a network, computed once."""
    ends = [lane for lane in network.lanes if lane.drivable and not lane.is_internal]
    ends = [lane for lane in ends if lane.connections]
    headings = [lane.shape[-1] - lane.shape[-2] for lane in ends]
    return StopLines(
        lanes=np.array([lane.index for lane in ends], dtype=np.int64),
        points=np.array([lane.shape[-1] for lane in ends]).reshape(-1, 2),
        headings=np.array([step / np.hypot(*step) for step in headings]).reshape(-1, 2),
        half_widths=np.array([0.5 * lane.width for lane in ends]),
        heights=np.array([lane.heights[-1] for lane in ends]),
        ways=tuple(_ways(network, lane) for lane in ends),
    )


def _ways(network: RoadNetwork, lane: Lane) -> tuple[WayThrough, ...]:
    found = []
    for connection in lane.connections:
        inside: list[int] = []
        following = network.lanes[connection.to_lane]
        while following.is_internal and following.index not in inside:
            inside.append(following.index)
            if not following.connections:
                break
            following = network.lanes[following.connections[0].to_lane]
        found.append(
            WayThrough(connection=connection, inside=tuple(inside), exit_edge=following.edge_id)
        )
    return tuple(found)
