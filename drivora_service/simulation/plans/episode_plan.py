"""The plan of an episode: routes, paths, programmes, sizes of its actors, without the agents.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.observations.ground import patch_array
from drivora_service.observations.trace import Role
from drivora_service.scenario.model import EgoVehicle, NpcObstacle, Scenario
from drivora_service.scenario.models.actor_models import ActorModel
from drivora_service.scenario.weather import WeatherEffects
from drivora_service.simulation.followers.follower_path import FollowerPath
from drivora_service.simulation.plans.light_programs import RunningProgram


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EgoPlan:
    """An ego and its route.

    Attributes:
        heights: (n,) heights along the route's reference line, metres.
        start: x, y, yaw of the box centre at the start.
        time_limit: Simulation time in seconds by which it must have arrived, without the time that
            it waits at signals.
    """

    ego: EgoVehicle
    model: ActorModel
    route: LaneRoute
    heights: FloatArray
    start: tuple[float, float, float]
    time_limit: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowerPlan:
    """An NPC vehicle or walker that follows a path.

    Attributes:
        edges: SUMO edges of its path, not empty; for a path off the road, the nearest edge.
        on_lanes: Whether its path keeps to those edges.
        first_speed: m/s at the start.
        stays: Whether it stays at the end of its path.
        is_fixed: Whether it has ended in SUMO's eyes from its start on, and needs to be checked in
            each step: a parked vehicle, a walker.
        deceleration: m/s² of its braking where its path plans it within the grip; 0: the path plans
            comfortably.
    """

    id: str
    role: Role
    model: ActorModel
    path: FollowerPath
    edges: tuple[str, ...]
    on_lanes: bool
    first_speed: float
    start_time: float
    reacts: bool
    stays: bool
    is_fixed: bool
    deceleration: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrivenPlan:
    """An NPC vehicle that SUMO drives.

    Attributes:
        position: Front bumper's position on the first lane at the start, in SUMO's metres.
        arrival: Front bumper's position on the last lane at the destination, in SUMO's metres.
    """

    id: str
    model: ActorModel
    edges: tuple[str, ...]
    lane_number: int
    position: float
    arrival: float
    speed: float
    start_time: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ObstaclePlan:
    """A static object and the SUMO edge nearest to it."""

    obstacle: NpcObstacle
    model: ActorModel
    pose: tuple[float, float, float]
    height: float
    length: float
    width: float
    edge: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchPlan:
    """A slippery rectangle of the road: centre, height and size in metres, heading in radians."""

    id: str
    x: float
    y: float
    z: float
    yaw: float
    length: float
    width: float
    friction: float

    def to_record(self) -> dict[str, str | float]:
        """Returns it as traces record it."""
        return asdict(self)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EpisodePlan:
    """The plan of an episode, without the agents.

    Attributes:
        patches: Slippery places of the road.
        max_sim_time: Seconds after which it ends.
        stuck_after: Seconds that an ego may stand before its part ends.
    """

    scenario: Scenario
    network: RoadNetwork
    weather: WeatherEffects
    programs: tuple[RunningProgram, ...]
    egos: tuple[EgoPlan, ...]
    followers: tuple[FollowerPlan, ...]
    driven: tuple[DrivenPlan, ...]
    obstacles: tuple[ObstaclePlan, ...]
    patches: tuple[PatchPlan, ...]
    max_sim_time: float
    stuck_after: float

    @property
    def patch_array(self) -> FloatArray:
        """(P, 8) ``patches``, columns ``ground.PatchCol``."""
        return patch_array([patch.to_record() for patch in self.patches])
