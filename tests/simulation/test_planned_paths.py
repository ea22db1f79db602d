"""Planned paths of agents in traces."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.agents.interface import (
    AgentContext,
    Control,
    Observation,
    TrajectoryControl,
)
from drivora_service.agents.log import MOST_PLAN_POINTS, AgentLog
from drivora_service.observations.trace import Col, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import AgentChoice, EgoVehicle
from tests.simulation.episodes import CAR, ROAD, place, run, scenario


def drive(agent: str = "idm", **more: object) -> EgoVehicle:
    route = place(ROAD, 10), place(ROAD, 110)
    return EgoVehicle(
        id="ego", model=CAR, route=route, agent=AgentChoice(name=agent), initial_speed=6.0
    )


class Tracking:
    """Answers the next 3 s along its route as a trajectory."""

    def __init__(self) -> None:
        self.asked: dict[int, np.ndarray[tuple[int, int], np.dtype[np.float64]]] = {}

    def setup_env(self, context: AgentContext) -> None:
        self.route = context.route

    def run_step(self, observation: Observation) -> Control:
        times = np.arange(0.0, 3.0, 0.25)
        s = observation.route_s + 6.0 * times
        places = [np.interp(s, self.route.arc, self.route.line[:, axis]) for axis in (0, 1)]
        points = np.column_stack((times, *places, np.full(len(times), 6.0)))
        self.asked[observation.step] = points
        return TrajectoryControl(points)


def test_a_trajectory_is_the_planned_path() -> None:
    agent = Tracking()
    trace = run(scenario(drive(), seconds=2.0), agent)
    steps = [path.step for path in trace.plans]
    # One every 0.1 s, from the first step on.
    assert steps == list(range(0, trace.step_count - 1, 2))
    for path in trace.plans:
        np.testing.assert_allclose(path.points, agent.asked[path.step][:, 1:3], atol=1e-3)


def test_pdm_closed_tells_the_proposal_that_it_follows() -> None:
    trace = run(scenario(drive("pdm-closed"), seconds=6.0))
    assert len(trace.plans) > 50
    assert_followed(trace)


def assert_followed(trace: Trace) -> None:
    """Checks that plans begin at the ego, and that it comes near to where they lead."""
    apart = []
    for path in trace.plans:
        here = trace.states[path.step, 0, [Col.X, Col.Y]]
        assert np.hypot(*(path.points[0] - here)) < 1.0
        later = trace.states[path.step :, 0][:, [Col.X, Col.Y]]
        second = path.points[len(path.points) // 4]
        apart.append(np.min(np.hypot(*(later - second).T)))
    assert np.median(apart) < 0.5


def test_an_agent_without_a_plan_has_none_and_its_run_is_the_same_with_one() -> None:
    trace = run(scenario(drive(), seconds=3.0))
    assert trace.plans == ()

    class Telling(Tracking):
        def setup_env(self, context: AgentContext) -> None:
            super().setup_env(context)
            self.log = context.log

        def run_step(self, observation: Observation) -> Control:
            self.log.plan([(0.0, 0.0), (1.0, 1.0)])
            return super().run_step(observation)

    plain, telling = (
        run(scenario(drive(), seconds=2.0), agent) for agent in (Tracking(), Telling())
    )
    assert trace_sha256(plain) == trace_sha256(telling)
    # What the agent itself told counts, not its trajectory.
    assert {tuple(path.points.ravel().tolist()) for path in telling.plans} == {(0.0, 0.0, 1.0, 1.0)}


def test_long_paths_are_thinned_and_others_refused() -> None:
    log = AgentLog()
    line = np.column_stack((np.arange(1000.0), np.zeros(1000), np.ones(1000)))
    log.plan(line)
    ((step, path),) = log.plans
    assert (step, path.shape) == (0, (MOST_PLAN_POINTS, 2))
    assert path[[0, -1], 0].tolist() == [0.0, 999.0]
    line[0] = -1.0
    assert path[0, 0] == 0.0
    log.step = 1
    for wrong in ([1.0, 2.0], [(0.0,), (1.0,)]):
        with pytest.raises(ValueError, match="shape"):
            log.plan(wrong)
    log.plan([(1.0, 2.0)])
    log.plan([(0.0, 0.0), (1.0, np.nan), (2.0, 0.0)])
    assert len(log.plans) == 1
    log.plan([(0.0, 0.0), (1.0, 0.0), (np.inf, 0.0)])
    assert log.plans[-1][1].tolist() == [[0.0, 0.0], [1.0, 0.0]]
