"""Views of a trace for oracles and metrics, ego by ego, with values that are computed once."""

from __future__ import annotations

import math
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray, Int32Array
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.drivable_area import outside_distance
from drivora_service.networks.lane_bends import tangent_gap
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.artefacts import Artefact, spoiling_artefact
from drivora_service.observations.motion import FilteredMotion, filter_motion
from drivora_service.observations.proximity import Proximity, look_around
from drivora_service.observations.trace import Actor, Col, EgoCol, EgoRoute, TerminalEvent, Trace

if TYPE_CHECKING:
    from drivora_service.observations.line_crossings import Crossing

_BEND_SHARE = 2.0
"""Factor by which a road's border may deviate further from its tangents than a lane's centre."""


class BorderCol(IntEnum):
    """Columns of ``EgoView.room_beside``."""

    LEFT = 0
    RIGHT = 1


class EgoView:
    """An ego's part of a run: from its start time to the end of its part.

    All arrays have n rows; row ``k`` here is row ``first + k`` of the trace. n is 0 for an ego
    whose part never began. A part that an artefact of the simulator spoilt ends in the row before
    it, which is the last that says something about the ego.

    Attributes:
        trace: The whole run.
        network: Its road network.
        row: Row of the ego in the trace.
        first: Row of the trace with which the arrays begin.
        count: Number n of rows.
        artefact: The contact that spoilt its part, made by the simulator; ``None`` for none.
        times: Seconds.
        states: (n, 9) columns ``Col``.
        values: (n, 8) columns ``EgoCol``.
        lanes: Index of the lane, -1 off all lanes.
        lights: ``Light``.
        speed: m/s over ground.
        forward_speed: m/s along the heading, negative backwards.
        moved: Metres since the preceding row, 0 in the first.
    """

    def __init__(self, trace: Trace, network: RoadNetwork, row: int) -> None:
        """Extracts the ego's part from the trace."""
        start = int(np.searchsorted(trace.times, trace.ego_start_times[row] - 1e-9))
        stop = trace.ego_end_steps[row] + 1
        gone = np.flatnonzero(~trace.present[start:stop, row])
        if len(gone):
            stop = start + int(gone[0])
        self.artefact: Artefact | None = spoiling_artefact(trace, row, start, stop)
        if self.artefact is not None:
            # One row is left to an ego that was placed in another actor.
            stop = max(self.artefact.step, start + 1)
        part = slice(start, max(stop, start))
        self.trace = trace
        self.network = network
        self.row = row
        self.first = start
        self.times: FloatArray = trace.times[part]
        self.states: FloatArray = trace.states[part, row]
        self.values: FloatArray = trace.ego_values[part, row]
        self.lanes: Int32Array = trace.ego_lanes[part, row]
        self.lights: ByteArray = trace.ego_lights[part, row]
        self.count = len(self.times)
        vx, vy, yaw = self.states[:, Col.VX], self.states[:, Col.VY], self.states[:, Col.YAW]
        self.speed: FloatArray = np.hypot(vx, vy)
        self.forward_speed: FloatArray = vx * elementary.cos(yaw) + vy * elementary.sin(yaw)
        steps = np.hypot(np.diff(self.states[:, Col.X]), np.diff(self.states[:, Col.Y]))
        self.moved: FloatArray = np.concatenate((np.zeros(min(self.count, 1)), steps))

    @property
    def actor(self) -> Actor:
        """The ego as an actor of the trace."""
        return self.trace.actors[self.row]

    @property
    def id(self) -> str:
        """Id of the ego."""
        return self.actor.id

    @property
    def step_length(self) -> float:
        """Seconds between rows."""
        return self.trace.step_length

    @property
    def route(self) -> EgoRoute:
        """The ego's route."""
        return self.trace.ego_routes[self.row]

    @property
    def end(self) -> TerminalEvent:
        """The event that ended its part."""
        return self.trace.ego_ends[self.row]

    @property
    def duration(self) -> float:
        """Seconds from its start to the end of its part."""
        return float(self.times[-1] - self.times[0]) if self.count else 0.0

    def value(self, column: EgoCol) -> FloatArray:
        """Returns a column (n,) of ``values``."""
        return self.values[:, column]

    def location(self, k: int) -> tuple[float, float]:
        """Returns x and y in metres at row ``k``."""
        return float(self.states[k, Col.X]), float(self.states[k, Col.Y])

    @cached_property
    def corners(self) -> FloatArray:
        """(n, 4, 2) corners of its box, metres; front left first, counter-clockwise."""
        return box_corners(
            self.states[:, Col.X],
            self.states[:, Col.Y],
            self.states[:, Col.YAW],
            self.actor.length,
            self.actor.width,
        )

    @cached_property
    def lane_half_widths(self) -> FloatArray:
        """(n,) half the width of its lane, metres; NaN off all lanes."""
        half_widths = np.full(self.count, np.nan)
        for lane in np.unique(self.lanes):
            if lane >= 0:
                half_widths[self.lanes == lane] = 0.5 * self.network.lanes[lane].width
        return half_widths

    @cached_property
    def lateral_reach(self) -> FloatArray:
        """(n,) metres that its box reaches from its centre across the lane; NaN off all lanes."""
        turn = self.states[:, Col.YAW] - self.value(EgoCol.LANE_HEADING)
        along = 0.5 * self.actor.length * np.abs(elementary.sin(turn))
        reach: FloatArray = along + 0.5 * self.actor.width * np.abs(elementary.cos(turn))
        return reach

    @cached_property
    def in_junction(self) -> BoolArray:
        """(n,) whether its lane is inside a junction."""
        inside = np.zeros(self.count, dtype=np.bool_)
        for lane in np.unique(self.lanes):
            if lane >= 0 and self.network.lanes[lane].is_internal:
                inside[self.lanes == lane] = True
        return inside

    @cached_property
    def outside(self) -> FloatArray:
        """(n,) distance of the outermost corner from the drivable area, metres."""
        furthest = np.zeros(self.count)
        unsure = np.flatnonzero(~self._within_lanes())
        if len(unsure):
            corners = self.corners[unsure].reshape(-1, 2)
            furthest[unsure] = outside_distance(self.network, corners).reshape(-1, 4).max(axis=1)
        return furthest

    @cached_property
    def room_beside(self) -> FloatArray:
        """(n, 2) metres between its box and the borders of its edge's lanes, ``BorderCol``.

        Negative where it reaches beyond them; NaN off all lanes.
        """
        lateral = self.value(EgoCol.LANE_LATERAL)
        room = np.full((self.count, len(BorderCol)), np.nan)
        for index in np.unique(self.lanes):
            if index < 0:
                continue
            here = np.flatnonzero(self.lanes == index)
            left, right = _road_beside(self.network, int(index))
            reach = self.lateral_reach[here]
            room[here, BorderCol.LEFT] = left - lateral[here] - reach
            room[here, BorderCol.RIGHT] = right + lateral[here] - reach
        return room

    def _within_lanes(self) -> BoolArray:
        """Returns the flags of rows in which the box is certainly within its edge's lanes.

        ``room_beside`` assumes a straight lane. So rows are excluded in which the box may reach
        over an end of its lane, and those with less room than the lane's bends may need.
        """
        reach = 0.5 * math.hypot(self.actor.length, self.actor.width)
        room = self.room_beside.min(axis=1, initial=np.inf)
        within = np.zeros(self.count, dtype=np.bool_)
        for index in np.unique(self.lanes).tolist():
            if index < 0:
                continue
            here = np.flatnonzero(self.lanes == index)
            states, inside = self.states[here], np.ones(len(here), dtype=np.bool_)
            for x, y in self.network.lanes[index].shape[[0, -1]].tolist():
                away = (states[:, Col.X] - x) ** 2 + (states[:, Col.Y] - y) ** 2
                inside &= away > reach**2 + self.value(EgoCol.LANE_LATERAL)[here] ** 2
            allowance = _BEND_SHARE * tangent_gap(self.network, index, reach)
            within[here] = inside & (room[here] >= allowance)
        return within

    @cached_property
    def proximity(self) -> Proximity:
        """Its proximity to other actors."""
        return look_around(self.trace, self.row, self.first, self.first + self.count)

    @cached_property
    def crossings(self) -> tuple[Crossing, ...]:
        """Its crossings of stop lines in the order of time."""
        # Imported here, since finding them needs this class.
        from drivora_service.observations.line_crossings import find_line_crossings

        return find_line_crossings(self)

    @cached_property
    def motion(self) -> FilteredMotion | None:
        """Its filtered motion; None if its part is too short to filter."""
        return filter_motion(self.states, self.step_length)


def _road_beside(network: RoadNetwork, index: int) -> tuple[float, float]:
    """Returns the metres of road of the same edge, left and right of a lane's centre line."""
    lane = network.lanes[index]
    left = right = 0.5 * lane.width
    beside = lane.left
    while beside >= 0:
        left += network.lanes[beside].width
        beside = network.lanes[beside].left
    beside = lane.right
    while beside >= 0:
        right += network.lanes[beside].width
        beside = network.lanes[beside].right
    return left, right


class RunView:
    """A view of a run for oracles and metrics.

    Attributes:
        trace: The recorded run.
        network: The road network it took place on.
        egos: Egos in the order of the trace.
    """

    def __init__(self, trace: Trace, network: RoadNetwork) -> None:
        """Creates a view of each ego; costly values are computed on first use."""
        self.trace = trace
        self.network = network
        self.egos = tuple(EgoView(trace, network, row) for row in range(trace.ego_count))
