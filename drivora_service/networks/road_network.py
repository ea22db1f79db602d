"""A road network in memory: its lanes, their connections, and its traffic lights.

Frame: SUMO's plane, x east and y north in metres. A lane's arc length runs from its start to its
end along the centre line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray


def make_read_only(*arrays: NDArray[Any]) -> None:
    """Makes arrays read-only; each must own its data."""
    for array in arrays:
        array.setflags(write=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Connection:
    """A permitted movement from the end of a lane.

    Attributes:
        to_lane: Index of the next lane: an internal lane of the junction if there is one, else
            the lane after it.
        traffic_light: Id of the traffic light that controls it, or "".
        link_index: Position of its signal in the traffic light's state string, or -1.
        direction: SUMO's letter: s straight, l left, r right, t turn-around, L/R partial.
        right_of_way: SUMO's letter without a signal: M major, m minor, s stop, w all-way stop,
            = equal, Z zip merge; o and O signal off; "" unknown.
    """

    to_lane: int
    traffic_light: str
    link_index: int
    direction: str
    right_of_way: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lane:
    """One lane.

    Attributes:
        index: Row of this lane in ``RoadNetwork.lanes``.
        id: SUMO's lane id.
        edge_id: The edge it belongs to.
        lane_number: 0 is the rightmost lane of the edge.
        shape: (n, 2) centre line, metres.
        arc: (n,) arc length at each point of the shape, metres.
        heights: (n,) height at each point, metres; all 0 in flat networks.
        length: SUMO's length in metres; may differ from ``arc[-1]``.
        width: Metres.
        speed_limit: m/s.
        is_internal: True inside a junction.
        drivable: Open to passenger cars.
        walkable: Open to pedestrians (sidewalk, crossing, walking area).
        connections: Movements from its end.
        left: Index of the drivable lane of the same edge to the left, or -1.
        right: Index of the drivable lane of the same edge to the right, or -1.
        to_junction: Id of the junction at its end ("" for internal lanes' own junction too).
    """

    index: int
    id: str
    edge_id: str
    lane_number: int
    shape: FloatArray
    arc: FloatArray
    heights: FloatArray
    length: float
    width: float
    speed_limit: float
    is_internal: bool
    drivable: bool
    walkable: bool
    connections: tuple[Connection, ...]
    left: int
    right: int
    to_junction: str

    def __post_init__(self) -> None:
        """Makes the arrays read-only."""
        make_read_only(self.shape, self.arc, self.heights)

    def position_at(self, s: float) -> tuple[float, float, float]:
        """Returns x, y (metres) and heading (radians) of the centre line at arc length ``s``."""
        s = min(max(s, 0.0), float(self.arc[-1]))
        i = min(max(int(np.searchsorted(self.arc, s, side="right")) - 1, 0), len(self.arc) - 2)
        (x0, y0), (x1, y1) = self.shape[i], self.shape[i + 1]
        span = float(self.arc[i + 1] - self.arc[i])
        t = (s - float(self.arc[i])) / span if span > 0 else 0.0
        return (
            float(x0 + t * (x1 - x0)),
            float(y0 + t * (y1 - y0)),
            math.atan2(y1 - y0, x1 - x0),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LanePosition:
    """Position of a point relative to a lane.

    Attributes:
        lane: Index of the lane.
        s: Arc length of the foot point on the centre line, metres.
        lateral: Signed distance from the centre line in metres, positive to the left.
        heading: Direction of the lane at the foot point, radians.
    """

    lane: int
    s: float
    lateral: float
    heading: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalPhase:
    """A stage of a programme: ``state`` has a letter of ``GgyrYuosO`` for each link; seconds."""

    duration: float
    state: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalProgram:
    """The programme of a traffic light as the network defines it."""

    id: str
    program_id: str
    offset: float
    phases: tuple[SignalPhase, ...]


@dataclass(frozen=True, slots=True, weakref_slot=True, kw_only=True, eq=False)
class RoadNetwork:
    """A road network, read once in a process and shared by all runs and agents: read-only.

    Attributes:
        name: Name in the catalogue.
        path: The ``.net.xml`` file.
        sha256: Hash of that file's bytes, hexadecimal.
        net_offset: (x, y) added to the source's coordinates, metres.
        bounds: (min_x, min_y, max_x, max_y), metres.
        lanes: All lanes; by their ``index``.
        lane_by_id: Index by SUMO's lane id.
        edge_lanes: Indices of an edge's lanes, rightmost first, by edge id.
        junction_shapes: (n, 2) outline of each junction by id, metres.
        programs: Traffic-light programmes by id.
    """

    name: str
    path: Path
    sha256: str
    net_offset: tuple[float, float]
    bounds: tuple[float, float, float, float]
    lanes: tuple[Lane, ...] = field(repr=False)
    lane_by_id: Mapping[str, int] = field(repr=False)
    edge_lanes: Mapping[str, tuple[int, ...]] = field(repr=False)
    junction_shapes: Mapping[str, FloatArray] = field(repr=False)
    programs: Mapping[str, SignalProgram] = field(repr=False)

    def __post_init__(self) -> None:
        """Makes the tables read-only."""
        for name in ("lane_by_id", "edge_lanes", "junction_shapes", "programs"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        make_read_only(*self.junction_shapes.values())

    def lane(self, lane_id: str) -> Lane:
        """Returns the lane with SUMO's id ``lane_id``; KeyError if there is none."""
        return self.lanes[self.lane_by_id[lane_id]]
