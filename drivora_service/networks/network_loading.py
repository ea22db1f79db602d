"""Reading a SUMO ``.net.xml`` file into a :class:`RoadNetwork`."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.sax import SAXException, parseString

import numpy as np
import sumolib

from drivora_service.errors import NetworkError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.network_flaws import (
    check_lanes,
    check_numbers,
    check_signals,
    read_line,
)
from drivora_service.networks.road_network import (
    Connection,
    Lane,
    RoadNetwork,
    SignalPhase,
    SignalProgram,
)

MIN_POINT_DISTANCE = 0.05
"""Least distance of shape points, metres: coordinates are rounded to centimetres, so that the
direction between nearer points is noise."""

DEGENERATE_LENGTH = 0.01
"""Arc length of a lane whose shape is a single place, metres."""

MAX_REVERSED_LENGTH = 0.5
"""Metres; a shorter lane inside a junction that runs against the lanes it joins counts as a single
place, and a shorter piece of a lane that runs backwards counts as a mistake of its converter.
"""


def load_network(path: Path, name: str) -> RoadNetwork:
    """Reads a network.

    Args:
        path: The ``.net.xml`` file.
        name: Its name in the catalogue.

    Raises:
        NetworkError: The file is missing, is not a SUMO network, or has no drivable lane.
    """
    try:
        data = path.read_bytes()
        net = _read_net(data)
        programs = _read_programs(data)
        lanes = _build_lanes(net)
        check_signals(programs, lanes)
        net_offset, bounds = _read_location(net)
        junction_shapes = _read_junction_shapes(net)
    except OSError as error:
        raise NetworkError(f"network {name!r} cannot be read: {error.strerror}") from error
    except (SAXException, ElementTree.ParseError) as error:
        raise NetworkError(f"network {name!r} is not well-formed XML: {error}") from error
    except NetworkError as error:
        raise NetworkError(f"network {name!r} cannot be used: {error}") from error
    except (LookupError, ValueError, AttributeError, TypeError, ArithmeticError) as error:
        raise NetworkError(
            f"network {name!r} is not a SUMO network ({type(error).__name__}: {error}); "
            "build one with netconvert"
        ) from error
    if not any(lane.drivable for lane in lanes):
        raise NetworkError(f"network {name!r} has no lane that is open to passenger cars")
    by_edge: dict[str, list[int]] = {}
    for lane in lanes:
        by_edge.setdefault(lane.edge_id, []).append(lane.index)
    return RoadNetwork(
        name=name,
        path=path,
        sha256=hashlib.sha256(data).hexdigest(),
        net_offset=net_offset,
        bounds=bounds,
        lanes=lanes,
        lane_by_id={lane.id: lane.index for lane in lanes},
        edge_lanes={edge: tuple(indices) for edge, indices in by_edge.items()},
        junction_shapes=junction_shapes,
        programs=programs,
    )


def _read_net(data: bytes) -> Any:
    """Reads the bytes that are hashed, with the same XML parser everywhere.

    ``sumolib.net.readNet`` opens the file again, decompresses it if necessary, and parses it with
    lxml if that is installed, which may read other files.
    """
    if b"<!DOCTYPE" in data:
        raise NetworkError("found a document type declaration, which is not allowed")
    reader = sumolib.net.NetReader(withInternal=True, withFoes=False)
    parseString(data, reader)
    return reader.getNet()


def _read_location(net: Any) -> tuple[tuple[float, float], tuple[float, float, float, float]]:
    """Returns the offset and the bounds, metres."""
    x, y = (float(value) for value in net.getLocationOffset())
    west, south, east, north = (float(value) for value in net.getBoundary())
    check_numbers("the location", (x, y, west, south, east, north))
    return (x, y), (west, south, east, north)


def _read_junction_shapes(net: Any) -> dict[str, FloatArray]:
    shapes = {}
    for node in net.getNodes():
        # A junction that is only named by edges or connections has none.
        shape = node.getShape() or ()
        if len(shape) >= 3:
            check_numbers(f"the shape of junction {node.getID()!r}", np.ravel(shape))
            shapes[node.getID()] = np.array(shape, dtype=np.float64)
    return shapes


@dataclass(frozen=True, slots=True, kw_only=True)
class _RawLane:
    """A lane as sumolib reads it, with the data for the second pass."""

    source: Any
    id: str
    number: int
    points: FloatArray
    drivable: bool
    walkable: bool


def _build_lanes(net: Any) -> tuple[Lane, ...]:
    raw: list[_RawLane] = []
    for edge in net.getEdges():
        on_foot_only = edge.getFunction() in ("crossing", "walkingarea")
        raw.extend(
            _RawLane(
                source=source,
                id=f"{edge.getID()}_{number}",
                number=number,
                points=_distinct_points(read_line(source, f"{edge.getID()}_{number}")),
                drivable=source.allows("passenger") and not on_foot_only,
                walkable=source.allows("pedestrian"),
            )
            for number, source in enumerate(edge.getLanes())
        )
    check_lanes((lane.id, lane.points, lane.source) for lane in raw)
    index_of = {lane.id: index for index, lane in enumerate(raw)}
    connections = [_connections(lane.source, index_of) for lane in raw]
    shapes = _usable_shapes([lane.points for lane in raw], connections)
    drivable = {index for index, lane in enumerate(raw) if lane.drivable}
    lanes = []
    for index, lane in enumerate(raw):
        edge = lane.source.getEdge()
        internal = lane.id.startswith(":")
        lanes.append(
            Lane(
                index=index,
                id=lane.id,
                edge_id=edge.getID(),
                lane_number=lane.number,
                shape=shapes[index],
                arc=arc_lengths(shapes[index]),
                heights=_heights(lane.source.getShape3D(), shapes[index]),
                length=float(lane.source.getLength()),
                width=float(lane.source.getWidth()),
                speed_limit=float(lane.source.getSpeed()),
                is_internal=internal,
                drivable=lane.drivable,
                walkable=lane.walkable,
                connections=connections[index],
                left=_neighbour(index_of, drivable, edge.getID(), lane.number + 1),
                right=_neighbour(index_of, drivable, edge.getID(), lane.number - 1),
                to_junction="" if internal else edge.getToNode().getID(),
            )
        )
    return tuple(lanes)


def _neighbour(index_of: dict[str, int], drivable: set[int], edge_id: str, number: int) -> int:
    index = index_of.get(f"{edge_id}_{number}", -1)
    return index if index in drivable else -1


def _connections(source: Any, index_of: dict[str, int]) -> tuple[Connection, ...]:
    return tuple(
        Connection(
            to_lane=index_of[link.getViaLaneID() or link.getToLane().getID()],
            traffic_light=link.getTLSID(),
            link_index=int(link.getTLLinkIndex()),
            direction=link.getDirection(),
            right_of_way=link.getState() or "",
        )
        for link in source.getOutgoing()
    )


def _distinct_points(points: FloatArray) -> FloatArray:
    """Returns those of (n, 2) points that are far enough apart; both ends stay in place.

    If a short piece runs backwards, its beginning is omitted.
    """
    kept: list[FloatArray] = []
    for point in points:
        if not kept or _distance(kept[-1], point) >= MIN_POINT_DISTANCE:
            kept.append(point)
    last = points[-1]
    if _distance(kept[-1], last) > 0.0:
        if len(kept) > 1:
            kept[-1] = last
        else:
            kept.append(last)
    return _without_backward_pieces(np.array(kept))


def _without_backward_pieces(points: FloatArray) -> FloatArray:
    """Removes points between which a line turns back for less than ``MAX_REVERSED_LENGTH``."""
    while len(points) > 2:
        steps = np.diff(points, axis=0)
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        back = (steps[:-1] * steps[1:]).sum(axis=1) < 0.0
        short = np.minimum(lengths[:-1], lengths[1:]) < MAX_REVERSED_LENGTH
        wrong = np.flatnonzero(back & short)
        if not len(wrong):
            break
        points = np.delete(points, wrong[0] + 1, axis=0)
    return points


def _heights(shape: Sequence[tuple[float, float, float]], line: FloatArray) -> FloatArray:
    """Returns the (n,) heights of a line, by the share of its length, from the lane's 3D shape."""
    points = np.asarray(shape, dtype=np.float64).reshape(-1, 3)
    if len(points) < 2 or not points[:, 2].any():
        return np.full(len(line), points[0, 2] if len(points) else 0.0)
    arc, own = arc_lengths(points[:, :2]), arc_lengths(line)
    shares, known = own / max(own[-1], 1e-9), arc / max(arc[-1], 1e-9)
    return np.asarray(np.interp(shares, known, points[:, 2]), dtype=np.float64)


