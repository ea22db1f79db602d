"""The entities of the OpenScenario document, as pydantic models.

Unknown keys are rejected everywhere. Angles are degrees only here; the document's ``frame``
names the plane of the coordinates.
"""

from __future__ import annotations

import json
import re
from itertools import pairwise
from typing import Annotated, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    JsonValue,
    StrictBool,
    model_validator,
)
from pydantic_core import PydanticCustomError

from drivora_service.scenario import fields
from drivora_service.scenario.model import NpcBehavior, RouteEnd, VehicleDynamics

MAX_FREE_DATA_BYTES = 262_144
"""Maximum serialised size of ``extensions``, and of the parameters of one agent, bytes."""


JOINS = (
    "Whether it is added to the running episode at start_time, behind all other actors, instead of "
    "being one of its actors from the beginning."
)


class EntityDocument(BaseModel):
    """Base of every part of a document: immutable, without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def _check_size(data: dict[str, JsonValue]) -> dict[str, JsonValue]:
    size = len(json.dumps(data))
    if size > MAX_FREE_DATA_BYTES:
        raise PydanticCustomError(
            "too_large",
            "found {size} bytes; at most {limit} are allowed",
            {"size": size, "limit": MAX_FREE_DATA_BYTES},
        )
    return data


FreeData = AfterValidator(_check_size)
"""Bounds the size of data that Drivora carries without interpreting it."""


class PlaceDocument(EntityDocument):
    """A place in the document's frame."""

    x: fields.Coordinate = Field(description="East.")
    y: fields.Coordinate = Field(description="North (frame sumo) or south (frame carla).")
    z: fields.Elevation | None = Field(
        None,
        description="Height. Moving actors follow the heights of the lanes; for objects that stand "
        "still, it selects the level of a bridge.",
    )
    yaw: fields.Yaw | None = Field(
        None,
        description="Heading: counter-clockwise from east (frame sumo), clockwise (frame carla). "
        "Without it, that of the path; for objects without a path, that of the nearest lane.",
    )


class WaypointDocument(PlaceDocument):
    """A waypoint of a vehicle."""

    speed: fields.VehicleSpeed | None = Field(
        None,
        description="Desired speed on the way to this place; for the first place, at the start. "
        "Without it the speed limit of the lane. No effect on egos.",
    )


class NpcWaypointDocument(WaypointDocument):
    """A waypoint of an NPC vehicle."""

    wait: fields.StandTime | None = Field(
        None,
        description="How long the vehicle stands at this place. Without it, it drives through.",
    )


class WalkerWaypointDocument(PlaceDocument):
    """A waypoint of a walker."""

    speed: fields.WalkerSpeed | None = Field(
        None, description="Walking speed on the way to this place. Without it 1.4 m/s."
    )


class LocationDocument(PlaceDocument):
    """The place of a static object."""


class AgentDocument(EntityDocument):
    """The ADS that drives an ego."""

    name: fields.AgentName = Field(description="A name of `drivora agents list`.")
    parameters: Annotated[dict[str, JsonValue], FreeData] = Field(
        default_factory=dict,
        description="Parameters of `drivora agents show NAME` that differ from their defaults.",
    )


def is_agent_name(name: str) -> bool:
    """Returns whether a text can be the name of an agent."""
    return re.fullmatch(fields.NAME_PATTERN.strip("^$"), name) is not None


class ReferencePoseDocument(EntityDocument):
    """The pose of an ego at a time, in a run that later runs are compared with."""

    time: fields.SimulationTime = Field(description="Simulation time.")
    x: fields.Coordinate = Field(description="East, of the box centre.")
    y: fields.Coordinate = Field(description="North (frame sumo) or south (frame carla).")
    z: fields.Elevation | None = Field(None, description="Height. Without it 0.")
    yaw: fields.Yaw = Field(
        description="Heading: counter-clockwise from east (frame sumo), clockwise (frame carla)."
    )
    speed: fields.VehicleSpeed = Field(description="Speed over ground.")


def _in_order_of_time(
    poses: tuple[ReferencePoseDocument, ...],
) -> tuple[ReferencePoseDocument, ...]:
    if len(poses) == 1:
        raise PydanticCustomError(
            "one_pose", "found one pose; a path has at least two, and no path is an empty list"
        )
    for index, (before, pose) in enumerate(pairwise(poses), start=1):
        if pose.time <= before.time:
            raise PydanticCustomError(
                "time_order",
                "found pose {index} at {time} s, after one at {before} s; times must ascend",
                {"index": index, "time": pose.time, "before": before.time},
            )
    return poses


