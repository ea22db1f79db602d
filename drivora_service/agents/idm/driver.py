"""Driving along lane runs like the intelligent-driver agent, for agents based on it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.idm.driving import decide
from drivora_service.agents.idm.run_following import RunFollower, Way
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.compilation import specialize
from drivora_service.geometry.array_shapes import FloatArray, IntArray

LOST = 8.0
"""Metres beside its line from which on the driver is lost, and stops."""

GIVING_UP_BRAKING = 3.0
"""m/s² with which it stops if it is lost or past its destination."""

_FLOAT, _INT = np.dtype(np.float64), np.dtype(np.int64)
_ONE_FLOAT = (8,)
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
        self._near_goal = 0
        self._decide = decide
        self._objects: FloatArray | None = None
        self._sizes: FloatArray | None = None
        self._kinds: IntArray | None = None
        self._log = context.log
        self._log.declare("gap", "wanted_speed", "halt_distance")

    def _take(self, way: Way) -> None:
        """Collects the last arguments of ``decide``, which are constant along a way."""
        zones = way.conflicts
        self._way = way
        self._near_goal = int(np.searchsorted(way.points[:, 2], way.run.end_s - _NEAR_GOAL))
        self._fixed = (
            self._car, way.wall, way.points, zones.zones, zones.first, zones.foes, self._out,
        )  # fmt: skip

    def drive(self, observation: Observation, runs: RunFollower) -> AccelerationControl:
        """Decides for the next step; advances the follower's cursor."""
        if runs.way is not self._way:
            self._take(runs.way)
        ego, objects = observation.ego, observation.objects
        sizes, kinds = observation.object_sizes, observation.object_kinds
        known = (
            objects is self._objects and sizes is self._sizes and kinds is self._kinds
            and ego.strides == _ONE_FLOAT and ego.dtype is _FLOAT
        )  # fmt: skip
        # Else the types are checked: what wraps this agent may pass it other arrays.
        runs.cursor = (self._decide if known else decide)(
            observation.speed, runs.cursor, runs.waited, observation.light_distance,
            int(observation.light), observation.light_protected, ego, objects, sizes, kinds,
            *self._fixed,
        )  # fmt: skip
        if not known:
            self._remember(ego, objects, sizes, kinds)
        acceleration, steer, gap, _, _, stop, lateral, wanted = self._out.tolist()
        if abs(lateral) > LOST or (
            runs.cursor >= self._near_goal and _is_past_goal(runs.way, *ego[:2].tolist())
        ):
            acceleration = self._out[0] = min(acceleration, -GIVING_UP_BRAKING)
        row = self._log.row
        row[0], row[1], row[2] = gap, wanted, stop
        return AccelerationControl(acceleration, steer)

    def _remember(
        self, ego: FloatArray, objects: FloatArray, sizes: FloatArray, kinds: IntArray
    ) -> None:
        """Remembers arrays with which ``decide`` has just been called, if they are as usual."""
        if (
            all(_is_plain(array, _FLOAT) for array in (ego, objects, sizes))
            and _is_plain(kinds, _INT)
            and (ego.ndim, objects.ndim, sizes.ndim, kinds.ndim) == (1, 2, 2, 1)
        ):
            self._objects, self._sizes, self._kinds = objects, sizes, kinds
            self._decide = specialize(decide)


def _is_plain(array: NDArray[Any], dtype: np.dtype[Any]) -> bool:
    return array.dtype == dtype and array.flags.carray


def _is_past_goal(way: Way, x: float, y: float) -> bool:
    """Returns whether the ego has passed the end of its route, near the end of its last run."""
    goal_x, goal_y, ahead_x, ahead_y = way.goal.tolist()
    return bool((x - goal_x) * ahead_x + (y - goal_y) * ahead_y > _PAST_GOAL)