def _usable_shapes(
    points: Sequence[FloatArray], connections: Sequence[tuple[Connection, ...]]
) -> list[FloatArray]:
    """Replaces lanes of coinciding points by a short straight in their neighbours' direction.

    Some converters write internal lanes of 0.1 m with two points rounded to the same place,
    or to places in the wrong order.
    """
    shapes = list(points)
    short = [i for i, p in enumerate(points) if arc_lengths(p)[-1] < MAX_REVERSED_LENGTH]
    before: dict[int, list[int]] = {i: [] for i in short}
    for index, links in enumerate(connections):
        for link in links:
            if link.to_lane in before:
                before[link.to_lane].append(index)
    for index in short:
        direction = _direction(
            [(points[i], -1) for i in before[index]]
            + [(points[link.to_lane], 0) for link in connections[index]]
        )
        own = points[index][-1] - points[index][0]
        if float(own[0] * direction[0] + own[1] * direction[1]) >= DEGENERATE_LENGTH:
            continue
        centre = points[index].mean(axis=0)
        half = 0.5 * DEGENERATE_LENGTH * direction
        shapes[index] = np.stack((centre - half, centre + half))
    return shapes


def _direction(neighbours: Iterable[tuple[FloatArray, int]]) -> FloatArray:
    """Returns the unit direction of the first usable neighbour's last (-1) or first (0) step."""
    for line, end in neighbours:
        steps = np.diff(line, axis=0)
        if len(steps):
            step = steps[end]
            norm = float(np.hypot(step[0], step[1]))
            if norm >= DEGENERATE_LENGTH:
                return np.asarray(step / norm, dtype=np.float64)
    return np.array([1.0, 0.0])


def _distance(a: FloatArray, b: FloatArray) -> float:
    return float(np.hypot(b[0] - a[0], b[1] - a[1]))


def _read_programs(data: bytes) -> dict[str, SignalProgram]:
    """Reads the traffic-light programmes; of several for one light the last counts, as in SUMO."""
    return {
        logic.attrib["id"]: SignalProgram(
            id=logic.attrib["id"],
            program_id=logic.attrib["programID"],
            offset=float(logic.get("offset", "0")),
            phases=tuple(
                SignalPhase(duration=float(phase.attrib["duration"]), state=phase.attrib["state"])
                for phase in logic.iter("phase")
            ),
        )
        for logic in ElementTree.fromstring(data).iter("tlLogic")
    }
