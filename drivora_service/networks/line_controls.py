"""Regulation of stop lines: a signal, a sign, or neither, as it follows from right of way."""

from __future__ import annotations

from enum import StrEnum
from functools import lru_cache

from drivora_service.networks.road_details import road_details
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.stop_lines import stop_lines

STOPPING_LETTERS = ("s", "w")
"""SUMO's letters for a movement that must stop: at a stop sign, at an all-way stop."""
_YIELDING = "m"
_EQUAL_JUNCTIONS = ("right_before_left", "left_before_right")


class LineControl(StrEnum):
    """Regulation of the movements from a lane's end."""

    SIGNAL = "signal"
    STOP = "stop"
    ALL_WAY_STOP = "all_way_stop"
    YIELD = "yield"
    """All movements of its road give way, as behind a give-way sign."""
    RIGHT_BEFORE_LEFT = "right_before_left"
    NONE = "none"
    """Its road has priority, or the junction has nothing to regulate."""


@lru_cache(maxsize=32)
def line_controls(network: RoadNetwork) -> tuple[LineControl, ...]:
    """Returns the regulation of each row of ``stop_lines``."""
    types = road_details(network).junction_types
    letters: dict[str, set[str]] = {}
    lines = stop_lines(network)
    lanes = [network.lanes[index] for index in lines.lanes.tolist()]
    for lane in lanes:
        found = letters.setdefault(lane.edge_id, set())
        found.update(connection.right_of_way for connection in lane.connections)
    controls = []
    for lane in lanes:
        own = {connection.right_of_way for connection in lane.connections}
        if any(connection.traffic_light for connection in lane.connections):
            controls.append(LineControl.SIGNAL)
        elif "w" in own:
            controls.append(LineControl.ALL_WAY_STOP)
        elif "s" in own:
            controls.append(LineControl.STOP)
        elif types.get(lane.to_junction) in _EQUAL_JUNCTIONS:
            controls.append(LineControl.RIGHT_BEFORE_LEFT)
        # A lane that only turns left across oncoming traffic gives way, too, but has no sign.
        elif letters[lane.edge_id] == {_YIELDING}:
            controls.append(LineControl.YIELD)
        else:
            controls.append(LineControl.NONE)
    return tuple(controls)
