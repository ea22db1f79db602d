"""Networks as lines and outlines, to the centimetre."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np

from drivora_service.api.schemas.network_geometry import (
    Crossing,
    LaneGeometry,
    LaneKind,
    LightLink,
    Line,
    Movement,
    NetworkGeometry,
    Phase,
    Point,
    Sign,
    StopLineGeometry,
    TrafficLight,
)
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import offset_line
from drivora_service.networks.line_controls import LineControl, line_controls
from drivora_service.networks.markings import lane_markings
from drivora_service.networks.road_details import road_details
from drivora_service.networks.road_network import Connection, Lane, RoadNetwork
from drivora_service.networks.stop_lines import stop_lines

GEOMETRY_VERSION = 2
"""Changes with the shape of the answer, of which clients keep copies."""

_BESIDE_ROAD = 0.8
"""Metres from the border of the lane to a sign."""
_KINDS = {
    "internal": LaneKind.JUNCTION,
    "crossing": LaneKind.CROSSING,
    "walkingarea": LaneKind.WALKING_AREA,
}
_SIGNS = frozenset({LineControl.STOP, LineControl.ALL_WAY_STOP, LineControl.YIELD})


@lru_cache(maxsize=8)
def geometry_json(network: RoadNetwork) -> bytes:
    """Returns the geometry of a network as JSON, made once."""
    return geometry_of(network).model_dump_json().encode()


def geometry_of(network: RoadNetwork) -> NetworkGeometry:
    """Returns what is needed to draw a network."""
    lines = tuple(_stop_lines(network))
    return NetworkGeometry(
        name=network.name,
        sha256=network.sha256,
        bounds=network.bounds,
        lanes=tuple(_lanes(network)),
        junctions={junction: _line(shape) for junction, shape in network.junction_shapes.items()},
        junction_types=dict(road_details(network).junction_types),
        crossings=tuple(_crossings(network)),
        stop_lines=lines,
        traffic_lights=tuple(_traffic_lights(network, lines)),
        signs=tuple(_signs(network, lines)),
    )


def _lanes(network: RoadNetwork) -> Iterator[LaneGeometry]:
    edges = road_details(network).edges
    for lane, (left, right) in zip(network.lanes, lane_markings(network), strict=True):
        edge = edges[lane.edge_id]
        yield LaneGeometry(
            id=lane.id,
            shape=_line(lane.shape),
            width=lane.width,
            drivable=lane.drivable,
            walkable=lane.walkable,
            internal=lane.is_internal,
            kind=_kind(lane, edge.function),
            edge=lane.edge_id,
            index=lane.lane_number,
            street=edge.street,
            speed_limit=lane.speed_limit,
            left_marking=left,
            right_marking=right,
        )


def _kind(lane: Lane, function: str) -> LaneKind:
    if function in _KINDS:
        return _KINDS[function]
    if lane.drivable:
        return LaneKind.ROAD
    return LaneKind.SIDEWALK if lane.walkable else LaneKind.OTHER


def _crossings(network: RoadNetwork) -> Iterator[Crossing]:
    details = road_details(network)
    entries = _entries(network)
    for lane in network.lanes:
        edge = details.edges[lane.edge_id]
        if edge.function != "crossing":
            continue
        signals = [entry for entry in entries.get(lane.index, ()) if entry.traffic_light]
        yield Crossing(
            id=lane.id,
            junction=lane.edge_id.removeprefix(":").rpartition("_c")[0],
            shape=_line(lane.shape),
            width=lane.width,
            # SUMO's own outlines of crossings cut themselves, and hold parts of what is beside.
            outline=_line(_strip(lane)),
            edges=edge.crosses,
            light=signals[0].traffic_light if signals else "",
            links=tuple(sorted({entry.link_index for entry in signals})),
        )


def _entries(network: RoadNetwork) -> dict[int, list[Connection]]:
    """Returns the connections into each lane."""
    entries: dict[int, list[Connection]] = {}
    for lane in network.lanes:
        for connection in lane.connections:
            entries.setdefault(connection.to_lane, []).append(connection)
    return entries


def _strip(lane: Lane) -> FloatArray:
    """Returns the outline of a lane of constant width."""
    left, right = (offset_line(lane.shape, side * 0.5 * lane.width) for side in (1.0, -1.0))
    return np.concatenate((left, right[::-1]))


def _stop_lines(network: RoadNetwork) -> Iterator[StopLineGeometry]:
    lines = stop_lines(network)
    for row, control in enumerate(line_controls(network)):
        lane = network.lanes[int(lines.lanes[row])]
        along_x, along_y = lines.headings[row].tolist()
        across = np.array([-along_y, along_x]) * lines.half_widths[row]
        ends = _line(np.stack((lines.points[row] + across, lines.points[row] - across)))
        lights = [c.traffic_light for c in lane.connections if c.traffic_light]
        yield StopLineGeometry(
            lane=lane.id,
            junction=lane.to_junction,
            points=(ends[0], ends[1]),
            control=control,
            light=lights[0] if lights else "",
            movements=tuple(
                Movement(
                    to_edge=way.exit_edge,
                    via=tuple(network.lanes[inside].id for inside in way.inside),
                    direction=way.connection.direction,
                    right_of_way=way.connection.right_of_way,
                    link=way.connection.link_index if way.connection.traffic_light else -1,
                )
                for way in lines.ways[row]
            ),
        )


def _traffic_lights(
    network: RoadNetwork, lines: Iterable[StopLineGeometry]
) -> Iterator[TrafficLight]:
    ends = {line.lane: line.points for line in lines}
    signals: dict[str, list[tuple[Lane, Connection]]] = {}
    for lane in network.lanes:
        for connection in lane.connections:
            if connection.traffic_light:
                signals.setdefault(connection.traffic_light, []).append((lane, connection))
    for light, program in network.programs.items():
        found = sorted(signals.get(light, ()), key=lambda one: (one[1].link_index, one[0].index))
        if not found:
            continue
        middle = np.mean([lane.shape[-1] for lane, _ in found], axis=0)
        yield TrafficLight(
            id=light,
            position=_point(middle),
            links=tuple(
                LightLink(
                    index=connection.link_index,
                    lane=lane.id,
                    to_lane=network.lanes[connection.to_lane].id,
                    direction=connection.direction,
                    stop_line=ends.get(lane.id),
                )
                for lane, connection in found
            ),
            program=program.program_id,
            offset=program.offset,
            phases=tuple(
                Phase(duration=phase.duration, state=phase.state) for phase in program.phases
            ),
        )


def _signs(network: RoadNetwork, lines: Iterable[StopLineGeometry]) -> Iterator[Sign]:
    """Returns a sign for each edge, right of its rightmost lane that has one."""
    done: set[str] = set()
    for line in lines:
        lane = network.lane(line.lane)
        if line.control not in _SIGNS or lane.edge_id in done:
            continue
        # Lanes of an edge come from right to left.
        done.add(lane.edge_id)
        x, y, heading = lane.position_at(float(lane.arc[-1]))
        beside = 0.5 * lane.width + _BESIDE_ROAD
        yield Sign(
            kind=line.control,
            lane=lane.id,
            position=_point(
                np.array([x + beside * math.sin(heading), y - beside * math.cos(heading)])
            ),
            heading=round(math.degrees(heading), 1),
        )


def _line(shape: FloatArray) -> Line:
    return tuple(_point(place) for place in shape)


def _point(place: FloatArray) -> Point:
    x, y = place.tolist()
    return round(x, 2), round(y, 2)
