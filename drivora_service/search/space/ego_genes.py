"""The egos of a candidate: the seed's own, or egos placed by genes on routes near them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.model import EgoVehicle
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.search.genes import Block, Gene
from drivora_service.search.space.actor_starts import CLEAR_OF_EGO, Start
from drivora_service.search.space.alike import ABSENT, Decoded
from drivora_service.search.space.ego_routes import EgoRoute
from drivora_service.search.space.layout import choice, number, presence
from drivora_service.search.space.space_options import SpaceOptions

ALWAYS_PRESENT = 2
"""Least number of egos of a candidate with several."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlacedEgo:
    """An ego on its route.

    Attributes:
        ego: The ego.
        route: The route.
        s: Arc length on the route's path where it starts, metres.
        width: Metres.
        start: Its appearance.
    """

    ego: EgoVehicle
    route: EgoRoute
    s: float
    width: float
    start: Start


def ego_genes(options: SpaceOptions, index: int, routes: int) -> list[Gene]:
    """Returns the genes of the ego of that number."""
    return [
        presence(optional=index >= ALWAYS_PRESENT),
        choice("path", routes),
        number("start", 0.0, 1.0),
        number("start_time", 0.0, options.max_ego_delay, "s"),
    ]


def _place_ego(ego: EgoVehicle, route: EgoRoute, s: float) -> PlacedEgo:
    model = actor_model(ActorKind.VEHICLE, ego.model)
    start = Start(
        pose=route.path.at(s),
        length=model.length,
        width=model.width,
        until=ego.start_time,
        speed=ego.initial_speed,
        path=route.path,
        s=s,
        clear=CLEAR_OF_EGO,
    )
    return PlacedEgo(ego=ego, route=route, s=s, width=model.width, start=start)


class FixedEgo:
    """An ego of the seed, unchanged."""

    def __init__(self, ego: EgoVehicle, route: EgoRoute) -> None:
        self._placed = _place_ego(ego, route, 0.0)

    def place(self) -> PlacedEgo:
        """Returns the ego."""
        return self._placed


class GeneEgo:
    """Reads one ego's genes."""

    def __init__(self, block: Block, like: EgoVehicle, routes: Sequence[EgoRoute]) -> None:
        """Takes the ego from which it has its id, model, agent, dynamics and initial speed."""
        self.block, self._like, self._routes = block, like, routes
        self._present, self._start_time = block.start, block.index("start_time")
        self.path_gene, self.shift_gene = block.index("path"), block.index("start")

    def is_present(self, values: FloatArray) -> bool:
        """Returns whether the ego is present."""
        return bool(values[self._present] > 0.5)

    def shift_room(self, values: FloatArray) -> float:
        """Returns the metres that the start gene moves it by, from 0 to 1."""
        return self._routes[int(values[self.path_gene])].room

    def start(self, values: FloatArray) -> Start:
        """Returns its appearance."""
        return self.place(values).start

    def decode_part(self, values: FloatArray) -> Decoded:
        """Returns the ego and its appearance, as ``alike`` compares them."""
        if not self.is_present(values):
            return ABSENT
        placed = self.place(values)
        return placed.ego, placed.start

    def place(self, values: FloatArray) -> PlacedEgo:
        """Returns the ego."""
        route = self._routes[int(values[self.path_gene])]
        s = float(values[self.shift_gene]) * route.room
        ego = replace(
            self._like, route=route.from_start(s), start_time=float(values[self._start_time])
        )
        return _place_ego(ego, route, s)
