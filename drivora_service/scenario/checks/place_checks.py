"""Checks that all places of a scenario are on the network and in the document's region."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.errors import Problem
from drivora_service.networks.projection import nearest_lane_position, project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.placed_actors import PlacedActor
from drivora_service.scenario.model import NpcBehavior, Region, Waypoint

MAX_OFF_LANE = 12.0
"""Metres from the centre of a drivable lane up to which a waypoint of a vehicle is snapped to it: a
point of the CARLA Leaderboard's routes lies 9.3 m beside the road."""
MAX_PARKED_OFF_LANE = 30.0
"""The same limit for vehicles that do not follow lanes: parked and replayed ones."""
BOUNDS_MARGIN = 50.0
"""Metres beyond the network's bounds up to which walkers and obstacles are allowed."""
_SEARCH_RADIUS = 100.0


@dataclass(frozen=True, slots=True, kw_only=True)
class OffLanePlace:
    """A waypoint off the lanes that is near enough to be snapped to one.

    Attributes:
        place: Index of the waypoint.
        distance: Metres to the centre of the nearest drivable lane.
    """

    actor: PlacedActor
    place: int
    distance: float


def check_places(
    actors: Sequence[PlacedActor], network: RoadNetwork, region: Region | None
) -> tuple[list[Problem], list[OffLanePlace]]:
    """Checks all places.

    Returns:
        Problems, and the waypoints of egos that will be snapped to a lane.
    """
    problems: list[Problem] = []
    snapped: list[OffLanePlace] = []
    for actor in actors:
        if actor.is_vehicle:
            _check_lanes(actor, network, problems, snapped)
        else:
            _check_bounds(actor, network, problems)
        if region is not None:
            for index, place in enumerate(actor.places):
                problems += check_region(place, actor.place_pointer(index), region)
    return problems, snapped


def off_lane_limit(actor: PlacedActor) -> float:
    """Returns the metres from a lane's centre up to which a waypoint of a vehicle is accepted."""
    free = actor.behavior is NpcBehavior.REPLAY or (not actor.is_ego and len(actor.places) == 1)
    return MAX_PARKED_OFF_LANE if free else MAX_OFF_LANE


def _check_lanes(
    actor: PlacedActor,
    network: RoadNetwork,
    problems: list[Problem],
    snapped: list[OffLanePlace],
) -> None:
    limit = off_lane_limit(actor)
    points = np.array([(place.x, place.y) for place in actor.places])
    for index in np.flatnonzero(project_points(network, points).lane < 0):
        x, y = float(points[index, 0]), float(points[index, 1])
        near = nearest_lane_position(network, x, y, max_distance=limit)
        if near is None:
            far = nearest_lane_position(network, x, y, max_distance=_SEARCH_RADIUS)
            distance = None if far is None else abs(far.lateral)
            found = f"more than {_SEARCH_RADIUS:.0f} m" if distance is None else f"{distance:.1f} m"
            message = (
                f"found ({x:.2f}, {y:.2f}) in the network's plane, {found} from the nearest "
                f"drivable lane of {network.name}; at most {limit:.0f} m are allowed"
                f"{bounds_hint(network, x, y)}"
            )
            problems.append(
                Problem(
                    pointer=actor.place_pointer(int(index)), code="off_network", message=message
                )
            )
        elif actor.is_ego:
            distance = abs(near.lateral)
            snapped.append(OffLanePlace(actor=actor, place=int(index), distance=distance))


def _check_bounds(actor: PlacedActor, network: RoadNetwork, problems: list[Problem]) -> None:
    for index, place in enumerate(actor.places):
        if _is_outside(network, place.x, place.y):
            message = (
                f"found ({place.x:.2f}, {place.y:.2f}) in the network's plane, more than "
                f"{BOUNDS_MARGIN:.0f} m outside {network.name}"
                f"{bounds_hint(network, place.x, place.y)}"
            )
            problems.append(
                Problem(pointer=actor.place_pointer(index), code="off_network", message=message)
            )


def _is_outside(network: RoadNetwork, x: float, y: float) -> bool:
    min_x, min_y, max_x, max_y = network.bounds
    return not (
        min_x - BOUNDS_MARGIN <= x <= max_x + BOUNDS_MARGIN
        and min_y - BOUNDS_MARGIN <= y <= max_y + BOUNDS_MARGIN
    )


def bounds_hint(network: RoadNetwork, x: float, y: float) -> str:
    """Returns the bounds of a network, to be added to a message, if a place is outside of them."""
    if not _is_outside(network, x, y):
        return ""
    min_x, min_y, max_x, max_y = network.bounds
    return (
        f"; it spans x {min_x:.0f} to {max_x:.0f} and y {min_y:.0f} to {max_y:.0f} "
        "(coordinates of CARLA need `frame: carla`)"
    )


def check_region(place: Waypoint, place_pointer: str, region: Region) -> list[Problem]:
    """Reports a place outside a region."""
    if region.min_x <= place.x <= region.max_x and region.min_y <= place.y <= region.max_y:
        return []
    message = (
        f"found ({place.x:.2f}, {place.y:.2f}) in the network's plane, outside "
        f"region_segment (x {region.min_x:.2f} to {region.max_x:.2f}, "
        f"y {region.min_y:.2f} to {region.max_y:.2f})"
    )
    return [Problem(pointer=place_pointer, code="outside_region", message=message)]
