"""The reactive planner of CommonRoad behind the protocol.

The planner runs at most twice a second, and its plan is followed in between: planning takes as
long as many steps. It gets a reference, speeds, a lateral range and boxes to avoid, but no map.
"""

from __future__ import annotations

import logging
import math

import commonroad_dc.pycrcc as pycrcc
import numpy as np
from commonroad.common.util import Interval
from commonroad.geometry.shape import Rectangle
from commonroad.planning.goal import GoalRegion
from commonroad.planning.planning_problem import PlanningProblem, PlanningProblemSet
from commonroad.scenario.lanelet import Lanelet
from commonroad.scenario.scenario import Scenario, ScenarioID
from commonroad.scenario.state import CustomState, InitialState
from commonroad_clcs.config import CLCSParams
from commonroad_rp.reactive_planner import ReactivePlanner
from commonroad_rp.state import ReactivePlannerState
from commonroad_rp.utility.config import ReactivePlannerConfiguration
from commonroad_rp.utility.utils_coordinate_system import CoordinateSystem

from drivora_service.agents.adapters.forecast import (
    Forecast,
    LaneForecaster,
    leave_out_followers,
)
from drivora_service.agents.adapters.lights import must_stop
from drivora_service.agents.adapters.path_lines import directions
from drivora_service.agents.adapters.reference import Reference, find_reference
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

_DT, _STEPS = 0.1, 40
_REPLAN_AFTER = 0.5
_OTHERS = 25
_ROOM = (0.5, 0.25)
"""Margins in metres, before and behind, and at each side."""

_BRAKING, _MARGIN = 2.0, 1.0
"""Deceleration before a light's stop line, m/s², and distance from the line, metres."""

_SOON = 1.0
"""Seconds from now at which that speed is desired, since plans have a desired end only."""

_STANDING = 0.2
_ON_PLAN = (0.3, 0.1, 0.7)
"""Metres, radians and m/s between plan and vehicle, up to which a plan continues the last one."""


class WindingCoordinates(CoordinateSystem):  # type: ignore[misc] # the package has no types
    """The package's coordinates along a reference that may turn by more than a full turn.

    The package rejects those, such as around a roundabout, but reads headings modulo a turn.
    """

    @staticmethod
    def check_ref_path_validity(ref_path: FloatArray) -> None:
        """Rejects a reference with corners, as the package does."""
        steps = np.diff(ref_path, axis=0)
        turns = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
        if np.abs(turns).max() >= 0.5 * math.pi:
            raise ValueError("the route has a corner of a right angle or more")


