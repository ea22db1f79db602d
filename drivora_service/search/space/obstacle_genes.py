"""Genes of an obstacle beside or partly on an ego's way, and their decoding."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.model import NpcObstacle
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.search.genes import Block, Gene
from drivora_service.search.space.actor_starts import Start
from drivora_service.search.space.alike import ABSENT, Decoded
from drivora_service.search.space.driven_path import Pose
from drivora_service.search.space.ego_genes import PlacedEgo
from drivora_service.search.space.ego_routes import EgoRoute
from drivora_service.search.space.layout import choice, number, presence
from drivora_service.search.space.roadside import place_at, places_from
from drivora_service.search.space.space_options import SpaceOptions

MODELS = (
    "static.prop.constructioncone",
    "static.prop.trafficcone01",
    "static.prop.streetbarrier",
    "static.prop.warningconstruction",
    "static.prop.container",
    "static.prop.box02",
    "vehicle.nissan.micra",
    "vehicle.mercedes.sprinter",
)
"""Objects of building sites, lost loads, and parked vehicles."""
MAX_LATERAL = 5.0
"""Metres from the lane's centre."""
MAX_YAW = 0.5 * math.pi
CLEARANCE = 0.8
"""Least clearance of an ego in the middle of its lane to an obstacle, metres: a blocked lane would
make every ADS fail alike."""
_TOLERATED = 0.9
"""Share of the clearance that is left if the road bends slightly."""
AHEAD_OF_EGO = 15.0
"""Metres ahead of an ego's start where the first obstacle stands."""
_BEFORE_DESTINATION = 8.0


def obstacle_genes(options: SpaceOptions, egos: int) -> list[Gene]:
    """Returns the genes of an obstacle."""
    return [
        presence(optional=options.optional),
        choice("model", len(MODELS)),
        choice("path", egos),
        number("place", 0.0, 1.0),
        number("lateral", -MAX_LATERAL, MAX_LATERAL, "m"),
        number("yaw", -MAX_YAW, MAX_YAW, "rad"),
    ]


class ObstacleDecoder:
    """Reads one obstacle's genes."""

    def __init__(self, block: Block, actor_id: str) -> None:
        self.block, self._id = block, actor_id
        self._models = tuple(actor_model(ActorKind.OBSTACLE, name) for name in MODELS)
        self._present = block.start
        self._model, self._path = block.index("model"), block.index("path")
        self.shift_gene = block.index("place")
        self._lateral, self._yaw = block.index("lateral"), block.index("yaw")

    def is_present(self, values: FloatArray) -> bool:
        """Returns whether the obstacle is present."""
        return bool(values[self._present] > 0.5)

    def shift_room(self, egos: Sequence[PlacedEgo], values: FloatArray) -> float:
        """Returns the metres that the place gene moves it by, from 0 to 1."""
        ego = self._ego(egos, values)
        places = _places(ego.route, ego.s)
        return float(places[-1] - places[0])

    def other_sides(self, values: FloatArray) -> tuple[tuple[int, float], ...]:
        """Returns other values of the lateral gene: the other side, and the farthest places."""
        own = float(values[self._lateral])
        return tuple((self._lateral, value) for value in (-own, -MAX_LATERAL, MAX_LATERAL))

    def start(self, egos: Sequence[PlacedEgo], values: FloatArray) -> Start:
        """Returns its appearance."""
        model = self._model_of(values)
        return Start(
            pose=self._pose(egos, values, model),
            length=model.length,
            width=model.width,
            until=math.inf,
        )

    def obstacle(self, egos: Sequence[PlacedEgo], values: FloatArray) -> NpcObstacle:
        """Returns the obstacle."""
        model = self._model_of(values)
        pose = self._pose(egos, values, model)
        return NpcObstacle(id=self._id, model=model.name, location=pose.waypoint())

    def _model_of(self, values: FloatArray) -> ActorModel:
        return self._models[int(values[self._model])]

    def decode_part(self, egos: Sequence[PlacedEgo], values: FloatArray) -> Decoded:
        """Returns the obstacle and its appearance, as ``alike`` compares them."""
        if not self.is_present(values):
            return ABSENT
        return self.obstacle(egos, values), self.start(egos, values)

    def _ego(self, egos: Sequence[PlacedEgo], values: FloatArray) -> PlacedEgo:
        return egos[int(values[self._path]) % len(egos)]

    def _pose(self, egos: Sequence[PlacedEgo], values: FloatArray, model: ActorModel) -> Pose:
        ego = self._ego(egos, values)
        places = _places(ego.route, ego.s)
        lane = ego.route.path.at(place_at(places, float(values[self.shift_gene])))
        turn, lateral = float(values[self._yaw]), float(values[self._lateral])
        across = 0.5 * (model.length * abs(math.sin(turn)) + model.width * math.cos(turn))
        least = across + 0.5 * ego.width + CLEARANCE
        if abs(lateral) < least:
            lateral = math.copysign(least, lateral)
        place = lane.beside(lateral)
        return Pose(x=place.x, y=place.y, yaw=place.yaw + turn)


@lru_cache(maxsize=64)
def _places(route: EgoRoute, begin: float) -> FloatArray:
    """Returns the arc lengths at which obstacles may stand if an ego starts at ``begin``.

    Cached, as an obstacle's appearance is computed repeatedly while it is moved.
    """
    places = route.roadside.straights
    last = route.path.length - _BEFORE_DESTINATION
    before = places[: max(int(np.searchsorted(places, last)), 1)]
    return places_from(before, begin + AHEAD_OF_EGO)


def blocks_lane(start: Start, egos: Sequence[PlacedEgo]) -> bool:
    """Returns whether an obstacle leaves an ego too little clearance in the middle of its lane."""
    pose = start.pose
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    return any(
        _is_near(
            ego.route.path.line, pose.x, pose.y, cos, sin, 0.5 * start.length, 0.5 * start.width,
            0.5 * ego.width + _TOLERATED * CLEARANCE,
        )
        for ego in egos
    )  # fmt: skip


@compiled
def _is_near(
    line: FloatArray,
    x: float,
    y: float,
    cos: float,
    sin: float,
    half_length: float,
    half_width: float,
    distance: float,
) -> bool:
    """Returns whether a point of a line (n, 2) is nearer to a box than a distance."""
    for i in range(line.shape[0]):
        dx, dy = line[i, 0] - x, line[i, 1] - y
        along = max(abs(dx * cos + dy * sin) - half_length, 0.0)
        across = max(abs(dy * cos - dx * sin) - half_width, 0.0)
        if math.hypot(along, across) < distance:
            return True
    return False
