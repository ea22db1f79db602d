"""Checks that the values of a scenario are within the bounds of documents.

The bounds are those of the fields of the document's classes. A value beyond them is not described
here, but by the validation of the scenario's document.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable
from functools import lru_cache
from operator import attrgetter
from types import GenericAlias
from typing import Any, get_args, get_origin

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from drivora_service.errors import InvalidDocument
from drivora_service.scenario import entities
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.plain_data import plain_data


def is_within_bounds(scenario: Scenario) -> bool:
    """Returns True only if a scenario's document is well-formed.

    Also False if an angle is beyond 720 rad, although the document has that angle within
    a full turn.
    """
    free_data = (scenario.extensions, *(ego.agent.parameters for ego in scenario.ego_vehicles))
    try:
        if any(plain_data(data)[1] for data in free_data):
            return False
        _bounds().check(scenario)
    except (InvalidDocument, ValidationError):
        return False
    return True


class _Columns:
    """Attributes of the objects of one class, checked as fields of a class of the document.

    All objects of the class are checked in one call, without making a document.
    """

    def __init__(
        self, document: type[entities.EntityDocument], *names: str, **renamed: str
    ) -> None:
        """Prepares the check.

        Args:
            document: The class of the document. A field that it does not have must be ``None``.
            names: At least two fields with attributes of the same names.
            renamed: Attributes with other names, by field.
        """
        attributes = {**{name: name for name in names}, **renamed}
        fields = tuple(_annotation(document.model_fields.get(name)) for name in attributes)
        rows: Any = GenericAlias(list, (GenericAlias(tuple, fields),))
        self._read = attrgetter(*attributes.values())
        self._adapter: TypeAdapter[Any] = TypeAdapter(rows)

    def check(self, objects: Iterable[object]) -> None:
        """Checks objects.

        Raises:
            ValidationError: A value is out of bounds.
        """
        self._adapter.validate_python(list(map(self._read, objects)))


def _annotation(field: FieldInfo | None) -> Any:
    """Returns the type of a field, without its parts, which are checked separately."""
    if field is None:
        return None
    origin, parts = get_origin(field.annotation), get_args(field.annotation)
    if origin in (tuple, dict):
        anything: Any = GenericAlias(
            origin, tuple(Any if _is_document(part) else part for part in parts)
        )
        field = copy.copy(field)
        field.annotation = anything
    return field.rebuild_annotation()


def _is_document(part: object) -> bool:
    return isinstance(part, type) and issubclass(part, entities.EntityDocument)


class _Bounds:
    """The bounds of all values of a scenario."""

    def __init__(self) -> None:
        place = ("x", "y", "z", "yaw", "speed", "wait")
        self._ego_places = _Columns(entities.WaypointDocument, *place)
        self._vehicle_places = _Columns(entities.NpcWaypointDocument, *place)
        self._walker_places = _Columns(entities.WalkerWaypointDocument, *place)
        self._locations = _Columns(entities.LocationDocument, *place)
        actor = ("id", "model", "start_time")
        ego = (*actor, "route", "initial_speed", "dynamics", "reference_path")
        self._egos = _Columns(entities.EgoDocument, *ego)
        pose = ("time", "x", "y", "z", "yaw", "speed")
        self._reference_poses = _Columns(entities.ReferencePoseDocument, *pose)
        self._agents = _Columns(entities.AgentDocument, "name", "parameters")
        driving = ("behavior", "at_end", "deceleration", "lateral_acceleration", "joins")
        self._vehicles = _Columns(entities.NpcVehicleDocument, *actor, "route", *driving)
        self._walkers = _Columns(entities.NpcWalkerDocument, *actor, "route", "joins")
        self._obstacles = _Columns(entities.NpcObstacleDocument, *actor, "length", "width")
        self._patches = _Columns(
            entities.FrictionPatchDocument, "id", "length", "width", "friction"
        )
        times = {"green_time": "green", "red_time": "red", "yellow_time": "yellow"}
        times["offset"] = "offset"
        self._junctions = _Columns(entities.LightTimesDocument, **times)
        general = {field: f"times.{attribute}" for field, attribute in times.items()}
        self._lights = _Columns(entities.TrafficLightsDocument, "junctions", **general)
        self._whole = _Columns(
            ScenarioDocument,
            *("ego_vehicles", "npc_vehicles", "npc_walkers", "npc_obstacles"),
            *("friction_patches", "weather_changes"),
            *("seed", "step_length", "max_sim_time", "stuck_after", "extensions"),
        )

    def check(self, scenario: Scenario) -> None:
        """Checks all values.

        Raises:
            ValidationError: One is out of bounds.
        """
        egos, vehicles = scenario.ego_vehicles, scenario.npc_vehicles
        walkers, obstacles = scenario.npc_walkers, scenario.npc_obstacles
        self._whole.check((scenario,))
        self._egos.check(egos)
        self._agents.check(ego.agent for ego in egos)
        self._reference_poses.check(pose for ego in egos for pose in ego.reference_path)
        self._vehicles.check(vehicles)
        self._ego_places.check(place for ego in egos for place in ego.route)
        self._vehicle_places.check(place for npc in vehicles for place in npc.route)
        self._walkers.check(walkers)
        self._walker_places.check(place for walker in walkers for place in walker.route)
        self._obstacles.check(obstacles)
        self._locations.check(obstacle.location for obstacle in obstacles)
        self._patches.check(scenario.friction_patches)
        self._locations.check(patch.location for patch in scenario.friction_patches)
        self._lights.check((scenario.traffic_lights,))
        self._junctions.check(scenario.traffic_lights.junctions.values())
        # Single parts have fields and attributes of the same names.
        for document, part in (
            (entities.MapRegionDocument, scenario.map_region),
            (entities.WeatherDocument, scenario.weather),
            (entities.BackgroundTrafficDocument, scenario.background_traffic),
        ):
            if part is not None:
                document.model_validate(part, from_attributes=True)
        for change in scenario.weather_changes:
            entities.WeatherChangeDocument.model_validate(change, from_attributes=True)


@lru_cache(maxsize=1)
def _bounds() -> _Bounds:
    return _Bounds()
