"""Vehicles that wait for an ego that stands in a junction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import LineString, Point, Polygon
from shapely.ops import substring

from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.projection import project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.leaders import VEHICLES
from drivora_service.observations.recorded_signals import signal_in_run
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Actor, Col, Light
from drivora_service.oracles.junction_stands.paths import line_through
from drivora_service.oracles.junction_stands.stands import STRIP, JunctionStand

_REACH = 25.0
"""Metres along its way from a vehicle's front to the ego within which it may be waiting for it."""

_STANDING = 0.5
"""m/s below which a vehicle waits."""

_SAMPLE = 0.5
"""Seconds between the rows that are checked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitingVehicle:
    """A vehicle that waits for an ego.

    Attributes:
        id: Its id.
        seconds: Time for which it stood with the ego in its way.
    """

    id: str
    seconds: float


def waiting_vehicles(
    ego: EgoView, stand: JunctionStand, rows: tuple[int, ...]
) -> tuple[WaitingVehicle, ...]:
    """Returns the vehicles that stood before an ego, from the longest to the shortest wait.

    They drive on a way that leads over the ego's place, from its side or from behind it, with no
    other actor between and no red signal before them.

    Args:
        ego: The ego.
        stand: Its stay in a junction.
        rows: Rows of the ego that count.
    """
    stride = max(round(_SAMPLE / ego.step_length), 1)
    steps = [ego.first + row for row in rows[::stride]]
    found = []
    for actor in ego.trace.actors:
        if actor.row == ego.row or actor.role not in VEHICLES:
            continue
        count = sum(_waits(ego, stand, actor, step) for step in steps)
        if count:
            seconds = min(count * stride, len(rows)) * ego.step_length
            found.append(WaitingVehicle(id=actor.id, seconds=seconds))
    return tuple(sorted(found, key=lambda one: (-one.seconds, one.id)))


def _waits(ego: EgoView, stand: JunctionStand, actor: Actor, step: int) -> bool:
    trace = ego.trace
    state = trace.states[step, actor.row]
    if not trace.present[step, actor.row]:
        return False
    if np.hypot(state[Col.VX], state[Col.VY]) >= _STANDING:
        return False
    if abs(state[Col.Z] - ego.states[stand.rows[-1], Col.Z]) > LEVEL_GAP:
        return False
    if stand.box.distance(Point(state[Col.X], state[Col.Y])) > _REACH + actor.length:
        return False
    others = [
        one
        for one in trace.actors
        if one.row not in (ego.row, actor.row) and trace.present[step, one.row]
    ]
    there = trace.states[step, [one.row for one in others]].reshape(-1, len(Col))
    boxes = shapely.polygons(
        box_corners(
            there[:, Col.X],
            there[:, Col.Y],
            there[:, Col.YAW],
            np.array([one.length for one in others]),
            np.array([one.width for one in others]),
        )
    )
    for way, front in _ways(ego, actor, step):
        room = _room(way, front, stand.box)
        if room is None:
            continue
        before = substring(way, front, front + room).buffer(STRIP, cap_style="flat")
        if not shapely.intersects(before, boxes).any():
            return True
    return False


def _room(way: LineString, front: float, box: Polygon) -> float | None:
    """Returns the metres from a front along a way to a box; None if it is not on the way."""
    part = substring(way, front, front + _REACH)
    if not isinstance(part, LineString) or not part.buffer(STRIP, cap_style="flat").intersects(box):
        return None
    near = part.buffer(STRIP, cap_style="flat").intersection(box)
    corners = shapely.points(shapely.get_coordinates(near))
    return float(shapely.line_locate_point(part, corners).min())


def _ways(ego: EgoView, actor: Actor, step: int) -> Iterator[tuple[LineString, float]]:
    """Yields the ways that a vehicle may go on, with the metres along each to its front."""
    network = ego.network
    place = ego.trace.states[[step], actor.row]
    lane = int(project_points(network, place[:, [Col.X, Col.Y]], place[:, Col.YAW]).lane[0])
    if lane < 0:
        return
    here = network.lanes[lane]
    if here.is_internal:
        starts = [_through(network, lane)]
    else:
        starts = []
        for connection in here.connections:
            shown = signal_in_run(ego.trace, connection)
            if shown is None or shown[step] != Light.RED:
                starts.append((lane, *_through(network, connection.to_lane)))
    for lanes in starts:
        way = line_through(network, lanes)
        yield way, float(way.project(Point(place[0, :2]))) + 0.5 * actor.length


def _through(network: RoadNetwork, lane: int) -> tuple[int, ...]:
    """Returns a lane in a junction, and those that follow it, up to the first one behind."""
    lanes = [lane]
    while network.lanes[lanes[-1]].is_internal and network.lanes[lanes[-1]].connections:
        following = network.lanes[lanes[-1]].connections[0].to_lane
        if following in lanes:
            break
        lanes.append(following)
    return tuple(lanes)
