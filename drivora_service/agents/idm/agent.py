"""A rule-based ADS: car following by the intelligent driver model, steering by pure pursuit.

It obeys traffic lights and the network's right of way, yields in conflict zones by gap acceptance,
keeps junctions clear, changes lanes where its route needs it, and never overtakes. Source of the
car-following model: Treiber, Hennecke, Helbing, *Congested traffic states in empirical observations
and microscopic simulations* (2000); of the steering: Coulter, *Implementation of the pure pursuit
path tracking algorithm* (1992).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.idm.conflicts import Conflicts, find_conflicts
from drivora_service.agents.idm.driving import decide, lane_is_free
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.agents.speed_profile import slow_down_in_time
from drivora_service.networks.lane_route import LaneRun
from drivora_service.networks.line_tracking import track_line

FloatArray = NDArray[np.float64]

_SIDE_ACCELERATION = 2.2
_PLANNED_BRAKING = 1.8
_SMOOTHING = 5
_STANDING_SPEED = 0.2
_LONGEST_WAIT = 10.0


class IdmAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, speed_factor: float = 1.0) -> None:
        """Args: speed_factor: Share of the speed limit that it drives where the road is free."""
        self._speed_factor = speed_factor

    def setup_env(self, context: AgentContext) -> None:
        """Prepares speed profiles and conflict zones along the route."""
        self._context = context
        model = context.model
        self._half_length, self._half_width = 0.5 * model.length, 0.5 * model.width
        self._runs = context.route.runs
        self._profiles = [
            speed_profile(run, self._speed_factor, context.friction) for run in self._runs
        ]
        self._conflicts: list[Conflicts] = [
            find_conflicts(context.network, run, context.route) for run in self._runs
        ]
        self._current = 0
        self._cursor = int(np.searchsorted(self._runs[0].arc, self._runs[0].start_s))
        self._car = np.array(
            [
                self._half_length,
                self._half_width,
                model.wheelbase,
                min(model.max_deceleration, 9.81 * context.friction),
                context.step_length,
            ]
        )
        self._out = np.zeros(8)
        self._fixed = [self._arguments(number) for number in range(len(self._runs))]
        self._step_length = context.step_length
        self._waited = 0.0
        self._log = context.log
        self._log.declare("gap", "wanted_speed", "halt_distance")

    def _arguments(self, number: int) -> tuple[Any, ...]:
        """Gives the last arguments of ``decide``, which stay the same along a lane run."""
        run, zones = self._runs[number], self._conflicts[number]
        is_last = number == len(self._runs) - 1
        return (
            self._car, math.inf if is_last else run.end_s,
            np.column_stack((run.line, run.arc, self._profiles[number])),
            zones.zones, zones.first, zones.foes, self._out,
        )  # fmt: skip

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Drives."""
        speed = observation.speed
        if speed < _STANDING_SPEED:
            self._waited = min(self._waited + self._step_length, _LONGEST_WAIT)
        else:
            self._waited = max(self._waited - self._step_length, 0.0)
        if self._current < len(self._runs) - 1:
            self._change_lane_when_possible(observation)
        self._cursor = decide(
            speed, self._cursor, self._waited, observation.light_distance,
            int(observation.light), observation.light_protected, observation.ego,
            observation.objects, observation.object_sizes, observation.object_kinds,
            *self._fixed[self._current],
        )  # fmt: skip
        acceleration, steer, gap, _, _, stop, _, wanted = self._out.tolist()
        row = self._log.row
        row[0], row[1], row[2] = gap, wanted, stop
        return AccelerationControl(acceleration, steer)

    def _change_lane_when_possible(self, observation: Observation) -> None:
        run, onward = self._runs[self._current], self._runs[self._current + 1]
        if float(run.arc[self._cursor]) < run.change_from:
            return
        x, y = observation.ego[:2].tolist()
        near = np.hypot(onward.line[:, 0] - x, onward.line[:, 1] - y)
        window = np.flatnonzero(onward.arc >= onward.start_s - 5.0)
        first = int(window[0]) if len(window) else 0
        start = first + int(np.argmin(near[first:]))
        cursor, s, _ = track_line(onward.line, onward.arc, start, 5, 5, x, y)
        if lane_is_free(
            onward.line, onward.arc, cursor, s, observation.speed, self._half_length,
            observation.objects, observation.object_sizes, len(observation.objects),
        ):  # fmt: skip
            self._current += 1
            self._cursor = cursor
            self._log.event(f"changes to lane {onward.lanes[0]}")


@lru_cache(maxsize=256)
def speed_profile(run: LaneRun, speed_factor: float, friction: float) -> FloatArray:
    """Gives the speed to drive at each point of a lane run, (n,) m/s; not to be changed."""
    step = np.diff(run.line, axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    span = np.maximum(np.hypot(step[:, 0], step[:, 1]), 0.2)
    turn = np.abs(np.diff(heading))
    bend = np.zeros(len(run.line))
    bend[1:-1] = turn / (0.5 * (span[:-1] + span[1:]))
    bend = np.convolve(bend, np.ones(_SMOOTHING) / _SMOOTHING, mode="same")
    side = _SIDE_ACCELERATION * friction
    speed = np.minimum(run.speed_limits * speed_factor, np.sqrt(side / np.maximum(bend, 1e-4)))
    speed = np.maximum(speed, 2.0)
    brake = _PLANNED_BRAKING * friction
    slow_down_in_time(speed, run.arc, brake)
    return speed
