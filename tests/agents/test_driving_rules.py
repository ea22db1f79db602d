"""What every agent that is built here must do in traffic, on shipped networks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.off_road import OffRoad
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.speeding import Speeding
from drivora_service.oracles.wrong_way import WrongWay
from drivora_service.scenario.model import (
    AgentChoice,
    Scenario,
    Weather,
)
from tests.agents.driving import assert_keeps, assert_stops_at_red, passes, red_light_ahead
from tests.simulation.episodes import (
    car,
    closest,
    ego,
    network,
    obstacle,
    place,
    run,
    scenario,
    speeds,
    walker,
)

RULES = (Collision(), RedLight(), OffRoad(), WrongWay(), Speeding())

pytestmark = pytest.mark.parametrize("agent", ["idm-mobil", "pdm-closed"])


def drive(what: Scenario, agent: str) -> Trace:
    """Runs a scenario in which the agent must keep the rules."""
    egos = tuple(replace(one, agent=AgentChoice(name=agent)) for one in what.ego_vehicles)
    trace = run(replace(what, ego_vehicles=egos))
    assert_keeps(trace, RULES)
    return trace


def test_it_stops_at_red_and_goes_at_green(agent: str) -> None:
    trace = drive(red_light_ahead(), agent)
    assert_stops_at_red(trace)


def test_it_yields_on_the_minor_road(agent: str) -> None:
    junction = place("-harbour_1_0", 3)
    free = scenario(ego(place("-ferry_1_0", 70), place("-harbour_1_0", 60)), seconds=60.0)
    alone = passes(drive(free, agent), "ego", junction)
    main = tuple(
        car(
            place("-harbour_2_0", 160 - 20 * i, speed=8.0),
            place("-harbour_1_0", 110, speed=8.0),
            name=f"main{i}",
            start_time=max(alone - 12.0, 0.0),
        )
        for i in range(4)
    )
    trace = drive(scenario(*free.ego_vehicles, npc_vehicles=main, seconds=60.0), agent)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert passes(trace, "ego", junction) > alone + 1.0
    for npc in main:
        braking = -np.nanmin(np.diff(speeds(trace, npc.id))) / trace.step_length
        assert braking < 3.5, npc.id


@pytest.mark.parametrize("right", [4.0, -4.0])
def test_it_lets_a_walker_cross(agent: str, right: float) -> None:
    crossing = walker(
        place("harbour_1_0", 70, right=right),
        place("harbour_1_0", 70, right=-2.0 * right, speed=1.4),
        start_time=4.0,
    )
    what = scenario(
        ego(place("harbour_1_0", 15), place("harbour_1_0", 120)),
        npc_walkers=(crossing,), seconds=40.0,
    )  # fmt: skip
    trace = drive(what, agent)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert not trace.contacts


def test_it_stops_behind_a_leader_that_brakes_hard(agent: str) -> None:
    what = scenario(
        ego(place("harbour_0_0", 30), place("harbour_1_0", 60), initial_speed=9.0),
        npc_vehicles=(
            car(place("harbour_0_0", 50, speed=9.0), place("harbour_1_0", 100, speed=9.0)),
        ),
        npc_obstacles=(obstacle(place("harbour_0_0", 130), start_time=6.0),),
        seconds=25.0,
    )
    trace = drive(what, agent)
    assert not trace.contacts
    assert speeds(trace, "ego")[-1] < 0.1


@pytest.mark.parametrize("weather", [Weather(), Weather(wetness=100, precipitation_deposits=100)])
def test_it_stops_behind_what_blocks_its_lane_in_any_weather(agent: str, weather: Weather) -> None:
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 120)),
        npc_vehicles=(car(place("harbour_1_0", 80), behavior="replay"),), weather=weather,
        seconds=25.0,
    )  # fmt: skip
    trace = drive(what, agent)
    assert not trace.contacts
    assert speeds(trace, "ego")[-1] < 0.1
    assert 0.5 < closest(trace, "ego", "npc") - 4.9 < 5.0


@pytest.mark.parametrize(
    ("town", "route"),
    [
        ("arterial", (("eb_station_1", 20.0), ("eb_rose_pocket_0", 60.0), ("hill_s_0", 60.0))),
        ("highway", (("eb_1_2", 20.0), ("eb_a_decelerate_0", 200.0))),
    ],
)
def test_it_changes_lanes_where_its_route_needs_it(
    agent: str, town: str, route: tuple[tuple[str, float], ...]
) -> None:
    points = [place(lane, s, on=town) for lane, s in route if lane in network(town).lane_by_id]
    trace = drive(scenario(ego(*points), on=town, seconds=120.0), agent)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert [e.message for e in trace.log_events if "lane" in e.message]


def test_it_does_not_change_into_another_vehicle(agent: str) -> None:
    town = "highway"
    beside = car(
        place("eb_1_1", 20, on=town, speed=20.0),
        place("eb_a_decelerate_2", 200, on=town, speed=20.0),
    )
    what = scenario(
        ego(
            place("eb_1_2", 20, on=town), place("eb_a_decelerate_0", 220, on=town),
            initial_speed=20.0,
        ),
        on=town, npc_vehicles=(beside,), seconds=60.0,
    )  # fmt: skip
    assert not drive(what, agent).contacts
