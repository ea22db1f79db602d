"""Following the lane runs of a route, with their profiles and lane changes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from drivora_service.agents.idm.conflicts import Conflicts, find_conflicts
from drivora_service.agents.idm.corridor import lane_is_free, perceived_actors
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.speed_profile import free_speeds
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.lane_route import LaneRoute, LaneRun
from drivora_service.networks.routes.line_tracking import track_line

STANDING_SPEED = 0.2
LONGEST_WAIT = 10.0
_JOIN_REACH = 15.0
"""Metres along the next lane run, before and after the change window, in which the ego
is searched."""


class WayCol(IntEnum):
    """Columns of ``Way.points``."""

    X = 0
    Y = 1
    ARC = 2
    """Arc length, metres."""
    WANTED = 3
    """Desired speed, m/s."""


class Goal(NamedTuple):
    """A destination and the direction there, a unit vector."""

    x: float
    y: float
    ahead_x: float
    ahead_y: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Way:
    """A lane run with what a driver needs of it.

    Attributes:
        points: (n, 4) its line, columns ``WayCol``.
        wall: Arc length before which it must have been left; inf if it leads to the destination.
        goal: The destination; ``None`` if the run is left before.
    """

    run: LaneRun
    points: FloatArray
    conflicts: Conflicts
    wall: float
    goal: Goal | None


class RunFollower:
    """An ego's place among the lane runs of its route.

    Attributes:
        ways: The lane runs in order.
        current: Index of the followed one.
        cursor: Last segment of the ego on it.
        waited: Seconds that the ego has stood; decreases while it moves.
    """

    def __init__(self, context: AgentContext, speed_factor: float) -> None:
        """Args: speed_factor: Share of the speed limit to drive on a free road."""
        self._context = context
        self._speed_factor = speed_factor
        self._half_length = 0.5 * context.model.length
        self.waited = 0.0
        route = context.route
        self.follow(route, int(np.searchsorted(route.runs[0].arc, route.runs[0].start_s)))

    def follow(self, route: LaneRoute, cursor: int) -> None:
        """Changes to another route, from a segment of its first lane run on."""
        network, friction = self._context.network, self._context.friction
        profiles = [speed_profile(run, self._speed_factor, friction) for run in route.runs]
        last = len(route.runs) - 1
        self.ways = tuple(
            Way(
                run=run,
                points=np.column_stack((run.line, run.arc, profile)),
                conflicts=find_conflicts(network, run, route),
                wall=math.inf if number == last else run.end_s,
                goal=_goal(run) if number == last else None,
            )
            for number, (run, profile) in enumerate(zip(route.runs, profiles, strict=True))
        )
        self.current = 0
        self.cursor = cursor

    @property
    def way(self) -> Way:
        """The way that is followed now."""
        return self.ways[self.current]

    @property
    def onward(self) -> LaneRun | None:
        """The lane run to change to next."""
        return self.ways[self.current + 1].run if self.current + 1 < len(self.ways) else None

    def wait(self, speed: float) -> None:
        """Counts the time that the ego stands; called once in each step."""
        step = self._context.step_length
        if speed < STANDING_SPEED:
            self.waited = min(self.waited + step, LONGEST_WAIT)
        else:
            self.waited = max(self.waited - step, 0.0)

    def change_when_possible(self, observation: Observation) -> bool:
        """Changes to the next lane run if the route allows it and there is room."""
        if self.current + 1 == len(self.ways):
            return False
        run, onward = self.ways[self.current].run, self.ways[self.current + 1].run
        if float(run.arc[self.cursor]) < run.change_from:
            return False
        x, y = observation.ego[:2].tolist()
        near = np.hypot(onward.line[:, 0] - x, onward.line[:, 1] - y)
        # The run may pass here again later, on another lap.
        room = float(run.arc[self.cursor]) - run.change_from
        beyond = np.abs(onward.arc - onward.start_s - 0.5 * room) > 0.5 * room + _JOIN_REACH
        near[beyond] = np.inf
        start = int(np.argmin(near))
        cursor, s, _ = track_line(onward.line, onward.arc, start, 5, 5, x, y)
        if not lane_is_free(
            onward.line, onward.arc, cursor, s, observation.speed, self._half_length,
            perceived_actors(observation),
        ):  # fmt: skip
            return False
        self.current += 1
        self.cursor = cursor
        self._context.log.event(f"changes to lane {onward.lanes[0]}")
        return True


def _goal(run: LaneRun) -> Goal:
    """Returns the end of the last lane run."""
    ends = np.clip([run.end_s - 0.5, run.end_s + 0.5], 0.0, float(run.arc[-1]))
    (x0, x1), (y0, y1) = (np.interp(ends, run.arc, run.line[:, axis]) for axis in (0, 1))
    x, y = (float(np.interp(run.end_s, run.arc, run.line[:, axis])) for axis in (0, 1))
    length = max(math.hypot(x1 - x0, y1 - y0), 1e-9)
    return Goal(x, y, float((x1 - x0) / length), float((y1 - y0) / length))


@lru_cache(maxsize=256)
def speed_profile(run: LaneRun, speed_factor: float, friction: float) -> FloatArray:
    """Returns the speed to drive at each point of a lane run, (n,) m/s; must not be changed."""
    return free_speeds(run.line, run.arc, run.speed_limits * speed_factor, friction)
