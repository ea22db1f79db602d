"""The interface of an ADS: ``setup_env`` once, ``run_step`` every step.

Frame: the network's plane, x east and y north in metres; angles in radians counter-clockwise from
east; positions are box centres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple, Protocol

from drivora_service.agents.log import AgentLog
from drivora_service.agents.raster.raster_settings import Raster, RasterSettings
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.observations.trace import Light
from drivora_service.scenario.models.actor_models import ActorModel


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentContext:
    """The context of a run for an agent, before the first step.

    Attributes:
        ego_id: The vehicle it will drive.
        model: Size and limits of that vehicle.
        network: The road network; read-only.
        route: The route; read-only.
        step_length: Seconds between two calls of ``run_step``.
        friction: Tyre-road friction coefficient of the run, 0..1.
        seed: Seed for all random draws of the agent.
        parameters: Parameters from the document, checked by the agent's catalogue entry.
        log: Log of the agent.
    """

    ego_id: str
    model: ActorModel
    network: RoadNetwork
    route: LaneRoute
    step_length: float
    friction: float
    seed: int
    parameters: Mapping[str, Any]
    log: AgentLog

    def raster(self, settings: RasterSettings | None = None) -> Raster:
        """Returns what draws bird's-eye images of this run; call it in ``setup_env``.

        Args:
            settings: Size, scale and channels; by default all channels on 128 x 128 pixels of
                0.5 m.
        """
        # Imported here: most agents need no images, and ADSs in other processes import this module.
        from drivora_service.agents.raster.birds_eye import BirdsEyeRaster

        return BirdsEyeRaster(self, settings or RasterSettings())


class ObjectKind(IntEnum):
    """The kind of a perceived actor."""

    VEHICLE = 0
    WALKER = 1
    OBSTACLE = 2


@dataclass(slots=True, kw_only=True, eq=False)
class Observation:
    """The agent's observation of one step.

    The arrays belong to the agent: changing them affects neither the run nor its record. Those of
    objects are reused for the next step; ``ego`` is not.

    Attributes:
        time: Simulation time, seconds.
        step: Row of the trace.
        ego: (9,) state of the ego, columns ``observations.trace.Col``.
        speed: Signed longitudinal speed of the ego, m/s.
        acceleration: Longitudinal, m/s².
        steer: Front-wheel angle, radians.
        route_s: Distance along the route's reference line, metres.
        route_lateral: Distance from that line, metres, positive to the left.
        objects: (n, 9) perceived actors, columns ``Col``.
        object_sizes: (n, 2) length and width, metres.
        object_kinds: (n,) ``ObjectKind``: 0 vehicle, 1 walker, 2 obstacle.
        object_ids: (n,) a constant number of the actor in the run.
        light: State of the next signal on the route.
        light_protected: Whether a green light gives the right of way over all others ("G" in SUMO);
            with a permissive one, conflicting traffic with priority goes first.
        light_distance: Metres from the front bumper to its stop line; inf if there is none.
        speed_limit: m/s on the current lane.
    """

    time: float = 0.0
    step: int = 0
    ego: FloatArray
    speed: float = 0.0
    acceleration: float = 0.0
    steer: float = 0.0
    route_s: float = 0.0
    route_lateral: float = 0.0
    objects: FloatArray
    object_sizes: FloatArray
    object_kinds: IntArray
    object_ids: IntArray
    light: Light = Light.NONE
    light_protected: bool = False
    light_distance: float = float("inf")
    speed_limit: float = 0.0


class PedalControl(NamedTuple):
    """Pedals and wheel as in CARLA: throttle and brake 0..1, steer -1 (right) .. 1 (left).

    Unlike CARLA's, steer is positive to the left, like all angles here.
    """

    throttle: float
    brake: float
    steer: float


class AccelerationControl(NamedTuple):
    """Longitudinal acceleration in m/s² and front-wheel angle in radians, positive to the left."""

    acceleration: float
    steer: float


class PoseControl(NamedTuple):
    """A pose for the end of this step; reached as far as the vehicle's limits allow.

    Attributes:
        speed: m/s there; ``None``: from the displacement.
    """

    x: float
    y: float
    yaw: float
    speed: float | None = None


class TrajectoryCol(IntEnum):
    """Columns of a trajectory's points."""

    TIME = 0
    """Seconds from now, ascending."""
    X = 1
    Y = 2
    SPEED = 3


class TrajectoryControl(NamedTuple):
    """A trajectory to track.

    Attributes:
        points: (n, 4) time from now (s), x, y (m), speed (m/s), columns ``TrajectoryCol``; times
            ascend. The heading is that of the way; if all places coincide, it is kept.
    """

    points: FloatArray


Control = PedalControl | AccelerationControl | PoseControl | TrajectoryControl


class Agent(Protocol):
    """An ADS under test."""

    def setup_env(self, context: AgentContext) -> None:
        """Sets up a run; called once, before the first step."""
        ...

    def run_step(self, observation: Observation) -> Control:
        """Returns the control until the next step."""
        ...
