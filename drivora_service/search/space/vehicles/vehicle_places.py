"""Where an NPC vehicle starts, on which path and as which model: by its genes, or fixed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.search.genes import Block
from drivora_service.search.space.vehicles.npc_paths import NpcPath
from drivora_service.search.space.vehicles.vehicle_genes import MODELS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VehiclePlace:
    """The start of an NPC vehicle.

    Attributes:
        path: Its path.
        s: Arc length on the path where it starts, metres.
        model: Its model.
    """

    path: NpcPath
    s: float
    model: ActorModel


class GenePlaces:
    """Reads the start of a vehicle from its genes."""

    def __init__(self, block: Block, paths: Sequence[NpcPath]) -> None:
        self._paths = paths
        self._models = tuple(actor_model(ActorKind.VEHICLE, name) for name in MODELS)
        self._model = block.index("model")
        self.path_gene, self.shift_gene = block.index("path"), block.index("start")

    def path(self, values: FloatArray) -> NpcPath:
        """Returns the chosen path."""
        return self._paths[int(values[self.path_gene])]

    def shift_room(self, values: FloatArray) -> float:
        """Returns the metres that the start gene moves it by, from 0 to 1."""
        return self.path(values).start_room

    def place(self, values: FloatArray) -> VehiclePlace:
        """Returns the start."""
        path = self.path(values)
        return VehiclePlace(
            path=path,
            s=path.start_at(float(values[self.shift_gene])),
            model=self._models[int(values[self._model])],
        )
