"""Conversion of an ADS's observations to those of SMARTS.

Frame: the network's plane, metres, radians counter-clockwise from east; left is positive. The
result has SMARTS's headings, from north.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.adapters.smarts_agents.lane_places import LanePlaces, lane_index
from drivora_service.agents.adapters.smarts_agents.scene import (
    OFF_LANE,
    Box,
    EgoState,
    Goal,
    LanePosition,
    Mission,
    Scene,
    VehicleState,
    Waypoint,
    to_heading,
)
from drivora_service.agents.adapters.smarts_agents.ways import RouteWays, Way
from drivora_service.agents.interface import Observation
from drivora_service.agents.remote.views import ContextView
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col

_WAYPOINTS = 51
"""Waypoints of a way, a metre apart: one beside the vehicle and fifty ahead (contest)."""

_FEWEST = 20
"""Waypoints that DSAC reads of each way; it cuts all ways to the length of the shortest."""

_RADIUS = 50.0
"""Range of the other actors, metres."""

_OTHERS = 20
"""Maximum number of other actors, the nearest ones."""


class Observer:
    """Makes the observations of a run."""

    def __init__(self, context: ContextView, goal_ahead: float) -> None:
        """Finds the lanes and the ways along the route.

        Args:
            context: Context of the run.
            goal_ahead: Metres along the route to the policy's goal.
        """
        self._context = context
        self._goal_ahead = goal_ahead
        self._places = LanePlaces(context.lanes)
        self._ways = RouteWays(context.lanes, context.route)
        self._steps = 0
        self._last: tuple[float, float] | None = None

    def observe(self, observation: Observation) -> Scene:
        """Returns the next observation of the run."""
        x, y = observation.ego[[Col.X, Col.Y]].tolist()
        travelled = 0.0 if self._last is None else math.hypot(x - self._last[0], y - self._last[1])
        self._last = x, y
        self._steps += 1
        stage = self._ways.stage(observation.route_s)
        ways = self._ways.ways(stage)
        return Scene(
            elapsed_sim_time=observation.time,
            steps_completed=self._steps,
            distance_travelled=travelled,
            ego_vehicle_state=self._ego(observation, stage, ways),
            neighborhood_vehicle_states=self._others(observation),
            waypoint_paths=omit_ending_ways(
                [self._waypoints(way, observation.ego[:2]) for way in ways]
            ),
        )

    def _ego(self, observation: Observation, stage: int, ways: tuple[Way, ...]) -> EgoState:
        context, ego = self._context, observation.ego
        yaw, rate = float(ego[Col.YAW]), float(ego[Col.YAW_RATE])
        lane, position = self._ego_place(ego[:2], stage, ways)
        return EgoState(
            id="ego",
            position=np.array([ego[Col.X], ego[Col.Y], 0.0]),
            bounding_box=Box(length=context.vehicle.length, width=context.vehicle.width),
            heading=to_heading(yaw),
            speed=observation.speed,
            steering=observation.steer,
            yaw_rate=rate,
            lane_id=str(lane),
            lane_index=lane_index(context.lanes, lane),
            lane_position=position,
            mission=Mission(goal=Goal(position=self._goal(observation.route_s))),
            linear_velocity=np.array([ego[Col.VX], ego[Col.VY], 0.0]),
            linear_acceleration=np.array([ego[Col.AX], ego[Col.AY], 0.0]),
            linear_jerk=np.zeros(3),
            angular_velocity=np.array([0.0, 0.0, rate]),
            angular_acceleration=np.zeros(3),
            angular_jerk=np.zeros(3),
        )

    def _ego_place(
        self, place: FloatArray, stage: int, ways: tuple[Way, ...]
    ) -> tuple[int, LanePosition]:
        """Returns the lane of the route's road, or of its ways through a junction, that is nearest.

        Other lanes may be nearer at crossings: like SMARTS, this uses the route's lanes.
        """
        if stage % 2 == 0:
            found = [(lane, *self._on_lane(lane, place)) for lane in self._ways.road(stage)]
        else:
            found = []
            for way in ways:
                s, t = way.project(place)
                k = way.lane_at(s)
                found.append((way.lanes[k], s - float(way.starts[k]), t))
        lane, s, t = min(found, key=lambda candidate: abs(candidate[2]))
        return lane, LanePosition(s=s, t=t)

    def _on_lane(self, lane: int, place: FloatArray) -> tuple[float, float]:
        return self._ways.lane(lane).project(place)

    def _goal(self, route_s: float) -> FloatArray:
        route = self._context.route
        s = route_s + self._goal_ahead
        return np.array([*(float(np.interp(s, route.arc, route.line[:, k])) for k in (0, 1)), 0.0])

    def _waypoints(self, way: Way, place: FloatArray) -> list[Waypoint]:
        first, _ = way.project(place)
        count = int(np.clip(way.arc[-1] - first, 0.0, _WAYPOINTS - 1)) + 1
        places = first + np.arange(count)
        # Lanes are polylines: a direction is that of a metre around its place.
        around = np.array([[-0.5], [0.5]]) + np.minimum(places, way.arc[-1] - 0.5)
        x, y = (np.interp(places, way.arc, way.line[:, k]) for k in (0, 1))
        dx, dy = (np.diff(np.interp(around, way.arc, way.line[:, k]), axis=0)[0] for k in (0, 1))
        waypoints = []
        for k, s in enumerate(places.tolist()):
            index = way.lane_at(s)
            lane = self._context.lanes[way.lanes[index]]
            waypoints.append(
                Waypoint(
                    pos=np.array([x[k], y[k]]),
                    heading=to_heading(math.atan2(dy[k], dx[k])),
                    lane_id=str(lane.id),
                    lane_index=lane_index(self._context.lanes, lane.id),
                    lane_width=lane.width,
                    lane_offset=s - float(way.starts[index]),
                    speed_limit=lane.speed_limit,
                )
            )
        return waypoints

    def _others(self, observation: Observation) -> tuple[VehicleState, ...]:
        """Returns the actors nearby, nearest first; walkers and obstacles as vehicles."""
        objects = observation.objects
        away = np.hypot(*(objects[:, :2] - observation.ego[:2]).T)
        near = np.argsort(away, kind="stable")[:_OTHERS]
        return tuple(
            self._other(objects[k], observation.object_sizes[k], int(observation.object_ids[k]))
            for k in near.tolist()
            if away[k] < _RADIUS
        )

    def _other(self, state: FloatArray, size: FloatArray, number: int) -> VehicleState:
        yaw = float(state[Col.YAW])
        place = self._places.find(state[:2], yaw)
        return VehicleState(
            id=f"vehicle-{number}",
            position=np.array([state[Col.X], state[Col.Y], 0.0]),
            bounding_box=Box(length=float(size[0]), width=float(size[1])),
            heading=to_heading(yaw),
            speed=float(np.hypot(state[Col.VX], state[Col.VY])),
            lane_id=OFF_LANE if place is None else str(place.lane),
            lane_index=-1 if place is None else lane_index(self._context.lanes, place.lane),
            lane_position=LanePosition(s=place.s, t=place.t) if place else LanePosition(s=0, t=0),
        )


def omit_ending_ways(paths: list[list[Waypoint]]) -> list[list[Waypoint]]:
    """Omits ways that are about to end, unless all are."""
    return [path for path in paths if len(path) >= _FEWEST] or [max(paths, key=len)]
