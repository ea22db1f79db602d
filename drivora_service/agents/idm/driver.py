"""Driving along lane runs like the intelligent-driver agent, for agents based on it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.idm.corridor import Actors, perceived_actors
from drivora_service.agents.idm.driving import Car, Decision, Lane, decide
from drivora_service.agents.idm.run_following import RunFollower, Way, WayCol
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
        self._car = Car(
            half_length=0.5 * model.length,
            half_width=0.5 * model.width,
            wheelbase=model.wheelbase,
            max_braking=min(model.max_deceleration, 9.81 * context.friction),
            step_length=context.step_length,
        )
        self._out = np.zeros(len(Decision))
        self._way: Way | None = None
        self._lane: Lane | None = None
        self._near_goal = 0
        self._decide = decide
        self._actors: Actors | None = None
        # Of ``_actors``: attributes of a record take longer to look up.
        self._objects: FloatArray | None = None
        self._sizes: FloatArray | None = None
        self._kinds: IntArray | None = None
        self._log = context.log
        self._log.declare("gap", "wanted_speed", "halt_distance")

    def _take(self, way: Way) -> Lane:
        """Returns what ``decide`` needs of a way, which it keeps for the next calls."""
        self._way = way
        arc = way.points[:, WayCol.ARC]
        self._near_goal = int(np.searchsorted(arc, way.run.end_s - _NEAR_GOAL))
        self._lane = Lane(way.wall, way.points, way.conflicts)
        return self._lane

    def drive(self, observation: Observation, runs: RunFollower) -> AccelerationControl:
        """Returns the control until the next step; advances the follower's cursor."""
        way, lane = runs.way, self._lane
        if lane is None or way is not self._way:
            lane = self._take(way)
        ego, objects = observation.ego, observation.objects
        actors = self._actors
        if (
            actors is not None and objects is self._objects
            and observation.object_sizes is self._sizes
            and observation.object_kinds is self._kinds
            and ego.strides == _ONE_FLOAT and ego.dtype is _FLOAT
        ):  # fmt: skip
            kernel = self._decide
        else:
            # The types are checked: what wraps this agent may pass it other arrays.
            kernel, actors = decide, perceived_actors(observation)
        runs.cursor = kernel(
            observation.speed, runs.cursor, runs.waited, observation.light_distance,
            int(observation.light), observation.light_protected, ego, actors, self._car, lane,
            self._out,
        )  # fmt: skip
        if actors is not self._actors:
            self._remember(ego, actors)
        acceleration, steer, gap, _, _, stop, lateral, wanted = self._out.tolist()
        if abs(lateral) > LOST or (
            runs.cursor >= self._near_goal and _is_past_goal(way, *ego[:2].tolist())
        ):
            acceleration = min(acceleration, -GIVING_UP_BRAKING)
            self._out[Decision.ACCELERATION] = acceleration
        row = self._log.row
        row[0], row[1], row[2] = gap, wanted, stop
        return AccelerationControl(acceleration, steer)

    def _remember(self, ego: FloatArray, actors: Actors) -> None:
        """Remembers arrays with which ``decide`` has just been called, if they are as usual."""
        if (
            all(_is_plain(array, _FLOAT) for array in (ego, actors.objects, actors.sizes))
            and _is_plain(actors.kinds, _INT)
            and (ego.ndim, *(array.ndim for array in actors)) == (1, 2, 2, 1)
        ):
            self._actors = actors
            self._objects, self._sizes, self._kinds = actors
            self._decide = specialize(decide)


def _is_plain(array: NDArray[Any], dtype: np.dtype[Any]) -> bool:
    return array.dtype == dtype and array.flags.carray


def _is_past_goal(way: Way, x: float, y: float) -> bool:
    """Returns whether the ego has passed the end of its route, near the end of its last run."""
    goal = way.goal
    if goal is None:
        return False
    return (x - goal.x) * goal.ahead_x + (y - goal.y) * goal.ahead_y > _PAST_GOAL
