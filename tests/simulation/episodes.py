"""Scenarios on shipped networks, scripted agents and whole episodes, for tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import (
    AccelerationControl,
    Agent,
    AgentContext,
    Control,
    Observation,
    PoseControl,
)
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import (
    AgentChoice,
    EgoVehicle,
    MapRegion,
    NpcBehavior,
    NpcObstacle,
    NpcVehicle,
    NpcWalker,
    Scenario,
    Waypoint,
)
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode

ROAD = "harbour_1_0"
"""126 m of tee-town, nearly straight, 50 km/h."""
CAR = "vehicle.lincoln.mkz_2017"
WALKER = "walker.pedestrian.0001"


@lru_cache(maxsize=1)
def catalogue() -> NetworkCatalogue:
    return NetworkCatalogue(shipped_networks())


def network(name: str = "tee-town") -> RoadNetwork:
    """A shipped network."""
    return catalogue().get(name)


def place(
    lane: str, s: float, *, on: str = "tee-town", right: float = 0.0, speed: float | None = None
) -> Waypoint:
    """A waypoint ``s`` metres along a lane, ``right`` metres beside its centre."""
    x, y, yaw = network(on).lane(lane).position_at(s)
    return Waypoint(x=x + right * math.sin(yaw), y=y - right * math.cos(yaw), yaw=yaw, speed=speed)


def ego(*route: Waypoint, name: str = "ego", agent: str = "idm", **more: Any) -> EgoVehicle:
    return EgoVehicle(id=name, model=CAR, route=route, agent=AgentChoice(name=agent), **more)


def parked(name: str = "ego") -> EgoVehicle:
    """An ego far from the roads that tests use."""
    return ego(place("-north_2_0", 20), place("-north_2_0", 100), name=name)


def car(*route: Waypoint, name: str = "npc", behavior: str = "reactive", **more: Any) -> NpcVehicle:
    return NpcVehicle(id=name, model=CAR, route=route, behavior=NpcBehavior(behavior), **more)


def walker(*route: Waypoint, name: str = "walker", **more: Any) -> NpcWalker:
    return NpcWalker(id=name, model=WALKER, route=route, **more)


def obstacle(
    location: Waypoint, *, name: str = "box", model: str = "static.prop.container", **more: Any
) -> NpcObstacle:
    return NpcObstacle(id=name, model=model, location=location, **more)


def scenario(
    *egos: EgoVehicle, on: str = "tee-town", seconds: float | None = 10.0, **more: Any
) -> Scenario:
    more.setdefault("map_region", MapRegion(town=on))
    return Scenario(ego_vehicles=egos, max_sim_time=seconds, **more)


class Scripted:
    """An agent that answers what a function says of each observation."""

    def __init__(self, answer: Callable[[Observation], Control]) -> None:
        self.answer = answer

    def setup_env(self, context: AgentContext) -> None:
        self.context = context

    def run_step(self, observation: Observation) -> Control:
        return self.answer(observation)


def accelerating(acceleration: float) -> Scripted:
    """Pulls or brakes straight on, without looking."""
    return Scripted(lambda observation: AccelerationControl(acceleration, 0.0))


def standing() -> Scripted:
    return accelerating(-8.0)


class Blind:
    """Drives along its route at a constant speed, whatever is in its way."""

    def __init__(self, speed: float = 8.0) -> None:
        self.speed = speed

    def setup_env(self, context: AgentContext) -> None:
        self.context = context

    def run_step(self, observation: Observation) -> PoseControl:
        route = self.context.route
        step = self.context.step_length * self.speed
        s = observation.route_s + step
        x, y = (float(np.interp(s, route.arc, route.line[:, k])) for k in (0, 1))
        back, ahead = route.line[
            np.searchsorted(route.arc, [s - 0.5, s + 0.5]).clip(0, len(route.arc) - 1)
        ]
        return PoseControl(x, y, math.atan2(ahead[1] - back[1], ahead[0] - back[0]), self.speed)


class Watching:
    """Stands still and keeps a copy of what it perceived."""

    def __init__(self) -> None:
        self.seen: list[NDArray[np.float64]] = []
        self.kinds: list[NDArray[np.int64]] = []

    def setup_env(self, context: AgentContext) -> None:
        self.context = context

    def run_step(self, observation: Observation) -> AccelerationControl:
        self.seen.append(observation.objects.copy())
        self.kinds.append(observation.object_kinds.copy())
        return AccelerationControl(-8.0, 0.0)


def start(what: Scenario, *agents: Agent, mirrored: bool = False, holding: bool = False) -> Episode:
    """Makes an episode; egos without an agent here get the one that they name."""
    plan = plan_episode(what, network(what.map_region.town))
    named = [e.agent for e in what.ego_vehicles[len(agents) :]]
    catalogue = AgentCatalogue()
    team: list[Agent | SumoDriver] = [
        *agents,
        *(catalogue.create(choice.name, choice.parameters) for choice in named),
    ]
    return Episode(plan, team, mirrored=mirrored, holding=holding)


def run(what: Scenario, *agents: Agent) -> Trace:
    """Runs an episode to its end."""
    episode = start(what, *agents)
    while not episode.done:
        episode.step()
    return episode.finish()


def row_of(trace: Trace, actor: str) -> int:
    return next(a.row for a in trace.actors if a.id == actor)


def presence(trace: Trace, actor: str) -> NDArray[np.bool_]:
    return trace.present[:, row_of(trace, actor)]


def speeds(trace: Trace, actor: str) -> NDArray[np.float64]:
    """(T,) m/s; NaN where absent."""
    return trace.speeds(row_of(trace, actor))


def track(trace: Trace, actor: str) -> NDArray[np.float64]:
    """(T, 2) metres; NaN where absent."""
    return trace.states[:, row_of(trace, actor), [Col.X, Col.Y]]


def travelled(trace: Trace, actor: str) -> float:
    """Metres driven."""
    points = track(trace, actor)
    points = points[~np.isnan(points[:, 0])]
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def closest(trace: Trace, one: str, other: str) -> float:
    """The least distance of two centres, metres."""
    return float(np.nanmin(np.hypot(*(track(trace, one) - track(trace, other)).T)))


def contacts(trace: Trace) -> Sequence[tuple[str, str]]:
    """(ego, other) of every contact, by id."""
    return [(trace.actors[c.ego].id, trace.actors[c.other].id) for c in trace.contacts]
