"""The scenario model: immutable, validated, in one frame.

Frame: the road network's plane, x east and y north in metres. Angles are radians, counter-clockwise
from east. Speeds are m/s and times are simulation seconds. Positions of vehicles, walkers and
obstacles are the centres of their boxes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from drivora_service.shapes import Shape


class NpcBehavior(StrEnum):
    """Behaviour of an NPC vehicle."""

    REPLAY = "replay"
    """Follows its waypoints regardless of other actors."""
    REACTIVE = "reactive"
    """Follows its waypoints and brakes for actors ahead."""
    SUMO = "sumo"
    """SUMO's car-following and lane-changing along the route through its waypoints."""


class RouteEnd(StrEnum):
    """What an NPC vehicle does at the end of its route."""

    LEAVE = "leave"
    """Leaves the road at its last waypoint, at the speed that it has there."""
    STAY = "stay"
    """Brakes to a standstill at its last waypoint, and stays there."""


class VehicleDynamics(StrEnum):
    """Vehicle model of an ego."""

    KINEMATIC = "kinematic"
    """A bicycle without slip, limited by the grip of its tyres."""
    DYNAMIC = "dynamic"
    """A bicycle with lateral velocity, yaw inertia and saturating tyres: it can skid."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """A waypoint of an actor.

    Attributes:
        x: Metres east.
        y: Metres north.
        z: Height in metres; for objects that stand still it selects the level of a bridge, moving
            actors follow the heights of their lanes.
        yaw: Heading in radians; ``None``: derived from the path.
        speed: Desired speed in m/s at this place; ``None``: the default of the actor's kind.
        wait: Seconds for which an NPC vehicle stands at this place; ``None``: it drives through.
    """

    x: float
    y: float
    z: float | None = None
    yaw: float | None = None
    speed: float | None = None
    wait: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentChoice(Shape):
    """The ADS that drives an ego: a name in the agent catalogue and its parameters."""

    name: str
    parameters: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferencePose:
    """The pose of an ego at a time of the run that later runs are compared with.

    Attributes:
        time: Simulation time, seconds.
        x: Metres east, of the box centre.
        y: Metres north.
        yaw: Heading, radians.
        speed: m/s over ground.
        z: Height, metres; ``None`` on flat networks.
    """

    time: float
    x: float
    y: float
    yaw: float
    speed: float
    z: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class EgoVehicle:
    """A vehicle under the control of an ADS.

    Attributes:
        route: At least two waypoints: start and destination; those between are passed in order.
        start_time: Seconds; before it the ego stands still at its start.
        initial_speed: m/s at ``start_time``.
        reference_path: What an ADS drove in another scenario, in ascending time; empty if its
            path is not compared. The simulation does not read it.
    """

    id: str
    model: str
    route: tuple[Waypoint, ...]
    agent: AgentChoice
    start_time: float = 0.0
    initial_speed: float = 0.0
    dynamics: VehicleDynamics = VehicleDynamics.KINEMATIC
    reference_path: tuple[ReferencePose, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class NpcVehicle:
    """A vehicle that follows waypoints; absent before ``start_time``.

    Attributes:
        deceleration: m/s² with which it plans to brake, at most those of its model and the grip of
            the road; ``None``: a comfortable share of its model's.
        lateral_acceleration: m/s² that it uses in bends and lane changes, at most the grip of the
            road; ``None``: a share of the grip in bends, and lane changes of a fixed time.
        joins: Whether it is added to the running episode at ``start_time``, behind all other
            actors, instead of being one of its actors from the beginning.
    """

    id: str
    model: str
    route: tuple[Waypoint, ...]
    start_time: float = 0.0
    behavior: NpcBehavior = NpcBehavior.REACTIVE
    at_end: RouteEnd = RouteEnd.LEAVE
    deceleration: float | None = None
    lateral_acceleration: float | None = None
    joins: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class NpcWalker:
    """A pedestrian; absent before ``start_time``, stays at the last waypoint.

    Attributes:
        joins: As for :class:`NpcVehicle`.
    """

    id: str
    model: str
    route: tuple[Waypoint, ...]
    start_time: float = 0.0
    joins: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class NpcObstacle:
    """A static object. ``length`` and ``width`` in metres; ``None``: the model's own size."""

    id: str
    model: str
    location: Waypoint
    length: float | None = None
    width: float | None = None
    start_time: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionPatch:
    """A slippery rectangle of the road: ice, a puddle, oil.

    Attributes:
        location: Its centre; ``yaw`` is the direction of its length, ``z`` selects the level of a
            bridge.
        length: Metres.
        width: Metres.
        friction: Tyre-road friction coefficient on it; where the road itself has less, that counts.
    """

    id: str
    location: Waypoint
    length: float
    width: float
    friction: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """An axis-parallel rectangle of the network's plane, in metres."""

    min_x: float
    max_x: float
    min_y: float
    max_y: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MapRegion:
    """The road network and, optionally, the part of it in which the scenario takes place."""

    town: str
    region_segment: Region | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Weather:
    """CARLA's ``WeatherParameters``: percentages 0..100, angles in degrees, distances in metres."""

    cloudiness: float = 0.0
    precipitation: float = 0.0
    precipitation_deposits: float = 0.0
    wind_intensity: float = 0.0
    sun_azimuth_angle: float = 0.0
    sun_altitude_angle: float = 70.0
    fog_density: float = 0.0
    fog_distance: float = 0.0
    wetness: float = 0.0
    fog_falloff: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class WeatherChange:
    """A change of the weather during the run.

    Attributes:
        time: Seconds from which on the weather is this one.
        weather: The whole weather from then on.
    """

    time: float
    weather: Weather


