"""Which lane run of its route an agent follows, what it needs along it, and when it changes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.idm.conflicts import Conflicts, find_conflicts
from drivora_service.agents.idm.corridor import lane_is_free
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.speed_profile import slow_down_in_time
from drivora_service.networks.lane_route import LaneRoute, LaneRun
from drivora_service.networks.line_tracking import track_line

FloatArray = NDArray[np.float64]

STANDING_SPEED = 0.2
LONGEST_WAIT = 10.0
_SIDE_ACCELERATION = 2.2
_PLANNED_BRAKING = 1.8
_SMOOTHING = 5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Way:
    """A lane run, prepared for driving.

    Attributes:
        points: (n, 4) x, y and arc length of its line, and the speed to drive there, m/s.
        wall: Arc length before which it must have been left; inf where it leads to the destination.
    """

    run: LaneRun
    points: FloatArray
    conflicts: Conflicts
    wall: float


class RunFollower:
    """An ego's place among the lane runs of its route.

    Attributes:
        ways: The lane runs in order.
        current: Index of the one that is followed.
        cursor: Segment of it that the ego was found on last.
        waited: Seconds that the ego has stood; runs down again while it moves.
    """

    def __init__(self, context: AgentContext, speed_factor: float) -> None:
        """Args: speed_factor: Share of the speed limit to drive where the road is free."""
        self._context = context
        self._speed_factor = speed_factor
        self._half_length = 0.5 * context.model.length
        self.waited = 0.0
        route = context.route
        self.follow(route, int(np.searchsorted(route.runs[0].arc, route.runs[0].start_s)))

    def follow(self, route: LaneRoute, cursor: int) -> None:
        """Takes another route, beginning at a segment of its first lane run."""
        network, friction = self._context.network, self._context.friction
        profiles = [speed_profile(run, self._speed_factor, friction) for run in route.runs]
        last = len(route.runs) - 1
        self.ways = tuple(
            Way(
                run=run,
                points=np.column_stack((run.line, run.arc, profile)),
                conflicts=find_conflicts(network, run, route),
                wall=math.inf if number == last else run.end_s,
            )
            for number, (run, profile) in enumerate(zip(route.runs, profiles, strict=True))
        )
        self.current = 0
        self.cursor = cursor

    @property
    def way(self) -> Way:
        """What is followed now."""
        return self.ways[self.current]

    @property
    def onward(self) -> LaneRun | None:
        """The lane run to change to next."""
        return self.ways[self.current + 1].run if self.current + 1 < len(self.ways) else None

    def wait(self, speed: float) -> None:
        """Counts the time that the ego stands; to be called once a step."""
        step = self._context.step_length
        if speed < STANDING_SPEED:
            self.waited = min(self.waited + step, LONGEST_WAIT)
        else:
            self.waited = max(self.waited - step, 0.0)

    def change_when_possible(self, observation: Observation) -> bool:
        """Goes over to the next lane run where the route allows it and there is room."""
        run, onward = self.way.run, self.onward
        if onward is None or float(run.arc[self.cursor]) < run.change_from:
            return False
        x, y = observation.ego[:2].tolist()
        near = np.hypot(onward.line[:, 0] - x, onward.line[:, 1] - y)
        window = np.flatnonzero(onward.arc >= onward.start_s - 5.0)
        first = int(window[0]) if len(window) else 0
        start = first + int(np.argmin(near[first:]))
        cursor, s, _ = track_line(onward.line, onward.arc, start, 5, 5, x, y)
        if not lane_is_free(
            onward.line, onward.arc, cursor, s, observation.speed, self._half_length,
            observation.objects, observation.object_sizes, len(observation.objects),
        ):  # fmt: skip
            return False
        self.current += 1
        self.cursor = cursor
        self._context.log.event(f"changes to lane {onward.lanes[0]}")
        return True


@lru_cache(maxsize=256)
def speed_profile(run: LaneRun, speed_factor: float, friction: float) -> FloatArray:
    """Gives the speed to drive at each point of a lane run, (n,) m/s; not to be changed."""
    step = np.diff(run.line, axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    span = np.maximum(np.hypot(step[:, 0], step[:, 1]), 0.2)
    turn = np.abs(np.diff(heading))
    bend = np.zeros(len(run.line))
    bend[1:-1] = turn / (0.5 * (span[:-1] + span[1:]))
    if len(bend) >= _SMOOTHING:
        bend = np.convolve(bend, np.ones(_SMOOTHING) / _SMOOTHING, mode="same")
    side = _SIDE_ACCELERATION * friction
    speed = np.minimum(run.speed_limits * speed_factor, np.sqrt(side / np.maximum(bend, 1e-4)))
    speed = np.maximum(speed, 2.0)
    brake = _PLANNED_BRAKING * friction
    slow_down_in_time(speed, run.arc, brake)
    return speed
