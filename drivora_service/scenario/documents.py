"""The OpenScenario document: reading, and the checks that need no road network.

``scenario.validation`` checks a document against a road network and returns the ``Scenario`` of
``scenario.model``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import Field, JsonValue, ValidationError

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario import fields
from drivora_service.scenario.document_problems import (
    find_duplicate_ids,
    in_document_order,
    structural_problems,
)
from drivora_service.scenario.entities import (
    AgentDocument,
    BackgroundTrafficDocument,
    EgoDocument,
    EntityDocument,
    FreeData,
    FrictionPatchDocument,
    MapRegionDocument,
    NpcObstacleDocument,
    NpcVehicleDocument,
    NpcWalkerDocument,
    TrafficLightsDocument,
    WeatherChangeDocument,
    WeatherDocument,
    is_agent_name,
)
from drivora_service.scenario.plain_data import plain_data


class Frame(StrEnum):
    """The plane of a document's coordinates."""

    SUMO = "sumo"
    """The road network's plane: x east, y north, yaw in degrees counter-clockwise from east."""
    CARLA = "carla"
    """CARLA's left-handed world: x east, y south, yaw in degrees clockwise from east."""


class ScenarioDocument(EntityDocument):
    """One scenario: egos, other actors, traffic lights, weather and run options."""

    version: Literal["1.0"] = Field("1.0", description="Version of this format.")
    frame: Frame = Field(
        Frame.SUMO,
        description="Plane of all coordinates: sumo (x east, y north, yaw counter-clockwise) or "
        "carla (x east, y south, yaw clockwise).",
    )
    ego_vehicles: Annotated[
        tuple[EgoDocument, ...], Field(min_length=1, max_length=fields.MAX_EGOS)
    ] = Field(description="Vehicles under test.")
    npc_vehicles: Annotated[
        tuple[NpcVehicleDocument, ...], Field(max_length=fields.MAX_NPC_VEHICLES)
    ] = Field((), description="Vehicles that follow waypoints.")
    npc_walkers: Annotated[
        tuple[NpcWalkerDocument, ...], Field(max_length=fields.MAX_NPC_WALKERS)
    ] = Field((), description="Pedestrians.")
    npc_obstacles: Annotated[
        tuple[NpcObstacleDocument, ...], Field(max_length=fields.MAX_NPC_OBSTACLES)
    ] = Field((), description="Static objects.")
    friction_patches: Annotated[
        tuple[FrictionPatchDocument, ...], Field(max_length=fields.MAX_FRICTION_PATCHES)
    ] = Field((), description="Slippery places of the road.")
    map_region: MapRegionDocument = Field(description="Road network and region.")
    weather: WeatherDocument = Field(
        default_factory=WeatherDocument, description="Weather; clear by default."
    )
    weather_changes: Annotated[
        tuple[WeatherChangeDocument, ...], Field(max_length=fields.MAX_WEATHER_CHANGES)
    ] = Field((), description="Changes of the weather during the run, in the order of their times.")
    traffic_lights: TrafficLightsDocument = Field(
        default_factory=TrafficLightsDocument,
        description="Light times; the network's own by default.",
    )
    background_traffic: BackgroundTrafficDocument | None = Field(
        None, description="SUMO-driven traffic; none by default."
    )
    seed: fields.Seed = Field(0, description="Seeds every random draw of the run.")
    step_length: fields.StepLength = Field(0.05, description="Simulated time of one step.")
    max_sim_time: fields.SimTime | None = Field(
        None,
        description=(
            "End of the episode. Without it, derived from the ego routes and the longest waits at "
            "the signals on them."
        ),
    )
    stuck_after: fields.SimTime | None = Field(
        None,
        description="How long an ego may stand, with no signal to wait for, before its part ends. "
        "Without it, 60 s.",
    )
    extensions: Annotated[
        dict[fields.ExtensionKey, JsonValue], Field(max_length=fields.MAX_EXTENSIONS), FreeData
    ] = Field(
        default_factory=dict,
        description="Free data of other tools, by `vendor:name` or reverse domain name; carried, "
        "never interpreted by a run. Suites keep expectations in `drivora:suite`.",
        json_schema_extra={"additionalProperties": False},
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadDocument:
    """The result of reading a text.

    Attributes:
        content: The plain data.
        document: The document; ``None`` if the data is not a scenario.
        malformed: Structural mistakes, and unsupported values.
        duplicates: Actors and patches whose id is used before.
    """

    content: Mapping[str, Any]
    document: ScenarioDocument | None
    malformed: tuple[Problem, ...]
    duplicates: tuple[Problem, ...]


def read_document(
    data: str | bytes | Mapping[str, Any],
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
) -> ReadDocument:
    """Reads a document and finds all problems that need no road network.

    Args:
        data: Text, or data from a JSON parser.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: The text cannot be read at all.
    """
    content, problems = plain_data(data, format)
    document: ScenarioDocument | None = None
    try:
        document = ScenarioDocument.model_validate(content)
    except ValidationError as error:
        odd = {problem.pointer for problem in problems}
        structural = structural_problems(error, ScenarioDocument, content)
        problems += [problem for problem in structural if problem.pointer not in odd]
    return ReadDocument(
        content=content,
        document=document,
        malformed=tuple(problems),
        duplicates=tuple(find_duplicate_ids(content)),
    )


def parse_document(
    data: str | bytes | Mapping[str, Any],
    format: Literal["json", "yaml"] = "json",  # noqa: A002  # reads best in calls
) -> ScenarioDocument:
    """Reads a document and checks all that can be checked without a road network.

    ``scenario.validation.validate_data`` reads and checks against the network in one go.

    Args:
        data: Text, or data from a JSON parser.
        format: Language of the text; YAML without aliases and tags.

    Raises:
        InvalidDocument: The text cannot be read, or its content is not a scenario; lists all
            problems in document order.
    """
    read = read_document(data, format)
    problems = (*read.malformed, *read.duplicates)
    if read.document is None or problems:
        raise InvalidDocument(in_document_order(problems, read.content))
    return read.document


def with_agent(document: ScenarioDocument, name: str) -> ScenarioDocument:
    """Returns the document in which agent ``name`` without parameters drives every ego.

    Raises:
        InvalidDocument: ``name`` cannot be the name of an agent.
    """
    if not is_agent_name(name):
        message = f"{name!r} cannot be the name of an agent; see `drivora agents list`"
        raise InvalidDocument((Problem(pointer="", code="agent_name", message=message),))
    agent = AgentDocument(name=name)
    egos = tuple(
        ego.model_copy(update={"agent": agent, "config_path": None})
        for ego in document.ego_vehicles
    )
    return document.model_copy(update={"ego_vehicles": egos})


def with_background(document: ScenarioDocument, count: int) -> ScenarioDocument:
    """Returns the document with ``count`` vehicles of background traffic.

    Raises:
        InvalidDocument: ``count`` is out of bounds.
    """
    try:
        background = BackgroundTrafficDocument(count=count)
    except ValidationError as error:
        content = {"count": count}
        problems = structural_problems(error, BackgroundTrafficDocument, content)
        raise InvalidDocument(tuple(problems)) from error
    return document.model_copy(update={"background_traffic": background})


def document_text(document: ScenarioDocument) -> str:
    """Writes a document as stable, readable JSON that parses back to an equal document."""
    content = document.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    content = {"version": document.version, "frame": document.frame.value, **content}
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
