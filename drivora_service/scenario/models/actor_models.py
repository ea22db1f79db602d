"""The models of a document's actors: sizes, mass and limits of vehicles, walkers, obstacles.

The figures and their sources are in ``scenario.models.model_figures``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from types import MappingProxyType

from drivora_service.errors import UnknownName
from drivora_service.scenario.models import model_figures as figures


class ActorKind(StrEnum):
    """The kind of an actor."""

    VEHICLE = "vehicle"
    WALKER = "walker"
    OBSTACLE = "obstacle"


class VehicleClass(StrEnum):
    """The class of a vehicle model."""

    CAR = "car"
    VAN = "van"
    TRUCK = "truck"
    BUS = "bus"
    MOTORCYCLE = "motorcycle"
    BICYCLE = "bicycle"


@dataclass(frozen=True, slots=True, kw_only=True)
class ActorModel:
    """Size and limits of a model.

    Attributes:
        length: Metres, along the heading.
        width: Metres.
        height: Metres.
        vehicle_class: ``None`` if the model is not a vehicle.
        wheelbase: Metres between the axles (vehicles).
        mass: Kilograms (vehicles; two-wheelers with their rider).
        max_acceleration: m/s², from standstill on a dry road.
        max_deceleration: m/s², full braking on a dry road, positive.
        max_steer: Radians at the front wheels.
        max_speed: m/s.
    """

    name: str
    kind: ActorKind
    length: float
    width: float
    height: float
    vehicle_class: VehicleClass | None = None
    wheelbase: float = 0.0
    mass: float = 0.0
    max_acceleration: float = 0.0
    max_deceleration: float = 0.0
    max_steer: float = 0.0
    max_speed: float = 0.0


_PREFIXES: Mapping[ActorKind, str] = MappingProxyType(
    {
        ActorKind.VEHICLE: "vehicle.",
        ActorKind.WALKER: "walker.pedestrian.",
        ActorKind.OBSTACLE: "static.prop.",
    }
)


def _vehicles() -> tuple[ActorModel, ...]:
    return tuple(
        ActorModel(
            name=f"vehicle.{row.name}",
            kind=ActorKind.VEHICLE,
            length=row.length,
            width=row.width,
            vehicle_class=VehicleClass(row.vehicle_class),
            wheelbase=row.wheelbase,
            mass=row.mass,
            **figures.CLASS_LIMITS[row.vehicle_class]._asdict(),
        )
        for row in figures.VEHICLES
    )


def _walkers() -> tuple[ActorModel, ...]:
    models = []
    for number in range(1, figures.WALKER_COUNT + 1):
        size = figures.CHILD_SIZE if number in figures.SMALL_CHILDREN else figures.ADULT_SIZE
        child = number in figures.CHILDREN
        models.append(
            ActorModel(
                name=f"walker.pedestrian.{number:04d}",
                kind=ActorKind.WALKER,
                length=size,
                width=size,
                height=figures.CHILD_HEIGHT if child else figures.ADULT_HEIGHT,
                max_speed=figures.CHILD_MAX_SPEED if child else figures.ADULT_MAX_SPEED,
            )
        )
    return tuple(models)


def _obstacles() -> tuple[ActorModel, ...]:
    props = tuple(
        ActorModel(
            name=f"static.prop.{row.name}",
            kind=ActorKind.OBSTACLE,
            length=row.length,
            width=row.width,
            height=figures.TALL_OBSTACLES.get(row.name, figures.LOW_OBSTACLE_HEIGHT),
        )
        for row in figures.OBSTACLES
    )
    wrecks = tuple(
        ActorModel(
            name=model.name,
            kind=ActorKind.OBSTACLE,
            length=model.length,
            width=model.width,
            height=model.height,
        )
        for model in _vehicles()
    )
    return props + wrecks


_MODELS: Mapping[ActorKind, Mapping[str, ActorModel]] = MappingProxyType(
    {
        kind: MappingProxyType({model.name: model for model in models})
        for kind, models in (
            (ActorKind.VEHICLE, _vehicles()),
            (ActorKind.WALKER, _walkers()),
            (ActorKind.OBSTACLE, _obstacles()),
        )
    }
)


def _plain(name: str) -> str:
    return name.lower().replace("_", "").replace("-", "")


def _spellings(kind: ActorKind) -> Mapping[str, str]:
    """Returns the full names by accepted spelling, without case, underscores and hyphens."""
    spellings: dict[str, str] = {}
    for name in _MODELS[kind]:
        spellings[_plain(name)] = name
        spellings[_plain(name.removeprefix(_PREFIXES[kind]).removeprefix("vehicle."))] = name
    if kind is not ActorKind.WALKER:
        for name in _MODELS[kind]:
            if name.startswith("vehicle."):
                spellings.setdefault(_plain(name.rpartition(".")[2]), name)
        for alias, name in figures.VEHICLE_ALIASES.items():
            spellings[_plain(f"vehicle.{alias}")] = f"vehicle.{name}"
            spellings[_plain(alias)] = f"vehicle.{name}"
    return MappingProxyType(spellings)


_SPELLINGS: Mapping[ActorKind, Mapping[str, str]] = MappingProxyType(
    {kind: _spellings(kind) for kind in ActorKind}
)


def model_names(kind: ActorKind) -> tuple[str, ...]:
    """Returns the full names of the models of a kind, sorted."""
    return tuple(sorted(_MODELS[kind]))


def actor_model(kind: ActorKind, name: str) -> ActorModel:
    """Returns the model of an actor of ``kind`` by name.

    Case, hyphens and underscores are ignored, and the prefix (``vehicle.``,
    ``walker.pedestrian.``, ``static.prop.``) may be omitted; older and newer names of CARLA's
    blueprints are known. An obstacle may also be a vehicle: a parked wreck.

    Raises:
        UnknownName: No model of that kind has the name; names the closest one.
    """
    full_name = _SPELLINGS[kind].get(_plain(name))
    if full_name is not None:
        return _MODELS[kind][full_name]
    raise UnknownName(
        f"{kind.value} model", name, model_names(kind), "The document's reference describes them"
    )


def resize_model(model: ActorModel, length: float | None, width: float | None) -> ActorModel:
    """Returns the model with the size replaced by the given one, metres."""
    return replace(
        model,
        length=model.length if length is None else length,
        width=model.width if width is None else width,
    )
