"""The area that an ego could use on its reference path, from which other actors keep away.

At a time it consists of the places of the ego's box on its path from a second before to a second
after that time, each with five metres ahead of it and half a metre on either side. A scenario in
which no further actor enters it leaves the path as free as it was. (The public code of Decictor,
Cheng et al., ICSE 2025, takes the places within the same second and five metres ahead of them.)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.planned_motion import PlannedMotion
from drivora_service.observations.reference_path import poses_at
from drivora_service.observations.trace import Col, PoseCol
from drivora_service.scenario.model import EgoVehicle, Scenario
from drivora_service.scenario.models.actor_models import ActorKind, actor_model

SLACK = 1.0
"""Seconds before and after a time."""
AHEAD = 5.0
"""Metres ahead of the box."""
BESIDE = 0.5
"""Metres on either side of the box."""
_SAMPLE = 0.1
"""Seconds between two places of the path: at 30 m/s their boxes still overlap."""

PlannedMotions = Callable[[Scenario, RoadNetwork, float], Iterable[PlannedMotion]]
"""Returns the planned motions of a scenario's actors up to a time, seconds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UsableArea:
    """The area of one ego.

    Attributes:
        places: (n, 4) of boxes that are part of it, columns ``PoseCol`` up to the heading.
        length: Length of each, metres.
        width: Width of each, metres.
    """

    places: FloatArray
    length: float
    width: float

    def is_entered(self, motion: PlannedMotion) -> bool:
        """Returns whether an actor is planned to enter it, or may do so with a delay."""
        after = math.inf if motion.may_be_late else SLACK
        entered: bool = _enters(
            motion.times, motion.poses, motion.present, motion.length, motion.width,
            self.places, self.length, self.width, SLACK, after,
        )  # fmt: skip
        return entered


def usable_areas(scenario: Scenario) -> tuple[UsableArea, ...]:
    """Returns the areas of the egos that have a reference path."""
    return tuple(_area(ego) for ego in scenario.ego_vehicles if ego.reference_path)


def intruders(
    scenario: Scenario, network: RoadNetwork, actors: frozenset[str], motions: PlannedMotions
) -> frozenset[str]:
    """Returns which of some actors are planned to enter the area of an ego.

    Args:
        scenario: The scenario, with reference paths.
        network: Its road network.
        actors: Ids of the actors.
        motions: Plans the motions.
    """
    areas = usable_areas(scenario)
    if not areas:
        return frozenset()
    until = max(float(area.places[-1, 0]) for area in areas) + SLACK
    return frozenset(
        motion.id
        for motion in motions(scenario, network, until)
        if motion.id in actors and any(area.is_entered(motion) for area in areas)
    )


def _area(ego: EgoVehicle) -> UsableArea:
    model = actor_model(ActorKind.VEHICLE, ego.model)
    path = np.array(
        [(pose.time, pose.x, pose.y, pose.yaw, pose.speed, 0.0) for pose in ego.reference_path]
    )
    # From the start of the scenario on: until its start time, the ego stands at its start.
    end = float(path[-1, PoseCol.TIME])
    times = np.append(np.arange(0.0, end, _SAMPLE), end)
    poses = poses_at(path, times)
    yaw = poses[:, PoseCol.YAW]
    return UsableArea(
        places=np.stack(
            (
                times,
                poses[:, PoseCol.X] + 0.5 * AHEAD * elementary.cos(yaw),
                poses[:, PoseCol.Y] + 0.5 * AHEAD * elementary.sin(yaw),
                yaw,
            ),
            axis=1,
        ),
        length=model.length + AHEAD,
        width=model.width + 2.0 * BESIDE,
    )


@compiled
def _enters(
    times: FloatArray,
    poses: FloatArray,
    present: BoolArray,
    length: float,
    width: float,
    places: FloatArray,
    area_length: float,
    area_width: float,
    before: float,
    after: float,
) -> bool:
    reach = 0.5 * (math.hypot(length, width) + math.hypot(area_length, area_width))
    first = 0
    for t in range(times.shape[0]):
        if not present[t]:
            continue
        x, y, yaw = poses[t, Col.X], poses[t, Col.Y], poses[t, Col.YAW]
        while first < places.shape[0] and places[first, PoseCol.TIME] < times[t] - before:
            first += 1
        for k in range(first, places.shape[0]):
            if places[k, PoseCol.TIME] > times[t] + after:
                break
            area_x, area_y = places[k, PoseCol.X], places[k, PoseCol.Y]
            if abs(area_x - x) > reach or abs(area_y - y) > reach:
                continue
            if boxes_overlap(
                area_x, area_y, places[k, PoseCol.YAW], area_length, area_width,
                x, y, yaw, length, width,
            ):  # fmt: skip
                return True
    return False
