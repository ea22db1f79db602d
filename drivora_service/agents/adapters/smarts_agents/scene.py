"""The observation of SMARTS with its names, as far as the policies here use it.

Frame: the network's plane, metres. Headings are SMARTS's: radians counter-clockwise from north, in
(-pi, pi]. Lanes are counted from the right, from 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray

OFF_LANE = "off_lane"
"""SMARTS's lane id for vehicles off all lanes."""

_RAYS = 300
"""Number of points of the lidar, which no policy here uses, but one requires."""


def to_heading(yaw: float) -> float:
    """Returns SMARTS's heading for an angle counter-clockwise from east."""
    return math.remainder(yaw - 0.5 * math.pi, math.tau)


def to_yaw(heading: float) -> float:
    """Returns the angle counter-clockwise from east for SMARTS's heading."""
    return math.remainder(heading + 0.5 * math.pi, math.tau)


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """Size of a vehicle, metres."""

    length: float
    width: float
    height: float = 1.5

    @property
    def as_lwh(self) -> tuple[float, float, float]:
        """Length, width, height."""
        return self.length, self.width, self.height


@dataclass(frozen=True, slots=True, kw_only=True)
class LanePosition:
    """A place along a lane and beside its middle, positive to the left; metres."""

    s: float
    t: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Goal:
    """The goal: (3,) position."""

    position: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mission:
    """The mission."""

    goal: Goal


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Waypoint:
    """A waypoint of a way ahead.

    Attributes:
        pos: (2,).
        lane_offset: Metres along its lane.
    """

    pos: FloatArray
    heading: float
    lane_id: str
    lane_index: int
    lane_width: float
    lane_offset: float
    speed_limit: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VehicleState:
    """Another vehicle.

    Attributes:
        position: (3,).
        speed: m/s.
    """

    id: str
    position: FloatArray
    bounding_box: Box
    heading: float
    speed: float
    lane_id: str
    lane_index: int
    lane_position: LanePosition


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EgoState:
    """The vehicle that the policy drives.

    Attributes:
        linear_velocity: (3,) m/s; accelerations and jerks alike, angular ones in radians.
        steering: Radians.
        yaw_rate: rad/s.
    """

    id: str
    position: FloatArray
    bounding_box: Box
    heading: float
    speed: float
    steering: float
    yaw_rate: float
    lane_id: str
    lane_index: int
    lane_position: LanePosition
    mission: Mission
    linear_velocity: FloatArray
    linear_acceleration: FloatArray
    linear_jerk: FloatArray
    angular_velocity: FloatArray
    angular_acceleration: FloatArray
    angular_jerk: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Events:
    """Events of the vehicle; none, as a run with a collision has ended."""

    collisions: tuple[object, ...] = ()
    off_road: bool = False
    off_route: bool = False
    on_shoulder: bool = False
    wrong_way: bool = False
    not_moving: bool = False
    reached_goal: bool = False
    reached_max_episode_steps: bool = False
    agents_alive_done: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """An observation of SMARTS.

    Attributes:
        elapsed_sim_time: Seconds.
        steps_completed: 1 at the first step of a run, at which policies clear the last run.
        distance_travelled: Metres since the preceding step.
        waypoint_paths: For each lane of the road that leads on along the route, from the right, its
            way ahead with a point every metre; none is empty.
    """

    elapsed_sim_time: float
    steps_completed: int
    distance_travelled: float
    ego_vehicle_state: EgoState
    neighborhood_vehicle_states: tuple[VehicleState, ...]
    waypoint_paths: list[list[Waypoint]]
    events: Events = Events()

    @cached_property
    def lidar_point_cloud(
        self,
    ) -> tuple[list[FloatArray], list[bool], list[tuple[FloatArray, FloatArray]]]:
        """Points, hits and rays of a lidar that has hit nothing."""
        nowhere = np.zeros(3)
        return [nowhere] * _RAYS, [False] * _RAYS, [(nowhere, nowhere)] * _RAYS
