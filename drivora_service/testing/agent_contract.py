"""The contract of agents, as a suite of tests for authors of agents.

Derive a test class from ``AgentContract`` in a test module and make the agent::

    class TestMyAgent(AgentContract):
        def make_agent(self) -> Agent:
            return MyAgent()

The agent drives on the shipped network ``tee-town``, in the same process.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.interface import (
    AccelerationControl,
    Agent,
    AgentContext,
    Control,
    Observation,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.agents.log import AgentLog
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Col, Light, TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import (
    AgentChoice,
    EgoVehicle,
    MapRegion,
    NpcVehicle,
    Scenario,
    Waypoint,
)
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from drivora_service.worker.integrity import Snapshot

_TOWN = "tee-town"
_MODEL = "vehicle.lincoln.mkz_2017"
_START, _TURN, _END = ("harbour_0_0", 120.0), ("harbour_1_0", 60.0), ("ferry_1_0", 60.0)


class AgentContract(ABC):
    """The tests; each creates its own agents."""

    seconds: float = 120.0
    """Simulated time in which the agent must drive 290 m through a small town."""

    @abstractmethod
    def make_agent(self) -> Agent:
        """Returns a fresh agent."""

    def test_it_drives_its_route_to_the_end(self) -> None:
        trace = _drive(self.make_agent(), _scenario(self.seconds))
        assert trace.ego_ends == (TerminalEvent.ARRIVED,)

    def test_it_changes_nothing_of_the_code_that_simulates_and_judges(self) -> None:
        code = Snapshot()
        _drive(self.make_agent(), _scenario(10.0))
        assert code.changes() == ()

    def test_it_answers_finite_controls_with_nobody_around(self) -> None:
        agent = self.make_agent()
        agent.setup_env(_context())
        for speed in (0.0, 3.0, 10.0):
            for light in Light:
                assert _is_finite(agent.run_step(_observation(speed=speed, light=light)))

    def test_it_answers_finite_controls_in_a_crowd(self) -> None:
        agent = self.make_agent()
        agent.setup_env(_context())
        rng = np.random.default_rng(0)
        for step in range(50):
            assert _is_finite(agent.run_step(_observation(crowd=_crowd(rng), step=step)))

    def test_it_leaves_what_it_observes_as_it_was(self) -> None:
        agent = self.make_agent()
        agent.setup_env(_context())
        observation = _observation(crowd=_crowd(np.random.default_rng(1)))
        arrays = _arrays(observation)
        copies = [array.copy() for array in arrays]
        for array in arrays:
            array.flags.writeable = False
        agent.run_step(observation)
        for array, copy in zip(arrays, copies, strict=True):
            assert np.array_equal(array, copy)

    def test_it_drives_alike_with_the_same_seed(self) -> None:
        what = _scenario(20.0)
        assert trace_sha256(_drive(self.make_agent(), what)) == trace_sha256(
            _drive(self.make_agent(), what)
        )

    def test_it_drives_again_after_a_new_setup(self) -> None:
        agent, what = self.make_agent(), _scenario(20.0)
        first = _drive(agent, what)
        assert trace_sha256(_drive(agent, what)) == trace_sha256(first)

    def test_it_logs_the_columns_that_it_declares(self) -> None:
        agent, context = self.make_agent(), _context()
        agent.setup_env(context)
        names, row = context.log.names, context.log.row
        assert len(set(names)) == len(names) == len(row)
        agent.run_step(_observation())
        assert context.log.row is row
        assert context.log.names == names
        assert not np.isnan(row).any()


@lru_cache(maxsize=1)
def _network() -> RoadNetwork:
    return NetworkCatalogue(shipped_networks()).get(_TOWN)


def _point(place: tuple[str, float]) -> Waypoint:
    x, y, yaw = _network().lane(place[0]).position_at(place[1])
    return Waypoint(x=x, y=y, yaw=yaw)


def _scenario(seconds: float) -> Scenario:
    return Scenario(
        ego_vehicles=(
            EgoVehicle(
                id="ego",
                model=_MODEL,
                route=(_point(_START), _point(_TURN), _point(_END)),
                agent=AgentChoice(name="under-test"),
            ),
        ),
        map_region=MapRegion(town=_TOWN),
        npc_vehicles=(
            NpcVehicle(
                id="oncoming",
                model=_MODEL,
                route=(_point(("-harbour_1_0", 20.0)), _point(("-harbour_0_0", 100.0))),
            ),
        ),
        max_sim_time=seconds,
    )


def _drive(agent: Agent, scenario: Scenario) -> Trace:
    episode = Episode(plan_episode(scenario, _network()), [agent])
    while not episode.done:
        episode.step()
    return episode.finish()


def _context() -> AgentContext:
    points = [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in map(_point, (_START, _TURN, _END))]
    return AgentContext(
        ego_id="ego",
        model=actor_model(ActorKind.VEHICLE, _MODEL),
        network=_network(),
        route=plan_route(_network(), points),
        step_length=0.05,
        friction=1.0,
        seed=5,
        parameters={},
        log=AgentLog(),
    )


def _observation(
    *,
    speed: float = 5.0,
    light: Light = Light.NONE,
    crowd: NDArray[np.float64] | None = None,
    step: int = 0,
) -> Observation:
    start = _point(_START)
    ego = np.zeros(len(Col))
    ego[: Col.VX] = (start.x, start.y, start.yaw or 0.0)
    ego[Col.VX] = speed * math.cos(start.yaw or 0.0)
    ego[Col.VY] = speed * math.sin(start.yaw or 0.0)
    objects = np.empty((0, len(Col))) if crowd is None else crowd
    count = len(objects)
    return Observation(
        time=0.05 * step,
        step=step,
        ego=ego,
        speed=speed,
        objects=objects,
        object_sizes=np.full((count, 2), (4.5, 1.8)),
        object_kinds=np.arange(count, dtype=np.int64) % 3,
        object_ids=np.arange(1, count + 1, dtype=np.int64),
        light=light,
        light_distance=math.inf if light is Light.NONE else 20.0,
        speed_limit=11.1,
    )


def _crowd(rng: np.random.Generator) -> NDArray[np.float64]:
    """Thirty actors around the start in arbitrary poses: overlapping, sideways, backwards."""
    start = _point(_START)
    crowd = np.zeros((30, len(Col)))
    crowd[:, Col.X] = start.x + rng.normal(0.0, 25.0, 30)
    crowd[:, Col.Y] = start.y + rng.normal(0.0, 25.0, 30)
    crowd[:, Col.YAW] = rng.uniform(-math.pi, math.pi, 30)
    crowd[:, Col.VX : Col.AX] = rng.normal(0.0, 6.0, (30, 2))
    return crowd


def _arrays(observation: Observation) -> tuple[NDArray[np.float64] | NDArray[np.int64], ...]:
    return (
        observation.ego,
        observation.objects,
        observation.object_sizes,
        observation.object_kinds,
        observation.object_ids,
    )


def _is_finite(control: Control) -> bool:
    if isinstance(control, PedalControl):
        return math.isfinite(control.throttle + control.brake + control.steer)
    if isinstance(control, AccelerationControl):
        return math.isfinite(control.acceleration + control.steer)
    if isinstance(control, PoseControl):
        return math.isfinite(control.x + control.y + control.yaw + (control.speed or 0.0))
    return isinstance(control, TrajectoryControl) and bool(np.isfinite(control.points).all())
