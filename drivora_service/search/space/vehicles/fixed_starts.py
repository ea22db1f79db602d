"""Starts of NPC vehicles that do not vary: near an ego, on paths of different relations to it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

from drivora_service.errors import SearchError
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.search.space.actor_starts import Start, too_near
from drivora_service.search.space.relations import Relation
from drivora_service.search.space.vehicles.npc_paths import NpcPath
from drivora_service.search.space.vehicles.vehicle_places import VehiclePlace

MODEL = "vehicle.nissan.patrol"
"""A sport utility vehicle, as in the public code of AVFuzzer."""
DISTANCES = (58.0, 88.0)
"""Metres from the ego to the vehicles in turn: those of the motorway in the public code of AVFuzzer
(Li et al. 2020), where one starts in the ego's lane and the other three lanes beside it."""
_RELATIONS = (
    Relation.LEADING,
    Relation.BESIDE,
    Relation.ONCOMING,
    Relation.MERGING,
    Relation.CROSSING,
    Relation.TRAILING,
)
"""Order in which relations are tried; each further vehicle begins with the next one."""
_TOLERANCE = 20.0
"""Metres from the wanted distance within which a place of an earlier relation is taken."""
_SPACING = 2.0


def choose_fixed_starts(
    paths: Sequence[NpcPath], ego: Start, taken: Sequence[Start], count: int, fastest: float
) -> tuple[VehiclePlace, ...]:
    """Chooses the starts of vehicles; the same for the same arguments.

    Args:
        paths: Paths around the ego's route.
        ego: Start of the ego.
        taken: Starts of all other actors.
        count: Number of vehicles.
        fastest: Their greatest initial speed, m/s; at none may a collision be unavoidable.

    Raises:
        SearchError: There is no place for one of them.
    """
    others = [ego, *taken]
    places: list[VehiclePlace] = []
    for number in range(count):
        place = _choose(paths, ego, others, number, fastest)
        if place is None:
            raise SearchError(
                f"of {count} NPC vehicles with fixed starts, only {number} have a place near the "
                "first ego; use fewer vehicles, raise `reach`, or set `starts` to free"
            )
        places.append(place)
        others.append(replace(_start(place, 0.0), until=math.inf))
    return tuple(places)


def _choose(
    paths: Sequence[NpcPath], ego: Start, others: Sequence[Start], number: int, fastest: float
) -> VehiclePlace | None:
    """Returns the place at the wanted distance of the first relation that has a free one.

    Places ahead of the ego are preferred to those behind it, and within a tolerance those nearer
    to the wanted distance.
    """
    wanted = DISTANCES[number % len(DISTANCES)]
    first = number % len(_RELATIONS)
    relations = (*_RELATIONS[first:], *_RELATIONS[:first])
    free: dict[tuple[bool, Relation], list[tuple[float, VehiclePlace]]] = {}
    for path in paths:
        for place in _places(path):
            if _is_free(place, others, fastest):
                ahead, aside = _compute_offset(ego, place)
                gap = abs(math.hypot(ahead, aside) - wanted)
                free.setdefault((ahead > 0.0, path.relation), []).append((gap, place))
    for tolerance, is_ahead in product((_TOLERANCE, math.inf), (True, False)):
        for relation in relations:
            gaps = free.get((is_ahead, relation), [])
            near = [(gap, place) for gap, place in gaps if gap <= tolerance]
            if near:
                return min(near, key=lambda one: one[0])[1]
    return None


def _places(path: NpcPath) -> Iterator[VehiclePlace]:
    model = actor_model(ActorKind.VEHICLE, MODEL)
    for step in range(int(path.start_room / _SPACING) + 1):
        s = path.start_at(step * _SPACING / path.start_room)
        yield VehiclePlace(path=path, s=s, model=model)


def _is_free(place: VehiclePlace, others: Sequence[Start], fastest: float) -> bool:
    return not any(
        too_near(_start(place, speed), other) for speed in (0.0, fastest) for other in others
    )


def _start(place: VehiclePlace, speed: float) -> Start:
    return Start(
        pose=place.path.path.at(place.s),
        length=place.model.length,
        width=place.model.width,
        speed=speed,
        path=place.path.path,
        s=place.s,
    )


def _compute_offset(ego: Start, place: VehiclePlace) -> tuple[float, float]:
    """Returns the metres by which a place is ahead of an ego, and to its left."""
    pose = place.path.path.at(place.s)
    dx, dy = pose.x - ego.pose.x, pose.y - ego.pose.y
    cos, sin = math.cos(ego.pose.yaw), math.sin(ego.pose.yaw)
    return dx * cos + dy * sin, dy * cos - dx * sin
