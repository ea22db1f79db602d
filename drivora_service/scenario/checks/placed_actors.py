"""The actors of a document or a scenario, in the network's plane, for the checks of validation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.errors import Problem, UnknownName
from drivora_service.scenario.conversion import waypoint
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import (
    EgoDocument,
    NpcObstacleDocument,
    NpcVehicleDocument,
    NpcWalkerDocument,
    PlaceDocument,
)
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import (
    EgoVehicle,
    NpcBehavior,
    NpcObstacle,
    NpcVehicle,
    NpcWalker,
    Scenario,
    Waypoint,
)
from drivora_service.scenario.models.actor_models import (
    ActorKind,
    ActorModel,
    actor_model,
    resize_model,
)
from drivora_service.scenario.plain_data import pointer


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedActor:
    """An actor of a document or a scenario.

    Attributes:
        list_name: The document's list that contains it, such as ``npc_vehicles``.
        index: Its index in that list.
        model: Its model; ``None`` if the model does not exist.
        places: Its waypoints, or its single location, in the network's plane.
        start_time: Seconds.
        behavior: Behaviour of an NPC vehicle; else ``None``.
        is_ego: Whether an ADS controls it.
    """

    list_name: str
    index: int
    id: str
    model: ActorModel | None
    places: tuple[Waypoint, ...]
    start_time: float
    behavior: NpcBehavior | None = None
    is_ego: bool = False

    @property
    def is_vehicle(self) -> bool:
        """Whether it is an ego or an NPC vehicle."""
        return self.is_ego or self.behavior is not None

    @property
    def pointer(self) -> str:
        """JSON pointer to the actor."""
        return pointer((self.list_name, self.index))

    def place_pointer(self, place: int) -> str:
        """Returns the JSON pointer to one of its places."""
        if self.list_name == "npc_obstacles":
            return f"{self.pointer}/location"
        return f"{self.pointer}/route/{place}"


def place_actors(
    content: ScenarioDocument | Scenario, frame: FrameTransform
) -> tuple[tuple[PlacedActor, ...], list[Problem]]:
    """Returns all actors in document order, and a problem for each model that does not exist.

    Args:
        content: Document or scenario with the actors.
        frame: Transformation from the document's frame to the network's plane; unused for a
            scenario.
    """
    problems: list[Problem] = []
    egos: Sequence[EgoDocument | EgoVehicle] = content.ego_vehicles
    vehicles: Sequence[NpcVehicleDocument | NpcVehicle] = content.npc_vehicles
    walkers: Sequence[NpcWalkerDocument | NpcWalker] = content.npc_walkers
    obstacles: Sequence[NpcObstacleDocument | NpcObstacle] = content.npc_obstacles
    actors = [
        *(_ego(index, ego, frame, problems) for index, ego in enumerate(egos)),
        *(_vehicle(index, npc, frame, problems) for index, npc in enumerate(vehicles)),
        *(_walker(index, walker, frame, problems) for index, walker in enumerate(walkers)),
        *(_obstacle(index, one, frame, problems) for index, one in enumerate(obstacles)),
    ]
    return tuple(actors), problems


def _ego(
    index: int, ego: EgoDocument | EgoVehicle, frame: FrameTransform, problems: list[Problem]
) -> PlacedActor:
    return PlacedActor(
        list_name="ego_vehicles",
        index=index,
        id=ego.id,
        model=_model(ActorKind.VEHICLE, ego.model, "ego_vehicles", index, problems),
        places=_places(ego.route, frame),
        start_time=ego.start_time,
        is_ego=True,
    )


def _vehicle(
    index: int,
    npc: NpcVehicleDocument | NpcVehicle,
    frame: FrameTransform,
    problems: list[Problem],
) -> PlacedActor:
    return PlacedActor(
        list_name="npc_vehicles",
        index=index,
        id=npc.id,
        model=_model(ActorKind.VEHICLE, npc.model, "npc_vehicles", index, problems),
        places=_places(npc.route, frame),
        start_time=npc.start_time,
        behavior=npc.behavior,
    )


def _walker(
    index: int,
    walker: NpcWalkerDocument | NpcWalker,
    frame: FrameTransform,
    problems: list[Problem],
) -> PlacedActor:
    return PlacedActor(
        list_name="npc_walkers",
        index=index,
        id=walker.id,
        model=_model(ActorKind.WALKER, walker.model, "npc_walkers", index, problems),
        places=_places(walker.route, frame),
        start_time=walker.start_time,
    )


def _obstacle(
    index: int,
    obstacle: NpcObstacleDocument | NpcObstacle,
    frame: FrameTransform,
    problems: list[Problem],
) -> PlacedActor:
    found = _model(ActorKind.OBSTACLE, obstacle.model, "npc_obstacles", index, problems)
    return PlacedActor(
        list_name="npc_obstacles",
        index=index,
        id=obstacle.id,
        model=found and resize_model(found, obstacle.length, obstacle.width),
        places=_places((obstacle.location,), frame),
        start_time=obstacle.start_time,
    )


def _places(
    places: Sequence[PlaceDocument | Waypoint], frame: FrameTransform
) -> tuple[Waypoint, ...]:
    return tuple(
        place if isinstance(place, Waypoint) else waypoint(place, frame) for place in places
    )


def _model(
    kind: ActorKind, name: str, list_name: str, index: int, problems: list[Problem]
) -> ActorModel | None:
    try:
        return actor_model(kind, name)
    except UnknownName as error:
        code, message = "unknown_model", str(error)
        other = _kind_of(name)
        if other is not None:
            code = "wrong_kind"
            message = f"found the {other.value} model {name!r}; a {kind.value} model is needed"
        place = pointer((list_name, index, "model"))
        problems.append(Problem(pointer=place, code=code, message=message))
        return None


def _kind_of(name: str) -> ActorKind | None:
    for kind in (ActorKind.VEHICLE, ActorKind.WALKER, ActorKind.OBSTACLE):
        try:
            actor_model(kind, name)
        except UnknownName:
            continue
        return kind
    return None