@dataclass(frozen=True, slots=True, kw_only=True)
class LightTimes:
    """Durations of the stages of a junction's programme in seconds; ``None`` keeps the network's.

    Attributes:
        red: Used where the junction has two stages; with more it follows from the others.
        offset: Seconds by which the programme is delayed.
    """

    green: float | None = None
    yellow: float | None = None
    red: float | None = None
    offset: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficLights:
    """Light times for all junctions, and those of single junctions by traffic-light id."""

    times: LightTimes = field(default_factory=LightTimes)
    junctions: Mapping[str, LightTimes] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class BackgroundTraffic:
    """SUMO-driven traffic of constant size: a vehicle that arrives is replaced.

    Attributes:
        count: Vehicles on the road at once.
        start_time: Start time of the traffic, seconds.
    """

    count: int
    start_time: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """A validated OpenScenario document.

    Attributes:
        weather_changes: Changes of the weather during the run, in the order of their times.
        seed: Seeds every random draw of the run.
        step_length: Simulated seconds of one step.
        max_sim_time: Seconds after which the episode ends; ``None``: derived from the ego routes.
        stuck_after: Seconds that an ego may stand, with no signal to wait for, before its part
            ends; ``None``: the default of the simulation.
        extensions: Free data of other tools, by namespace; carried, never interpreted.
    """

    ego_vehicles: tuple[EgoVehicle, ...]
    map_region: MapRegion
    npc_vehicles: tuple[NpcVehicle, ...] = ()
    npc_walkers: tuple[NpcWalker, ...] = ()
    npc_obstacles: tuple[NpcObstacle, ...] = ()
    friction_patches: tuple[FrictionPatch, ...] = ()
    weather: Weather = field(default_factory=Weather)
    weather_changes: tuple[WeatherChange, ...] = ()
    traffic_lights: TrafficLights = field(default_factory=TrafficLights)
    background_traffic: BackgroundTraffic | None = None
    seed: int = 0
    step_length: float = 0.05
    max_sim_time: float | None = None
    stuck_after: float | None = None
    extensions: Mapping[str, Any] = field(default_factory=dict)
