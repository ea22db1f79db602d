"""The own way of a vehicle, and the speeds that it allows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.projection import project_points
from drivora_service.networks.road_network import Connection, RoadNetwork
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col

_AHEAD = 80.0
"""Metres of a vehicle's own way that it looks ahead."""

COMFORT = 4.5
"""m/s² with which a vehicle slows for its own way, and beyond which no driver brakes without a
reason (SUMO's default deceleration)."""

SLOWER = (0.85, 1.0)
"""Share of the speed that its way allows, and m/s below that, from which on a vehicle is slower
than its way asks: drivers differ by a tenth or so (SUMO's ``speedFactor``)."""

BESIDE = 2.5
"""Metres from a vehicle's path up to which an actor is ahead of it."""

_SIDEWAYS = 3.0
"""m/s² sideways up to which a vehicle drives through a bend."""

_FINE = 0.25
"""Metres between the places of a way at which the nearest to an actor is looked for."""

_YIELDS = "ms="
"""SUMO's letters of connections before which a vehicle may have to slow down for others."""


class Course(NamedTuple):
    """The way of a vehicle from one of its rows on: recorded, and straight on after the record.

    Attributes:
        arc: (p,) metres from its place in that row.
        x, y, yaw: (p,) its places and headings there.
    """

    arc: FloatArray
    x: FloatArray
    y: FloatArray
    yaw: FloatArray

    def arc_at(self, state: FloatArray) -> float:
        """Returns the arc length of the place nearest to a state, metres."""
        away = np.hypot(self.x - state[Col.X], self.y - state[Col.Y])
        return float(self.arc[int(np.argmin(away))])

    def locate(self, state: FloatArray) -> tuple[float, float]:
        """Returns the arc length of the place nearest to a state, and its distance, metres.

        Between the places of the way as well, which are far apart on straight lanes.
        """
        arcs = np.linspace(0.0, float(self.arc[-1]), max(2, math.ceil(self.arc[-1] / _FINE)))
        away = np.hypot(
            np.interp(arcs, self.arc, self.x) - state[Col.X],
            np.interp(arcs, self.arc, self.y) - state[Col.Y],
        )
        nearest = int(np.argmin(away))
        return float(arcs[nearest]), float(away[nearest])


def follow_course(ego: EgoView, other: int, onset: int) -> Course:
    """Returns the way of a vehicle from a row of the trace on."""
    trace = ego.trace
    gone = np.flatnonzero(~trace.present[onset:, other])
    states = trace.states[onset : onset + int(gone[0]) if len(gone) else None, other]
    # Places of a vehicle that stands are one: a way needs places in order.
    arc = arc_lengths(states[:, [Col.X, Col.Y]])
    moves = np.concatenate(([True], np.diff(arc) > 1e-6))
    states, arc = states[moves], arc[moves]
    yaw = np.unwrap(states[:, Col.YAW])
    end = states[-1]
    return Course(
        arc=np.append(arc, arc[-1] + _AHEAD),
        x=np.append(states[:, Col.X], end[Col.X] + _AHEAD * math.cos(end[Col.YAW])),
        y=np.append(states[:, Col.Y], end[Col.Y] + _AHEAD * math.sin(end[Col.YAW])),
        yaw=np.append(yaw, yaw[-1]),
    )


def lane_course(ego: EgoView, other: int, onset: int, lanes: frozenset[int]) -> Course | None:
    """Returns the way that a vehicle's lane leads through a junction by one of some lanes.

    A vehicle that swerves round an ego leaves it. None if its lane does not lead onto ``lanes``.
    """
    network, state = ego.network, ego.trace.states[onset, other]
    place = project_points(network, state[None, [Col.X, Col.Y]], state[None, Col.YAW])
    lane = int(place.lane[0])
    if lane < 0:
        return None
    chain = [lane]
    following = [one.to_lane for one in network.lanes[lane].connections if one.to_lane in lanes]
    while following:
        chain.append(following[0])
        last = network.lanes[chain[-1]]
        following = [one.to_lane for one in last.connections] if last.is_internal else []
    if len(chain) < 2:
        return None
    points = np.vstack([network.lanes[one].shape for one in chain])
    arc = arc_lengths(points)
    moves = np.concatenate(([True], np.diff(arc) > 1e-6))
    points, arc = points[moves], arc[moves] - float(place.s[0])
    ahead = np.diff(points, axis=0)
    yaw = np.unwrap([math.atan2(dy, dx) for dx, dy in ahead.tolist()])
    return Course(arc=arc, x=points[:, 0], y=points[:, 1], yaw=np.append(yaw, yaw[-1]))


def allowed_speeds(ego: EgoView, course: Course, onset: int, lanes: frozenset[int]) -> FloatArray:
    """Returns (p,) m/s that a vehicle's own way allows at the places of its course.

    By the limits of its lanes, its bends, and the lines at which its own signal or sign may stop
    it, each with comfortable braking before. At the line before ``lanes`` no sign does: there it
    goes before the ego.
    """
    network = ego.network
    found = project_points(
        network, np.column_stack((course.x, course.y)), np.ascontiguousarray(course.yaw)
    )
    speeds: FloatArray = np.array(
        [network.lanes[lane].speed_limit if lane >= 0 else np.inf for lane in found.lane.tolist()]
    )
    speeds[:] = np.minimum(speeds, _bend_speeds(course))
    for p in range(1, len(course.arc)):
        lane, following = int(found.lane[p - 1]), int(found.lane[p])
        if lane < 0 or lane == following or following in lanes:
            continue
        if _may_stop(ego, network, lane, following, onset):
            speeds[p - 1] = 0.0
    # Backwards: at each place what the braking for all places after it allows.
    for p in range(len(speeds) - 2, -1, -1):
        gap = float(course.arc[p + 1] - course.arc[p])
        speeds[p] = min(speeds[p], math.sqrt(speeds[p + 1] ** 2 + 2.0 * COMFORT * gap))
    return speeds


def _bend_speeds(course: Course) -> FloatArray:
    """Returns (p,) m/s at which a vehicle drives through the bends of its course."""
    speeds = np.full(len(course.arc), np.inf)
    for p in range(len(course.arc)):
        # Over some metres, as headings between two rows are noisy.
        begin, end = (
            int(np.searchsorted(course.arc, course.arc[p] + side * 2.0)) for side in (-1.0, 1.0)
        )
        end = min(end, len(course.arc) - 1)
        length = float(course.arc[end] - course.arc[begin])
        turned = abs(float(course.yaw[end] - course.yaw[begin]))
        if length > 0.5 and turned > 1e-3:
            speeds[p] = math.sqrt(_SIDEWAYS * length / turned)
    return speeds


def _may_stop(ego: EgoView, network: RoadNetwork, lane: int, following: int, row: int) -> bool:
    """Returns whether a vehicle may have to stop at the end of a lane for a signal or a sign."""
    connections = network.lanes[lane].connections
    here = next((one for one in connections if one.to_lane == following), None)
    if here is None:
        return False
    letter = _letter(ego, here, row)
    return here.right_of_way in _YIELDS if letter is None else letter not in "Gg"


def _letter(ego: EgoView, connection: Connection, row: int) -> str | None:
    trace = ego.trace
    if connection.traffic_light not in trace.light_ids:
        return None
    state = trace.light_states[row, trace.light_ids.index(connection.traffic_light)]
    letter: str = trace.light_state_names[state][connection.link_index]
    return letter
