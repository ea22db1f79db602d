"""Number and text types of the document, each with its unit and its bounds.

Numbers are strict: no text, no booleans, no NaN, no infinity. The unit is in the JSON Schema
as ``x-unit``.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field

MAX_EGOS = 64
MAX_NPC_VEHICLES = 500
MAX_NPC_WALKERS = 500
MAX_NPC_OBSTACLES = 1000
MAX_FRICTION_PATCHES = 100
MAX_WEATHER_CHANGES = 500
MAX_WAYPOINTS = 2000
MAX_REFERENCE_POSES = 4000
MAX_BACKGROUND_VEHICLES = 2000
MAX_JUNCTIONS = 2000
MAX_EXTENSIONS = 64
MAX_COORDINATE = 1e6
MAX_VEHICLE_SPEED = 100.0
MAX_WALKER_SPEED = 10.0
MAX_START_TIME = 7200.0
MAX_SIM_TIME = 7200.0
ACCELERATIONS = (0.5, 12.0)
"""m/s², of NPC vehicles: from gently rolling to more than a dry road allows."""
MAX_SEED = 2**31 - 1
"""SUMO's seed is a signed 32-bit integer."""


def _number(unit: str, low: float, high: float) -> Any:
    return Field(
        strict=True, allow_inf_nan=False, ge=low, le=high, json_schema_extra={"x-unit": unit}
    )


def _integer(unit: str, low: int, high: int) -> Any:
    return Field(strict=True, ge=low, le=high, json_schema_extra={"x-unit": unit})


Coordinate = Annotated[float, _number("m", -MAX_COORDINATE, MAX_COORDINATE)]
Elevation = Annotated[float, _number("m", -1e5, 1e5)]
Yaw = Annotated[float, _number("deg", -720.0, 720.0)]
VehicleSpeed = Annotated[float, _number("m/s", 0.0, MAX_VEHICLE_SPEED)]
WalkerSpeed = Annotated[float, _number("m/s", 0.0, MAX_WALKER_SPEED)]
StartTime = Annotated[float, _number("s", 0.0, MAX_START_TIME)]
StandTime = Annotated[float, _number("s", 0.0, MAX_SIM_TIME)]
Acceleration = Annotated[float, _number("m/s²", *ACCELERATIONS)]
SimTime = Annotated[float, _number("s", 1.0, MAX_SIM_TIME)]
SimulationTime = Annotated[float, _number("s", 0.0, MAX_SIM_TIME)]
StepLength = Annotated[float, _number("s", 0.01, 0.2)]
Extent = Annotated[float, _number("m", 0.05, 50.0)]
PatchExtent = Annotated[float, _number("m", 0.5, 200.0)]
PatchFriction = Annotated[float, _number("1", 0.02, 1.0)]
Percentage = Annotated[float, _number("%", 0.0, 100.0)]
SunAzimuth = Annotated[float, _number("deg", -360.0, 360.0)]
SunAltitude = Annotated[float, _number("deg", -90.0, 90.0)]
FogDistance = Annotated[float, _number("m", 0.0, 1e5)]
FogFalloff = Annotated[float, _number("1", 0.0, 1e3)]
StageTime = Annotated[float, _number("s", 0.5, 3600.0)]
LightOffset = Annotated[float, _number("s", -3600.0, 3600.0)]
Density = Annotated[float, _number("1/km", 0.0, 200.0)]
VehicleCount = Annotated[int, _integer("1", 0, MAX_BACKGROUND_VEHICLES)]
Seed = Annotated[int, _integer("1", 0, MAX_SEED)]

NAME_PATTERN = r"^[A-Za-z0-9_.-]{1,64}$"
ID_PATTERN = r"^[A-Za-z0-9_.:-]{1,64}$"
TOWN_PATTERN = r"^[A-Za-z0-9_-]{1,64}$"
CONFIG_PATTERN = r"^(configs/)?[A-Za-z0-9_-]{1,64}(\.yaml|\.yml|\.json)?$"
PATTERN_MEANINGS: Mapping[str, str] = MappingProxyType(
    {
        NAME_PATTERN: "1 to 64 of A-Z a-z 0-9 _ . -",
        ID_PATTERN: "1 to 64 of A-Z a-z 0-9 _ . : -",
        TOWN_PATTERN: "1 to 64 of A-Z a-z 0-9 _ -",
        CONFIG_PATTERN: "the name of an agent: NAME, NAME.yaml or configs/NAME.yaml",
    }
)
"""Meanings of the patterns, for messages."""

ActorId = Annotated[str, Field(strict=True, pattern=ID_PATTERN)]
ModelName = Annotated[str, Field(strict=True, pattern=NAME_PATTERN)]
TownName = Annotated[str, Field(strict=True, pattern=TOWN_PATTERN)]
AgentName = Annotated[str, Field(strict=True, pattern=NAME_PATTERN)]
ConfigPath = Annotated[str, Field(strict=True, pattern=CONFIG_PATTERN)]
TrafficLightId = Annotated[str, Field(strict=True, min_length=1, max_length=256)]
ExtensionKey = Annotated[
    str,
    Field(
        strict=True,
        max_length=128,
        pattern=r"^([a-z0-9_-]+:[A-Za-z0-9_.-]+|[a-z0-9-]+(\.[A-Za-z0-9_-]+)+)$",
    ),
]
