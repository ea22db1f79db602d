"""How the planner of CommonRoad drives, where it is installed."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent, Observation, PoseControl
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import Scenario
from drivora_service.testing.agent_contract import AgentContract
from tests.agents.driving import assert_stops_at_red, car_ahead, red_light_ahead
from tests.agents.installed_agents import fresh_agent, installed_agents
from tests.simulation.episodes import (
    ROAD,
    closest,
    contacts,
    ego,
    network,
    place,
    run,
    scenario,
    start,
)

NAME = "commonroad-rp"
RING = "roundabout"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def installed() -> Iterator[AgentCatalogue]:
    with installed_agents(NAME) as catalogue:
        yield catalogue


def drive(installed: AgentCatalogue, what: Scenario) -> Trace:
    return run(what, fresh_agent(installed, NAME))


def always_had_a_plan(trace: Trace) -> bool:
    """Says whether it never had to brake for want of a plan."""
    return bool(np.nanmax(trace.log_values[:, 0, 1]) == 0.0)


def test_it_goes_back_round_a_ring(installed: AgentCatalogue) -> None:
    """The heading of this way goes beyond a full turn, counted from the axis."""
    way = (("great_east_entry_1", 30.0), ("great_ring_4_1", 7.0), ("great_ring_8_1", 7.0))
    route = (*way, ("great_east_exit_1", 30.0))
    what = scenario(ego(*(place(*at, on=RING) for at in route)), on=RING, seconds=90.0)
    trace = drive(installed, what)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert always_had_a_plan(trace)


def test_it_stops_at_red_and_goes_on_at_green(installed: AgentCatalogue) -> None:
    trace = drive(installed, red_light_ahead())
    assert_stops_at_red(trace)
    assert always_had_a_plan(trace)


@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_it_does_not_touch_a_car_that_stands_or_is_slow(
    installed: AgentCatalogue, speed: float
) -> None:
    trace = drive(installed, car_ahead(speed))
    assert not contacts(trace)
    # It came up to it: centres of cars of 4.9 m.
    assert closest(trace, "ego", "npc") < 20.0


@pytest.mark.parametrize("speed", [0.0, 0.04])
def test_it_goes_on_when_braking_has_just_ended(installed: AgentCatalogue, speed: float) -> None:
    agent = fresh_agent(installed, NAME)
    start(scenario(ego(place(ROAD, 40.0), place(ROAD, 115.0))), agent)
    x, y, yaw = network().lane(ROAD).position_at(40.0)
    state = np.array([x, y, yaw, speed * math.cos(yaw), speed * math.sin(yaw), 0, 0, 0, 0])
    none = np.empty(0, dtype=np.int64)
    answer = agent.run_step(
        Observation(
            ego=state, speed=speed, acceleration=-6.0, objects=np.empty((0, 9)),
            object_sizes=np.empty((0, 2)), object_kinds=none, object_ids=none, speed_limit=13.9,
        )
    )  # fmt: skip
    assert isinstance(answer, PoseControl)
    assert answer.speed is not None
    assert answer.speed > speed


def test_it_drives_the_same_way_twice(installed: AgentCatalogue) -> None:
    what = scenario(ego(place("harbour_1_0", 40), place("ferry_1_0", 15)), seconds=60.0)
    first, second = (drive(installed, what) for _ in range(2))
    assert first.ego_ends == (TerminalEvent.ARRIVED,)
    assert trace_sha256(first) == trace_sha256(second)


class TestCommonRoadPlanner(AgentContract):
    @pytest.fixture(autouse=True)
    def _use(self, installed: AgentCatalogue) -> None:
        self.catalogue = installed

    def make_agent(self) -> Agent:
        return fresh_agent(self.catalogue, NAME)