class EgoDocument(EntityDocument):
    """A vehicle under the control of an ADS."""

    id: fields.ActorId = Field(description="Unique among all actors.")
    model: fields.ModelName = Field(description="A vehicle model.")
    route: Annotated[
        tuple[WaypointDocument, ...], Field(min_length=2, max_length=fields.MAX_WAYPOINTS)
    ] = Field(description="Start, destination, and the waypoints between them in order.")
    start_time: fields.StartTime = Field(
        0.0, description="The ego stands still at its start before this time."
    )
    initial_speed: fields.VehicleSpeed = Field(0.0, description="Speed at start_time.")
    dynamics: VehicleDynamics = Field(
        VehicleDynamics.KINEMATIC,
        description="Vehicle model: `kinematic` rolls without slip within the "
        "grip of its tyres, `dynamic` can skid.",
    )
    agent: AgentDocument | None = Field(
        None, description="The ADS that drives this vehicle. Without it and config_path: `idm`."
    )
    config_path: fields.ConfigPath | None = Field(
        None,
        description="Instead of `agent`: the name of an agent, with or without `configs/` in "
        "front and `.yaml`, `.yml` or `.json` behind. It is looked up in the catalogue and never "
        "opened.",
    )
    reference_path: Annotated[
        tuple[ReferencePoseDocument, ...],
        Field(max_length=fields.MAX_REFERENCE_POSES),
        AfterValidator(_in_order_of_time),
    ] = Field(
        (),
        description="The path of an ego in another scenario, in ascending time, at least two "
        "poses; between them it is interpolated. The run does not follow it; the oracle "
        "`non_optimal_decision` compares the ego's path with it.",
    )

    @model_validator(mode="after")
    def _one_agent(self) -> Self:
        if self.agent is not None and self.config_path is not None:
            raise PydanticCustomError(
                "two_agents", "found both agent and config_path; give one of the two"
            )
        return self

    @property
    def agent_name(self) -> str | None:
        """The agent's name in the catalogue; ``None`` if the document has none."""
        if self.agent is not None:
            return self.agent.name
        if self.config_path is None:
            return None
        return self.config_path.removeprefix("configs/").partition(".")[0]


class NpcVehicleDocument(EntityDocument):
    """A vehicle that follows waypoints."""

    id: fields.ActorId = Field(description="Unique among all actors.")
    model: fields.ModelName = Field(description="A vehicle model.")
    route: Annotated[
        tuple[NpcWaypointDocument, ...], Field(min_length=1, max_length=fields.MAX_WAYPOINTS)
    ] = Field(description="Waypoints in order; a single one is a parked vehicle.")
    start_time: fields.StartTime = Field(0.0, description="Absent before this time.")
    behavior: NpcBehavior = Field(
        NpcBehavior.REACTIVE,
        description="replay: follows its waypoints regardless of other actors; reactive: follows "
        "them and brakes for actors ahead; sumo: SUMO's car-following and lane-changing along "
        "the route.",
    )
    at_end: RouteEnd = Field(
        RouteEnd.LEAVE,
        description="leave: it leaves the road at its last waypoint; stay: it brakes to a "
        "standstill there, and stays.",
    )
    deceleration: fields.Acceleration | None = Field(
        None,
        description="Braking for its waypoints, bends and end, at most what its model and the "
        "grip of the road allow. Without it 40 % of its model's.",
    )
    lateral_acceleration: fields.Acceleration | None = Field(
        None,
        description="Lateral acceleration in bends and lane changes, at most what the grip of the "
        "road allows. Without it 60 % of the grip in bends, and lane changes of 4 s.",
    )
    joins: StrictBool = Field(False, description=JOINS)


class NpcWalkerDocument(EntityDocument):
    """A pedestrian."""

    id: fields.ActorId = Field(description="Unique among all actors.")
    model: fields.ModelName = Field(description="A walker model.")
    route: Annotated[
        tuple[WalkerWaypointDocument, ...], Field(min_length=1, max_length=fields.MAX_WAYPOINTS)
    ] = Field(description="Waypoints in order; with a single one, the walker stands still.")
    start_time: fields.StartTime = Field(0.0, description="Absent before this time.")
    joins: StrictBool = Field(False, description=JOINS)


class NpcObstacleDocument(EntityDocument):
    """A static object."""

    id: fields.ActorId = Field(description="Unique among all actors.")
    model: fields.ModelName = Field(
        description="An obstacle model; a vehicle model stands as a parked wreck."
    )
    location: LocationDocument = Field(description="Centre of its box.")
    length: fields.Extent | None = Field(
        None, description="Along its heading. Without it the model's."
    )
    width: fields.Extent | None = Field(
        None, description="Across its heading. Without it the model's."
    )
    start_time: fields.StartTime = Field(0.0, description="Absent before this time.")