class CommonRoadAdapter:
    """Plans at intervals, and follows the plan."""

    def setup_env(self, context: ContextView) -> None:
        """Makes a planner for the vehicle and the route."""
        self._context = context
        self._half_base = 0.5 * context.vehicle.wheelbase
        self._reference = find_reference(context.route, context.lanes)
        self._forecaster = LaneForecaster(context.lanes)
        self._times: FloatArray = np.arange(_STEPS + 1, dtype=np.float64) * _DT
        self._coordinates = WindingCoordinates(self._reference.line, clcs_params=CLCSParams())
        self._planner = ReactivePlanner(configuration(context, self._reference))
        self._planner.set_reference_path(coordinate_system=self._coordinates)
        self._plan: FloatArray | None = None
        self._planned_at = -math.inf
        context.log.declare("planned_speed", "planner_failed", "plan_age")

    def run_step(self, observation: Observation) -> Control:
        """Returns the pose of the plan at the end of the step."""
        context = self._context
        age = observation.time - self._planned_at
        now = self._state(observation, age)
        if age > _REPLAN_AFTER - 1e-6:
            self._plan, self._planned_at, age = (
                self._new_plan(now, observation),
                observation.time,
                0.0,
            )
        row = context.log.row
        row[1], row[2] = float(self._plan is None), age
        if self._plan is None:
            row[0] = 0.0
            return AccelerationControl(-context.vehicle.max_deceleration, observation.steer)
        plan = self._plan[self._times[: len(self._plan)] >= age]
        context.log.plan(plan[:, :2] + self._half_base * directions(plan[:, 2]))
        x, y, yaw, speed = self._at(age + context.step_length)[:4].tolist()
        row[0] = speed
        if speed < _STANDING and observation.speed < _STANDING:
            yaw = float(observation.ego[Col.YAW])
        return PoseControl(
            x + self._half_base * math.cos(yaw),
            y + self._half_base * math.sin(yaw),
            yaw,
            max(speed, 0.0),
        )

    def _at(self, age: float) -> FloatArray:
        plan = self._plan
        assert plan is not None
        times = self._times[: len(plan)]
        return np.array([np.interp(age, times, column) for column in plan.T])

    def _state(self, observation: Observation, age: float) -> FloatArray:
        """Returns x, y, yaw, speed, acceleration, wheel angle, yaw rate of the rear axle."""
        x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
        speed = max(observation.speed, 0.0)
        # A vehicle that has just stopped keeps braking: plans from there begin by driving
        # backwards, and are rejected.
        braking = -6.0 if speed > _STANDING else 0.0
        now = np.array(
            [
                x - self._half_base * math.cos(yaw),
                y - self._half_base * math.sin(yaw),
                yaw,
                speed,
                min(max(observation.acceleration, braking), 3.0),
                observation.steer,
                speed * math.tan(observation.steer) / self._context.vehicle.wheelbase,
            ]
        )
        if self._plan is None:
            return now
        planned = self._at(age)
        off = np.abs(planned - now)
        turn = abs(math.remainder(float(planned[2]) - yaw, math.tau))
        on_plan = max(off[0], off[1]) < _ON_PLAN[0] and turn < _ON_PLAN[1] and off[3] < _ON_PLAN[2]
        return planned if on_plan else now

    def _new_plan(self, now: FloatArray, observation: Observation) -> FloatArray | None:
        """Returns a new plan, with the columns of a state and a row for each of its steps."""
        planner, reference = self._planner, self._reference
        yaw = math.remainder(float(now[2]), math.tau)
        state = ReactivePlannerState(
            time_step=0,
            position=now[:2].copy(),
            orientation=yaw,
            velocity=float(now[3]),
            acceleration=float(now[4]),
            steering_angle=float(now[5]),
            yaw_rate=float(now[6]),
        )
        others = leave_out_followers(
            self._forecaster.foresee(observation, self._times, _OTHERS), observation
        )
        s, speed = self._s_of(now), float(now[3])
        stop = math.inf
        if must_stop(observation) and math.isfinite(observation.light_distance):
            stop = max(observation.light_distance - _MARGIN, 0.0)
        nose = s + self._half_base + 0.5 * self._context.vehicle.length
        try:
            planner.reset(
                initial_state_cart=state, collision_checker=self._obstacles(others, nose + stop)
            )
        except (AssertionError, ValueError):  # Too far from the reference for the projection.
            return None
        ahead = np.linspace(s, s + max(4.0 * speed, 10.0), 12)
        half = 0.5 * self._context.vehicle.width
        left = float(np.interp(ahead, reference.arc, reference.left).min()) - half
        right = float(np.interp(ahead, reference.arc, reference.right).min()) - half
        planner.set_d_sampling_parameters(-min(max(right, 0.2), 3.0), min(max(left, 0.2), 3.0))
        soon = np.linspace(s, s + 1.5 * speed, 4)
        wanted = float(np.interp(soon, reference.arc, reference.speeds).min())
        wanted = min(wanted, max(math.sqrt(2.0 * _BRAKING * stop) - _BRAKING * _SOON, 0.0))
        planner.set_desired_velocity(wanted, max(speed, 0.1))
        found = planner.plan()
        if found is None:
            return None
        rows = [
            (*p.position, p.orientation, p.velocity, p.acceleration, p.steering_angle, p.yaw_rate)
            for p in found[0].state_list
        ]
        plan = np.array(rows, dtype=np.float64)
        plan[:, 2] = np.unwrap(plan[:, 2])
        return plan

    def _s_of(self, now: FloatArray) -> float:
        line = self._reference.line
        return float(self._reference.arc[int(np.argmin(((line - now[:2]) ** 2).sum(axis=1)))])

    def _obstacles(self, others: Forecast, stop: float) -> pycrcc.CollisionChecker:
        """Returns the predicted actors, and a wall at a place that must not be passed."""
        checker = pycrcc.CollisionChecker()
        for poses, (length, width) in zip(others.poses, others.sizes.tolist(), strict=True):
            moving = pycrcc.TimeVariantCollisionObject(0)
            for x, y, yaw in poses.tolist():
                moving.append_obstacle(
                    pycrcc.RectOBB(0.5 * length + _ROOM[0], 0.5 * width + _ROOM[1], yaw, x, y)
                )
            checker.add_collision_object(moving)
        if math.isfinite(stop):
            line, arc = self._reference.line, self._reference.arc
            x, y = (float(np.interp(stop + 0.5, arc, line[:, k])) for k in (0, 1))
            k = min(int(np.searchsorted(arc, stop)), len(line) - 2)
            dx, dy = (line[k + 1] - line[k]).tolist()
            checker.add_collision_object(pycrcc.RectOBB(0.4, 5.0, math.atan2(dy, dx), x, y))
        return checker


def configuration(context: ContextView, reference: Reference) -> ReactivePlannerConfiguration:
    """Returns the planner's configuration, with the minimal scenario that it accepts."""
    vehicle = context.vehicle
    line = reference.line
    side = np.array([0.0, 2.0])
    scenario = Scenario(_DT, ScenarioID())
    scenario.add_objects([Lanelet(line + side, line, line - side, 1)])
    start = InitialState(
        position=context.route.line[0],
        orientation=0.0,
        velocity=1.0,
        acceleration=0.0,
        yaw_rate=0.0,
        slip_angle=0.0,
        time_step=0,
    )
    goal = CustomState(time_step=Interval(0, 10_000), position=Rectangle(1.0, 1.0, line[-1]))
    problem = PlanningProblem(2, start, GoalRegion([goal]))
    made = ReactivePlannerConfiguration()
    made.planning_problem_set = PlanningProblemSet([problem])
    made.debug.logging_level = "ERROR"
    # Otherwise it forks for every plan, and hangs because of gRPC's threads.
    made.debug.multiproc = False
    made.planning.dt, made.planning.time_steps_computation = _DT, _STEPS
    made.planning.planning_horizon = _DT * _STEPS
    # If a heading passes pi, its check of yaw rates finds a full turn.
    made.planning.constraints_to_check = ["velocity", "acceleration", "kappa"]
    made.sampling.max_deceleration_ratio = 0.5
    # The third level takes seconds, and is reached when time is short.
    made.sampling.num_sampling_levels = 3
    made.update(scenario=scenario, planning_problem=problem)
    own = made.vehicle
    own.length, own.width = vehicle.length, vehicle.width
    own.wb_front_axle = own.wb_rear_axle = 0.5 * vehicle.wheelbase
    own.wheelbase = vehicle.wheelbase
    own.a_max = min(vehicle.max_deceleration, 6.0)
    own.delta_min, own.delta_max = -vehicle.max_steer, vehicle.max_steer
    return made


if __name__ == "__main__":
    logging.disable(logging.WARNING)
    serve(CommonRoadAdapter, name="commonroad-rp")
