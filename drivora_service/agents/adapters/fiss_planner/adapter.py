"""The planners of the package ``fiss-planner`` behind the protocol.

The planner gets only the lanes that its route can use: with all lanes of a junction it
mistakes crossing ones for its own. A red light is a stop line that it must not pass.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import fiss_planner as fp
import numpy as np

from drivora_service.agents.adapters.lights import must_stop
from drivora_service.agents.adapters.path_lines import arc_of, normals, resample
from drivora_service.agents.adapters.route_lanes import (
    beside_one_another,
    lane_sequence,
    usable_lanes,
)
from drivora_service.agents.interface import (
    AccelerationControl,
    Control,
    Observation,
    PoseControl,
)
from drivora_service.agents.remote.serving import serve
from drivora_service.agents.remote.views import ContextView, LaneView
from drivora_service.observations.trace import Col

_HORIZON_S, _PREDICTION_S = 6.0, 0.1
_OTHERS = 25
"""Number of nearest actors for the planner."""

_STANDING = 0.2
"""m/s below which the planned heading is undefined."""

_ODD_TURN = 0.5
"""Turn in a step above which a heading is an artefact of coinciding points, radians."""

_STOP_LINE_GAP = 1.0
"""Metres before the end of a lane at which the planner's stop line lies."""


