"""Driving along lane runs like the intelligent-driver agent, for agents based on it."""

from __future__ import annotations

from typing import Any

import numpy as np

from drivora_service.agents.idm.driving import decide
from drivora_service.agents.idm.run_following import RunFollower, Way
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation

LOST = 8.0
"""Metres beside its line from which on the driver is lost, and stops."""

GIVING_UP_BRAKING = 3.0
"""m/s² with which it stops if it is lost or past its destination."""

_PAST_GOAL = 2.0
_NEAR_GOAL = 30.0


class IdmDriver:
    """Follows the way of a ``RunFollower``, and logs the situation ahead."""

    def __init__(self, context: AgentContext) -> None:
        model = context.model
        self._car = np.array(
            [
                0.5 * model.length,
                0.5 * model.width,
                model.wheelbase,
                min(model.max_deceleration, 9.81 * context.friction),
                context.step_length,
            ]
        )
        self._out = np.zeros(8)
        self._way: Way | None = None
        self._fixed: tuple[Any, ...] = ()
        self._log = context.log
        self._log.declare("gap", "wanted_speed", "halt_distance")

    def _take(self, way: Way) -> None:
        """Collects the last arguments of ``decide``, which are constant along a way."""
        zones = way.conflicts
        self._way = way
        self._fixed = (
            self._car, way.wall, way.points, zones.zones, zones.first, zones.foes, self._out,
        )  # fmt: skip

    def drive(self, observation: Observation, runs: RunFollower) -> AccelerationControl:
        """Decides for the next step; advances the follower's cursor."""
        if runs.way is not self._way:
            self._take(runs.way)
        runs.cursor = decide(
            observation.speed, runs.cursor, runs.waited, observation.light_distance,
            int(observation.light), observation.light_protected, observation.ego,
            observation.objects, observation.object_sizes, observation.object_kinds, *self._fixed,
        )  # fmt: skip
        acceleration, steer, gap, _, _, stop, lateral, wanted = self._out.tolist()
        if abs(lateral) > LOST or _is_past_goal(runs, *observation.ego[:2].tolist()):
            acceleration = self._out[0] = min(acceleration, -GIVING_UP_BRAKING)
        row = self._log.row
        row[0], row[1], row[2] = gap, wanted, stop
        return AccelerationControl(acceleration, steer)


def _is_past_goal(runs: RunFollower, x: float, y: float) -> bool:
    """Returns whether the ego has passed the end of its route, at the end of its last lane run."""
    way = runs.way
    if float(way.points[runs.cursor, 2]) < way.run.end_s - _NEAR_GOAL:
        return False
    goal_x, goal_y, ahead_x, ahead_y = way.goal.tolist()
    return bool((x - goal_x) * ahead_x + (y - goal_y) * ahead_y > _PAST_GOAL)
