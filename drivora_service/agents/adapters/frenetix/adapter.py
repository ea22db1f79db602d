"""The sampling core of the package ``frenetix`` behind the protocol.

The package samples trajectories, checks which the vehicle can drive, and computes their costs. The
choice is made here: the cheapest that stays on the road, stops before a red light and avoids the
predicted actors.
"""

from __future__ import annotations

import itertools
import math

import frenetix
import numpy as np
from frenetix import trajectory_functions
from frenetix.trajectory_functions import cost_functions, feasability_functions

from drivora_service.agents.adapters.forecast import (
    Forecast,
    LaneForecaster,
    leave_out_followers,
)
from drivora_service.agents.adapters.lights import must_stop
from drivora_service.agents.adapters.overlap import overlap
from drivora_service.agents.adapters.path_lines import directions
from drivora_service.agents.adapters.reference import find_reference
from drivora_service.agents.interface import (
    AccelerationControl,
    Control,
    Observation,
    PoseControl,
)
from drivora_service.agents.remote.serving import serve
from drivora_service.agents.remote.views import ContextView
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col

_DT, _HORIZON = 0.1, 5.0
_DURATIONS = (1.0, 2.0, 3.0, 4.0)
_SPEEDS = 9
_OFFSETS = (0.0, -0.5, 0.5, -1.0, 1.0, -1.75, 1.75, -2.5, 2.5, -3.3, 3.3)
"""Metres to the left of the reference."""

_OTHERS = 25
_SLOW = 3.0
"""m/s below which offsets are sampled over distance instead of time."""

_BRAKING, _MARGIN = 3.0, 1.0
"""Deceleration before a light's stop line, m/s², and distance from the line, metres."""

_ROOM = (0.6, 0.25)
"""Margins in metres, before and behind, and at each side."""

_SIDE_ACCELERATION = 5.0
"""Maximum deceleration of a trajectory, m/s²."""

_STANDING = 0.2
"""m/s below which the planned heading is undefined."""

_ON_PLAN = (0.3, 0.1, 0.7)
"""Metres, radians and m/s between plan and vehicle, up to which a plan continues the last one."""