class FissAdapter:
    """Drives by one of the package's planners, which plans in every step."""

    def __init__(self, planner: str) -> None:
        """Args: planner: Name of a planner of the package: ``fiss_plus``, ``fop``."""
        self._planner_name = planner

    def setup_env(self, context: ContextView) -> None:
        """Sets the map and the route of the planner."""
        self._context = context
        vehicle = fp.VehicleParams()
        vehicle.length, vehicle.width = context.vehicle.length, context.vehicle.width
        vehicle.wheelbase = context.vehicle.wheelbase
        vehicle.max_steer = context.vehicle.max_steer
        vehicle.max_speed = context.vehicle.max_speed
        config = fp.LocalPlannerConfig()
        config.planner = fp.make_config(self._planner_name)
        self._local_planner = fp.LocalPlanner(config, vehicle)
        lanes = usable_lanes(context.lanes, context.route)
        # The planner's ids begin at 1: 0 and less mean "none" to it.
        self._ids = {lane: number for number, lane in enumerate(sorted(lanes), start=1)}
        road_map = fp.RoadMap()
        for lane in sorted(lanes):
            road_map.add_lane(self._map_lane(context.lanes[lane]))
        self._stop_lines = [
            self._add_stop_lines(road_map, 1000 * number, signal.lane)
            for number, signal in enumerate(context.route.signals, start=1)
        ]
        self._active = -1
        road_map.finalize()
        way = lane_sequence(context.lanes, context.route)
        self._local_planner.set_map(road_map, [self._ids[lane] for lane in way])
        context.log.declare("planned_speed", "planner_failed")

    def run_step(self, observation: Observation) -> Control:
        """Plans, and returns the pose of the plan at the end of the step."""
        context = self._context
        x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
        self._show_light(observation)
        ego = fp.EgoState(
            x,
            y,
            yaw,
            max(observation.speed, 0.0),
            observation.acceleration,
            math.tan(observation.steer) / context.vehicle.wheelbase,
        )
        plan = self._local_planner.step(
            observation.time, ego, self._obstacles(observation), observation.speed_limit
        )
        trajectory = plan.trajectory
        failed = trajectory is None or len(trajectory.x) < 2
        row = context.log.row
        row[1] = float(failed)
        if failed:
            row[0] = 0.0
            return AccelerationControl(-context.vehicle.max_deceleration, 0.0)
        context.log.plan(np.column_stack((trajectory.x, trajectory.y)))
        pose = pose_after(trajectory, context.step_length, x, y)
        row[0] = pose[3]
        turn = math.remainder(pose[2] - yaw, math.tau)
        if abs(turn) > _ODD_TURN or observation.speed < _STANDING:
            turn = 0.0
        return PoseControl(pose[0], pose[1], yaw + turn, pose[3])

    def _map_lane(self, lane: LaneView) -> fp.MapLane:
        made = fp.MapLane()
        made.id, made.speed_limit = self._ids[lane.id], lane.speed_limit
        line = resample(lane.line)
        side = 0.5 * lane.width * normals(line)
        made.centerline = line
        made.left, made.right = line + side, line - side
        made.successors = [self._ids[n] for n in lane.successors if n in self._ids]
        made.predecessors = [
            number
            for other, number in self._ids.items()
            if lane.id in self._context.lanes[other].successors
        ]
        if lane.left in self._ids and lane.may_change_left:
            made.left_neighbor, made.can_change_left = self._ids[lane.left], True
        if lane.right in self._ids and lane.may_change_right:
            made.right_neighbor, made.can_change_right = self._ids[lane.right], True
        return made

    def _add_stop_lines(self, road_map: fp.RoadMap, first: int, lane: int) -> list[int]:
        """Adds a stop line to every lane beside a signal's; returns their ids."""
        numbers = []
        for number, beside in enumerate(beside_one_another(self._context.lanes, lane), start=first):
            if beside in self._ids:
                length = float(arc_of(self._context.lanes[beside].line)[-1])
                place = max(0.0, length - _STOP_LINE_GAP)
                road_map.add_stop_line(fp.StopLine(number, self._ids[beside], place, False))
                numbers.append(number)
        return numbers

    def _show_light(self, observation: Observation) -> None:
        """Activates the stop lines of the next signal if it must be obeyed."""
        active = -1
        distance, signals = observation.light_distance, self._context.route.signals
        if signals and must_stop(observation) and 0.0 <= distance < math.inf:
            s = observation.route_s + 0.5 * self._context.vehicle.length + distance
            active = min(range(len(signals)), key=lambda k: abs(signals[k].s - s))
        if active == self._active:
            return
        for number, lines in enumerate(self._stop_lines):
            for line in lines:
                self._local_planner.set_stop_line_active(line, number == active)
        self._active = active

    def _obstacles(self, observation: Observation) -> list[fp.Obstacle]:
        objects = observation.objects
        away = np.hypot(*(objects[:, :2] - observation.ego[:2]).T)
        return [
            fp.predict_constant_velocity(
                int(observation.object_ids[k]),
                *objects[k, [Col.X, Col.Y, Col.YAW]].tolist(),
                float(np.hypot(objects[k, Col.VX], objects[k, Col.VY])),
                *observation.object_sizes[k].tolist(),
                _HORIZON_S,
                _PREDICTION_S,
            )
            for k in np.argsort(away, kind="stable")[:_OTHERS].tolist()
        ]


def pose_after(trajectory: fp.Trajectory, ahead: float, x: float, y: float) -> Sequence[float]:
    """Returns x, y, yaw and speed on a trajectory ``ahead`` seconds after its place nearest (x, y).

    The plan may begin a little before or behind the vehicle, as it continues the last one.
    """
    points = np.column_stack((trajectory.x, trajectory.y))[:16]
    times = np.array(trajectory.t)
    times -= times[0]
    step = np.diff(points, axis=0)
    long = np.maximum((step**2).sum(axis=1), 1e-9)
    share = np.clip((((x, y) - points[:-1]) * step).sum(axis=1) / long, 0.0, 1.0)
    gaps = np.hypot(*(points[:-1] + share[:, None] * step - (x, y)).T)
    k = int(gaps.argmin())
    then = times[k] + share[k] * (times[k + 1] - times[k]) + ahead
    yaws = np.unwrap(trajectory.yaw)
    columns = (trajectory.x, trajectory.y, yaws, trajectory.v)
    px, py, yaw, speed = (float(np.interp(then, times, column)) for column in columns)
    return px, py, yaw, max(speed, 0.0)


if __name__ == "__main__":
    serve(lambda: FissAdapter(sys.argv[1]), name=sys.argv[1])
