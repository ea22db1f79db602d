"""A party of a collision: its positions and lanes in the seconds before."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from drivora_service.geometry import elementary
from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.geometry.lines import arc_lengths
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.projection import LaneProjections, project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.recorded_conditions import frictions_under
from drivora_service.observations.trace import Actor, Col, Trace
from drivora_service.oracles.responsibility.lane_areas import intrusion, lane_areas

GRAVITY = 9.81
"""m/s²."""

WINDOW = 10.0
"""Seconds before the contact that are considered: the competent driver of R157 stops in less from
60 m/s on a dry road (1.15 s of reaction, half of the ramp of 0.6 s, and 60 / 7.6 s)."""

INTRUSION = 0.3
"""Metres across the edge of a lane from which on an actor is in it (UNECE R157, 5.2.5.2)."""

_FACING = 1.4
"""Radians between heading and lane below which an actor faces the lane's direction: less than a
right angle, at which it goes across."""

_HELD = 0.1
"""Metres within which an actor that stands may be moved without counting as driven."""


class Party:
    """A party of a collision, in the rows up to the contact.

    Attributes:
        actor: The actor of the trace.
        first: Row of the trace with which the arrays begin: the first in which it was present
            without a break, within ``WINDOW``.
        states: (n, 9), columns ``Col``; the last row is that of the contact.
        speed: m/s over ground on the way into the contact.
        from_beginning: Whether it was there when the record began, so that what it did before is
            unknown.
        grip: (n,) m/s² that its tyres could transmit at each row; inf if it is not recorded.
        appeared: Whether it was added after the record had begun.
    """

    def __init__(
        self, trace: Trace, network: RoadNetwork, actor: Actor, step: int, speed: float
    ) -> None:
        """Extracts its rows from the trace."""
        earliest = max(0, step - round(WINDOW / trace.step_length))
        absent = np.flatnonzero(~trace.present[earliest : step + 1, actor.row])
        self.first = earliest + (int(absent[-1]) + 1 if len(absent) else 0)
        self.actor = actor
        self.network = network
        self.step_length = trace.step_length
        self.states: FloatArray = trace.states[self.first : step + 1, actor.row]
        self.speed = speed
        self.from_beginning = self.first == 0
        self.appeared = self.first > 0 and not trace.present[self.first - 1, actor.row]
        self.grip: FloatArray = GRAVITY * np.nan_to_num(
            frictions_under(trace, actor, self.first, self.states), nan=math.inf
        )
        self._areas = lane_areas(network)

    @property
    def count(self) -> int:
        """Number n of rows."""
        return len(self.states)

    @property
    def yaw(self) -> float:
        """Heading at the contact, radians."""
        return float(self.states[-1, Col.YAW])

    @cached_property
    def boxes(self) -> tuple[Polygon, ...]:
        """The box at each row."""
        corners = box_corners(
            self.states[:, Col.X],
            self.states[:, Col.Y],
            self.states[:, Col.YAW],
            self.actor.length,
            self.actor.width,
        )
        return tuple(Polygon(four) for four in corners)

    @cached_property
    def travelled(self) -> FloatArray:
        """(n,) metres driven since the first row."""
        arc: FloatArray = arc_lengths(self.states[:, [Col.X, Col.Y]])
        return arc

    @cached_property
    def stood(self) -> float:
        """Seconds for which it had stood at its place of the contact."""
        away = np.hypot(
            self.states[:, Col.X] - self.states[-1, Col.X],
            self.states[:, Col.Y] - self.states[-1, Col.Y],
        )
        gone = np.flatnonzero(away > _HELD)
        last = int(gone[-1]) + 1 if len(gone) else 0
        return (self.count - 1 - last) * self.step_length

    @cached_property
    def _projections(self) -> LaneProjections:
        return project_points(self.network, self.states[:, [Col.X, Col.Y]], self.states[:, Col.YAW])

    @cached_property
    def lanes(self) -> Int32Array:
        """(n,) index of its lane, of those in its direction if there are any."""
        lanes: Int32Array = self._projections.lane
        return lanes

    def turned(self, heading: float) -> FloatArray:
        """Returns (n,) radians from the direction of its lane to its heading.

        Args:
            heading: Direction that stands for that of its lane where it is on none, radians.
        """
        lane = np.where(self.lanes >= 0, self._projections.heading, heading)
        turned: FloatArray = np.array(
            [wrap_angle(float(turn)) for turn in self.states[:, Col.YAW] - lane]
        )
        return turned

    def sideways(self, seconds: float, heading: float) -> float:
        """Returns the metres that it went to its left across its lane's axis until the contact.

        Args:
            seconds: Time before the contact.
            heading: See ``turned``.
        """
        rows = slice(max(self.count - round(seconds / self.step_length), 1), None)
        driven = np.diff(self.travelled, prepend=0.0)
        turned = self.turned(heading)
        # In a lane of the other direction the axis is the same.
        across = elementary.sin(turned) * np.sign(elementary.cos(turned))
        return float((driven * across)[rows].sum())

    @cached_property
    def with_lane(self) -> tuple[bool, ...]:
        """Whether it faced the direction of its lane at each row; False off all lanes."""
        return tuple(
            lane >= 0
            and self._areas.turn(int(lane), self.place(k), float(self.states[k, Col.YAW])) < _FACING
            for k, lane in enumerate(self.lanes.tolist())
        )

    def place(self, k: int) -> tuple[float, float]:
        """Returns x and y of its centre at a row, metres."""
        return float(self.states[k, Col.X]), float(self.states[k, Col.Y])

    def entry(self, area: BaseGeometry, heading: float) -> int | None:
        """Returns the row from which on it was in an area up to the contact.

        Args:
            area: A lane, or several.
            heading: Their direction, radians.

        Returns:
            A row of these arrays, 0 if it was there as long as is known; None if at the contact it
            reached into the area by less than ``INTRUSION``.
        """
        # Of an actor so narrow as a pedestrian half is enough.
        least = min(INTRUSION, 0.5 * self.actor.width)
        if self._depth(self.count - 1, area, heading) < least:
            return None
        return self._since(least, area, heading)

    def reach(self, area: BaseGeometry, heading: float) -> int:
        """Returns the row from which on it reached into an area about as far as at the contact.

        Of an actor that touches an area with its edge only, which ``entry`` takes for outside.
        """
        depth = self._depth(self.count - 1, area, heading)
        return self._since(0.5 * depth, area, heading) if depth > 0.0 else self.count - 1

    def _since(self, least: float, area: BaseGeometry, heading: float) -> int:
        # Backwards: what counts is the last time that it came in, not an earlier visit.
        for k in range(self.count - 1, -1, -1):
            if self._depth(k, area, heading) < least:
                return k + 1
        return 0

    def _depth(self, k: int, area: BaseGeometry, heading: float) -> float:
        actor, yaw = self.actor, float(self.states[k, Col.YAW])
        return intrusion(self.boxes[k], yaw, actor.length, actor.width, area, heading)

    def step(self, k: int) -> int:
        """Returns the row of the trace for a row of these arrays."""
        return self.first + k