class FrenetixAdapter:
    """Samples in every step."""

    def setup_env(self, context: ContextView) -> None:
        """Computes the reference and the road of a route, and sets the constraints."""
        self._context = context
        vehicle = context.vehicle
        self._half_base = 0.5 * vehicle.wheelbase
        self._reference = find_reference(context.route, context.lanes)
        self._coordinates = frenetix.CoordinateSystemWrapper(self._reference.line)
        self._forecaster = LaneForecaster(context.lanes)
        self._times = np.arange(0.0, _HORIZON + 0.5 * _DT, _DT)
        self._handler = frenetix.TrajectoryHandler(dt=_DT)
        # Not the package's check of yaw rates, which finds a full turn if a heading passes pi.
        for check in (
            feasability_functions.CheckAccelerationConstraint(
                switchingVelocity=7.3,
                maxAcceleration=min(vehicle.max_deceleration, 6.0),
                wholeTrajectory=False,
            ),
            feasability_functions.CheckCurvatureConstraint(
                deltaMax=vehicle.max_steer, wheelbase=vehicle.wheelbase, wholeTrajectory=False
            ),
        ):
            self._handler.add_feasability_function(check)
        self._next: FloatArray | None = None
        context.log.declare("planned_speed", "planner_failed", "looked_at")

    def run_step(self, observation: Observation) -> Control:
        """Returns the pose of the best plan at the end of the step."""
        context = self._context
        x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
        state = self._state(observation, x, y, yaw)
        row = context.log.row
        found, row[2] = self._plan(state, observation)
        row[1] = float(found is None)
        if found is None:
            self._next = None
            row[0] = 0.0
            return AccelerationControl(-context.vehicle.max_deceleration, observation.steer)
        after = [
            float(np.interp(context.step_length, self._times[: len(column)], column))
            for column in found.T
        ]
        self._next = np.array(after)
        context.log.plan(found[:, :2] + self._half_base * directions(found[:, 2]))
        row[0] = after[3]
        if after[3] < _STANDING and observation.speed < _STANDING:
            after[2] = yaw
        return PoseControl(
            after[0] + self._half_base * math.cos(after[2]),
            after[1] + self._half_base * math.sin(after[2]),
            after[2],
            max(after[3], 0.0),
        )

    def _state(self, observation: Observation, x: float, y: float, yaw: float) -> FloatArray:
        """Returns x, y, yaw, speed, acceleration, curvature of the rear axle to plan from."""
        now = np.array(
            [
                x - self._half_base * math.cos(yaw),
                y - self._half_base * math.sin(yaw),
                yaw,
                max(observation.speed, 0.0),
                min(max(observation.acceleration, -6.0), 3.0),
                math.tan(observation.steer) / self._context.vehicle.wheelbase,
            ]
        )
        if self._next is None:
            return now
        off = np.abs(self._next - now)
        turn = abs(math.remainder(float(self._next[2]) - yaw, math.tau))
        on_plan = max(off[0], off[1]) < _ON_PLAN[0] and turn < _ON_PLAN[1] and off[3] < _ON_PLAN[2]
        return self._next if on_plan else now

    def _plan(self, state: FloatArray, observation: Observation) -> tuple[FloatArray | None, int]:
        """Returns the best trajectory, with the columns of a state, and the number of samples."""
        slow = bool(state[3] < _SLOW)
        wheelbase = self._context.vehicle.wheelbase
        try:
            start = frenetix.compute_initial_state(
                coordinate_system=self._coordinates,
                x_0=frenetix.CartesianPlannerState(
                    state[:2].copy(),
                    float(state[2]),
                    float(state[3]),
                    float(state[4]),
                    math.atan(float(state[5]) * wheelbase),
                ),
                wheelbase=wheelbase,
                low_velocity_mode=slow,
            )
        except ValueError:  # Too far from the reference for a projection in its bends.
            return None, 0
        wanted = self._wanted_speed(start.x0_lon)
        handler = self._handler
        handler.reset_Trajectories()
        handler.clear_cost_functions()
        for cost in (
            cost_functions.CalculateLateralJerkCost("lateral_jerk", 0.2),
            cost_functions.CalculateLongitudinalJerkCost("longitudinal_jerk", 0.2),
            cost_functions.CalculateVelocityOffsetCost(
                "velocity_offset", 1.0, wanted, _DT, 1.1, False, 2
            ),
            cost_functions.CalculateDistanceToReferencePathCost("distance_to_reference", 5.0),
        ):
            handler.add_cost_function(cost)
        handler.add_function(
            trajectory_functions.FillCoordinates(slow, float(state[2]), self._coordinates, _HORIZON)
        )
        handler.generate_trajectories(samples(start, wanted), slow)
        handler.evaluate_all_current_functions(True)
        return self._best(float(start.x0_lon[0]), observation)

    def _wanted_speed(self, lengthwise: FloatArray) -> float:
        """Returns the speed that limit and bends allow at a place a little ahead, m/s."""
        s, speed = float(lengthwise[0]), float(lengthwise[1])
        places = np.linspace(s, s + 1.5 * max(speed, 0.0), 4)
        return float(np.interp(places, self._reference.arc, self._reference.speeds).min())

    def _best(self, s: float, observation: Observation) -> tuple[FloatArray | None, int]:
        stop = math.inf
        if must_stop(observation) and math.isfinite(observation.light_distance):
            stop = s + max(observation.light_distance - _MARGIN, 0.05)
        others = self._forecaster.foresee(observation, self._times, _OTHERS)
        others = leave_out_followers(others, observation)
        tried = 0
        for trajectory in self._handler.get_sorted_trajectories():
            if not (trajectory.valid and trajectory.feasible):
                continue
            tried += 1
            frenet, path = trajectory.curvilinear, trajectory.cartesian
            end = frenet.s[-1] + frenet.s_dot[-1] ** 2 / (2.0 * _BRAKING)
            if end > stop or not self._on_road(frenet.s, frenet.d):
                continue
            columns = np.column_stack((path.x, path.y, path.theta, path.v, path.a, path.kappa))
            if (np.abs(columns[:, 3] ** 2 * columns[:, 5]) > _SIDE_ACCELERATION).any():
                continue
            columns[:, 2] = np.unwrap(columns[:, 2])
            if not self._hits(columns, others):
                return columns, tried
        return None, tried

    def _on_road(self, s: FloatArray, d: FloatArray) -> bool:
        """Returns whether a trajectory stays on the road, or leaves it no further."""
        half = 0.5 * self._context.vehicle.width
        reference = self._reference
        over = np.maximum(
            d + half - np.interp(s, reference.arc, reference.left),
            half - d - np.interp(s, reference.arc, reference.right),
        )
        return bool((over < max(0.1, float(over[0]) + 0.05)).all())

    def _hits(self, columns: FloatArray, others: Forecast) -> bool:
        if not len(others.ids):
            return False
        vehicle = self._context.vehicle
        poses = columns[:, :3].copy()
        poses[:, 0] += self._half_base * np.cos(poses[:, 2])
        poses[:, 1] += self._half_base * np.sin(poses[:, 2])
        size = vehicle.length + 2.0 * _ROOM[0], vehicle.width + 2.0 * _ROOM[1]
        met = overlap(poses, size, others.poses[:, : len(poses)], others.sizes)
        # Actors within the margins already must not prevent driving away.
        return bool((met & ~met[:, :1]).any() or (met[:, :1] & met[:, 10:11]).any())


def samples(start: frenetix.CurvilinearPlannerState, wanted: float) -> FloatArray:
    """Returns the samples for the package, a row of thirteen numbers for each trajectory.

    They are its begin and end, seconds; s and two derivatives at the begin, two derivatives at the
    end; d and two derivatives at the begin, and at the end.
    """
    lengthwise, across = start.x0_lon, start.x0_lat
    fastest = max(wanted, 0.5)
    speeds = np.unique(np.append(np.linspace(0.0, fastest, _SPEEDS), min(lengthwise[1], fastest)))
    offsets = np.unique(np.round((*_OFFSETS, across[0]), 2))
    ends = itertools.product(_DURATIONS, speeds.tolist(), offsets.tolist())
    return np.array(
        [[0.0, t, *lengthwise, speed, 0.0, *across, d, 0.0, 0.0] for t, speed, d in ends]
    )


if __name__ == "__main__":
    serve(FrenetixAdapter, name="frenetix")
