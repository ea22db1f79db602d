"""Genes of a walker that crosses an ego's way, and their decoding."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import NpcWalker, Waypoint
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.search.genes import Block, Gene
from drivora_service.search.space.actor_starts import Start
from drivora_service.search.space.alike import ABSENT, Decoded
from drivora_service.search.space.driven_path import Pose
from drivora_service.search.space.ego_genes import PlacedEgo
from drivora_service.search.space.layout import choice, number, presence
from drivora_service.search.space.roadside import edge_distances, place_at, places_from
from drivora_service.search.space.space_options import SpaceOptions

MODEL = "walker.pedestrian.0001"
SPEEDS = (1.25, 3.0)
"""m/s, from walking to running (DoppelTest, Huai et al. 2023)."""
MAX_ANGLE = 0.7
"""Deviation from the perpendicular, radians."""
AHEAD_OF_EGO = 12.0
"""Metres ahead of an ego's start where the first walker crosses."""
_LONGEST = 1.5
"""Greatest length of an oblique crossing over the perpendicular one; a longer one leads along the
road or into a junction, and the walker crosses at a steeper angle."""
_SLANTS = (1.0, 0.5, 0.0)


def walker_genes(options: SpaceOptions, egos: int) -> list[Gene]:
    """Returns the genes of a walker."""
    return [
        presence(optional=options.optional),
        choice("path", egos),
        number("place", 0.0, 1.0),
        choice("side", 2),
        number("angle", -MAX_ANGLE, MAX_ANGLE, "rad"),
        number("speed", *SPEEDS, "m/s"),
        number("start_time", 0.0, options.max_walker_delay, "s"),
    ]


class WalkerDecoder:
    """Reads one walker's genes."""

    def __init__(self, block: Block, actor_id: str) -> None:
        self.block, self._id = block, actor_id
        self._model = actor_model(ActorKind.WALKER, MODEL)
        self._present = block.start
        self._path, self.shift_gene = block.index("path"), block.index("place")
        self._side, self._angle = block.index("side"), block.index("angle")
        self._speed, self._start_time = block.index("speed"), block.index("start_time")

    def is_present(self, values: FloatArray) -> bool:
        """Returns whether the walker is present."""
        return bool(values[self._present] > 0.5)

    def shift_room(self, egos: Sequence[PlacedEgo], values: FloatArray) -> float:
        """Returns the metres that the place gene moves it by, from 0 to 1."""
        places = self._places(self._ego(egos, values))
        return float(places[-1] - places[0])

    def start(self, egos: Sequence[PlacedEgo], values: FloatArray) -> Start:
        """Returns the walker's appearance."""
        begin, _ = self._way(egos, values)
        time = float(values[self._start_time])
        size = self._model.length
        return Start(pose=begin, length=size, width=size, appears=time, until=time)

    def walker(self, egos: Sequence[PlacedEgo], values: FloatArray) -> NpcWalker:
        """Returns the walker."""
        speed = float(values[self._speed])
        begin, end = self._way(egos, values)
        return NpcWalker(
            id=self._id,
            model=self._model.name,
            route=(_waypoint(begin, speed), _waypoint(end, speed)),
            start_time=float(values[self._start_time]),
        )

    def decode_part(self, egos: Sequence[PlacedEgo], values: FloatArray) -> Decoded:
        """Returns the walker and its appearance, as ``alike`` compares them."""
        if not self.is_present(values):
            return ABSENT
        return self.walker(egos, values), self.start(egos, values)

    def _ego(self, egos: Sequence[PlacedEgo], values: FloatArray) -> PlacedEgo:
        return egos[int(values[self._path]) % len(egos)]

    def _places(self, ego: PlacedEgo) -> FloatArray:
        return places_from(ego.route.roadside.crossings, ego.s + AHEAD_OF_EGO)

    def _way(self, egos: Sequence[PlacedEgo], values: FloatArray) -> tuple[Pose, Pose]:
        ego = self._ego(egos, values)
        path = ego.route.path
        middle = path.at(place_at(self._places(ego), float(values[self.shift_gene])))
        angles, left, right = _edges(path.network, middle, float(values[self._angle]))
        straight = left[-1] + right[-1]
        nth = int(np.argmax(left + right <= _LONGEST * straight))
        ends = (_ahead(middle, angles[nth], left[nth]), _ahead(middle, angles[nth], -right[nth]))
        return ends if values[self._side] > 0.5 else (ends[1], ends[0])


@lru_cache(maxsize=256)
def _edges(
    network: RoadNetwork, middle: Pose, angle: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Returns directions across a road, with the distances of its edges ahead and behind.

    Cached, as a walker's appearance is computed repeatedly while other actors are moved.
    """
    angles = middle.yaw + 0.5 * math.pi + angle * np.array(_SLANTS)
    count = len(angles)
    xy = np.full((2 * count, 2), (middle.x, middle.y))
    found = edge_distances(network, xy, np.concatenate((angles, angles + math.pi)))
    return angles, found[:count], found[count:]


def _ahead(pose: Pose, direction: float, distance: float) -> Pose:
    return Pose(
        x=pose.x + distance * math.cos(direction),
        y=pose.y + distance * math.sin(direction),
        yaw=direction,
    )


def _waypoint(pose: Pose, speed: float) -> Waypoint:
    place = pose.waypoint(speed)
    return Waypoint(x=place.x, y=place.y, speed=place.speed)