class FrictionPatchDocument(EntityDocument):
    """A slippery rectangle of the road."""

    id: fields.ActorId = Field(description="Unique among all actors and patches.")
    location: LocationDocument = Field(
        description="Its centre; `yaw` is the direction of its length."
    )
    length: fields.PatchExtent = Field(description="Along its heading.")
    width: fields.PatchExtent = Field(description="Across its heading.")
    friction: fields.PatchFriction = Field(
        description="Friction coefficient on it; where the road itself has less, that counts."
    )


class RegionDocument(EntityDocument):
    """A rectangle; positions outside it are rejected."""

    min_x: fields.Coordinate = Field(description="Western edge.")
    max_x: fields.Coordinate = Field(description="Eastern edge.")
    min_y: fields.Coordinate = Field(description="Lower edge of y, in the document's frame.")
    max_y: fields.Coordinate = Field(description="Upper edge of y, in the document's frame.")

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        for low, high in (("min_x", "max_x"), ("min_y", "max_y")):
            if getattr(self, low) >= getattr(self, high):
                raise PydanticCustomError(
                    "empty_region",
                    "found {low} {found_low} and {high} {found_high}; {low} must be below {high}",
                    {
                        "low": low,
                        "high": high,
                        "found_low": getattr(self, low),
                        "found_high": getattr(self, high),
                    },
                )
        return self


class MapRegionDocument(EntityDocument):
    """The road network and region of the scenario."""

    town: fields.TownName = Field(description="A name of `drivora networks list`.")
    region_segment: RegionDocument | None = Field(
        None, description="The part of the town in which every position must lie."
    )


class WeatherDocument(EntityDocument):
    """CARLA's WeatherParameters."""

    cloudiness: fields.Percentage = Field(0.0, description="Clouds; without effect.")
    precipitation: fields.Percentage = Field(0.0, description="Rain that falls.")
    precipitation_deposits: fields.Percentage = Field(0.0, description="Water on the road.")
    wind_intensity: fields.Percentage = Field(0.0, description="Wind, pushes sideways.")
    sun_azimuth_angle: fields.SunAzimuth = Field(0.0, description="Direction of the sun.")
    sun_altitude_angle: fields.SunAltitude = Field(
        70.0, description="Height of the sun; below 0 it is night."
    )
    fog_density: fields.Percentage = Field(0.0, description="Thickness of the fog.")
    fog_distance: fields.FogDistance = Field(0.0, description="Where the fog begins.")
    wetness: fields.Percentage = Field(0.0, description="Wetness of the road.")
    fog_falloff: fields.FogFalloff = Field(
        0.0, description="Decrease of the fog with height; without effect in the plane."
    )


class WeatherChangeDocument(EntityDocument):
    """A change of the weather during the run."""

    time: fields.StartTime = Field(description="From this time on the weather is this one.")
    weather: WeatherDocument = Field(description="The whole weather from then on.")


class LightTimesDocument(EntityDocument):
    """Durations of the stages of a junction's programme."""

    green_time: fields.StageTime | None = Field(
        None, description="Green. Without it the network's."
    )
    red_time: fields.StageTime | None = Field(
        None,
        description="Red. Used where the junction has two stages; with more it follows from "
        "the others.",
    )
    yellow_time: fields.StageTime | None = Field(
        None, description="Yellow. Without it the network's."
    )
    offset: fields.LightOffset | None = Field(None, description="Delay of the programme.")


class TrafficLightsDocument(LightTimesDocument):
    """Times of all traffic lights, and those of single junctions."""

    junctions: Annotated[
        dict[fields.TrafficLightId, LightTimesDocument], Field(max_length=fields.MAX_JUNCTIONS)
    ] = Field(
        default_factory=dict,
        description="Times by traffic-light id of the network; omitted ones come from the times of "
        "all.",
    )


class BackgroundTrafficDocument(EntityDocument):
    """SUMO-driven traffic of constant size; exactly one of count and density."""

    count: fields.VehicleCount | None = Field(None, description="Vehicles on the road at once.")
    density: fields.Density | None = Field(
        None, description="Vehicles per kilometre of drivable lane, without junctions."
    )
    start_time: fields.StartTime = Field(0.0, description="None before this time.")

    @model_validator(mode="after")
    def _one_amount(self) -> Self:
        if (self.count is None) == (self.density is None):
            found = "neither" if self.count is None else "both"
            raise PydanticCustomError(
                "one_amount",
                "found {found} of count and density; give exactly one",
                {"found": found},
            )
        return self
