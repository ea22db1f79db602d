"""Checks that slippery patches lie on the road and in the document's region."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivora_service.errors import Problem
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.drivable_area import meets_area
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.place_checks import bounds_hint, check_region
from drivora_service.scenario.conversion import patch
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import FrictionPatch, Region, Scenario
from drivora_service.scenario.plain_data import pointer


def place_patches(
    content: ScenarioDocument | Scenario, frame: FrameTransform
) -> tuple[FrictionPatch, ...]:
    """Returns the patches of a document or a scenario in the network's plane."""
    if isinstance(content, Scenario):
        return content.friction_patches
    return tuple(patch(one, frame) for one in content.friction_patches)


def patch_yaw(one: FrictionPatch, network: RoadNetwork) -> float:
    """Returns the direction of a patch's length; without one, that of the nearest lane."""
    if one.location.yaw is not None:
        return one.location.yaw
    lane = nearest_lane_position(network, one.location.x, one.location.y)
    return 0.0 if lane is None else lane.heading


def check_patches(
    patches: Sequence[FrictionPatch], network: RoadNetwork, region: Region | None
) -> list[Problem]:
    """Reports each patch that covers no part of the road, or whose centre is outside the region."""
    if not patches:
        return []
    poses = np.array(
        [
            (one.location.x, one.location.y, patch_yaw(one, network), one.length, one.width)
            for one in patches
        ]
    )
    on_road = meets_area(network, box_corners(*poses.T))
    problems: list[Problem] = []
    for number, (one, meets) in enumerate(zip(patches, on_road.tolist(), strict=True)):
        place, x, y = pointer(("friction_patches", number, "location")), *poses[number, :2]
        if not meets:
            message = (
                f"found ({x:.2f}, {y:.2f}) in the network's plane; the {one.length:g} m by "
                f"{one.width:g} m around it cover no part of the road of {network.name}, where "
                f"alone a patch has an effect{bounds_hint(network, x, y)}"
            )
            problems.append(Problem(pointer=place, code="off_network", message=message))
        if region is not None:
            problems += check_region(one.location, place, region)
    return problems
