"""Scenes turned so that the ego faces north, for policies with errors in other headings.

DSAC and CASL subtract headings without wrapping, and so steer off the road on the way south;
DSAC puts the empty places of its list at (200, 200), where they would count as vehicles.
Neither stores more of a scene than the driven distance, so each scene may have a frame of its
own: the ego faces north, at the driven distance north of the origin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from drivora_service.agents.adapters.smarts_agents.scene import (
    Goal,
    Mission,
    Scene,
    VehicleState,
    Waypoint,
)
from drivora_service.geometry.array_shapes import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Facing:
    """A frame in which the ego faces north.

    Attributes:
        origin: (2,) the ego's place in the network's plane.
        heading: SMARTS's heading of the ego there.
        driven: Metres north of the frame's origin of the ego in the frame.
    """

    origin: FloatArray
    heading: float
    driven: float

    def transform_scene(self, scene: Scene) -> Scene:
        """Returns a scene in this frame."""
        ego = scene.ego_vehicle_state
        return replace(
            scene,
            ego_vehicle_state=replace(
                ego,
                position=self._place(ego.position),
                heading=self._heading(ego.heading),
                mission=Mission(goal=Goal(position=self._place(ego.mission.goal.position))),
                linear_velocity=self._rotate(ego.linear_velocity, -self.heading),
                linear_acceleration=self._rotate(ego.linear_acceleration, -self.heading),
            ),
            neighborhood_vehicle_states=tuple(
                self._vehicle(vehicle) for vehicle in scene.neighborhood_vehicle_states
            ),
            waypoint_paths=[
                [self._waypoint(waypoint) for waypoint in path] for path in scene.waypoint_paths
            ],
        )

    def restore_pose(self, x: float, y: float, heading: float) -> tuple[float, float, float]:
        """Returns a pose of this frame in the network's plane."""
        east, north = self._rotate(np.array([x, y - self.driven]), self.heading).tolist()
        return (
            float(self.origin[0]) + east,
            float(self.origin[1]) + north,
            math.remainder(heading + self.heading, math.tau),
        )

    def _place(self, place: FloatArray) -> FloatArray:
        here = place.copy()
        here[:2] = self._rotate(place[:2] - self.origin, -self.heading)
        here[1] += self.driven
        return here

    def _heading(self, heading: float) -> float:
        return math.remainder(heading - self.heading, math.tau)

    def _vehicle(self, vehicle: VehicleState) -> VehicleState:
        place, heading = self._place(vehicle.position), self._heading(vehicle.heading)
        return replace(vehicle, position=place, heading=heading)

    def _waypoint(self, waypoint: Waypoint) -> Waypoint:
        place, heading = self._place(waypoint.pos), self._heading(waypoint.heading)
        return replace(waypoint, pos=place, heading=heading)

    @staticmethod
    def _rotate(vector: FloatArray, angle: float) -> FloatArray:
        """Turns x and y counter-clockwise."""
        cos, sin = math.cos(angle), math.sin(angle)
        turned = vector.copy()
        turned[0] = cos * vector[0] - sin * vector[1]
        turned[1] = sin * vector[0] + cos * vector[1]
        return turned


def make_facing(scene: Scene, driven: float) -> Facing:
    """Returns the frame of a scene, for an ego that has driven ``driven`` metres."""
    ego = scene.ego_vehicle_state
    return Facing(origin=ego.position[:2].copy(), heading=ego.heading, driven=driven)
