"""How the intelligent-driver agent behaves in traffic, on shipped networks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.observations.trace import EgoCol, Light, TerminalEvent, Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.off_road import OffRoad
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.speeding import Speeding
from drivora_service.oracles.wrong_way import WrongWay
from drivora_service.scenario.model import LightTimes, Scenario, TrafficLights, Waypoint, Weather
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.agents.driving import assert_keeps, assert_stops_at_red, passes, red_light_ahead
from tests.simulation.episodes import (
    ROAD,
    car,
    closest,
    ego,
    network,
    obstacle,
    place,
    presence,
    run,
    scenario,
    speeds,
    travelled,
    walker,
)

RULES = (Collision(), RedLight(), OffRoad(), WrongWay(), LaneKeeping(), Speeding())


def drive(what: Scenario) -> Trace:
    """Runs a scenario in which the agent must keep the rules."""
    trace = run(what)
    assert_keeps(trace, RULES)
    return trace


def rests(trace: Trace, actor: str = "ego") -> float:
    """Seconds stood after having moved."""
    speed = speeds(trace, actor)
    moved = int(np.argmax(speed > 1.0))
    return float((speed[moved:] < 0.1).sum() * trace.step_length)


def test_it_stops_at_red_before_the_line_and_goes_at_green() -> None:
    trace = drive(red_light_ahead())
    stands = assert_stops_at_red(trace)
    lights = trace.ego_lights[:, 0]
    last = int(np.flatnonzero(stands)[-1])
    green = last - int(np.argmax(lights[last::-1] == Light.RED))
    assert (last - green) * 0.05 < 2.0


@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_it_yields_on_the_minor_road(behavior: str) -> None:
    # From ferry_1 to the right into harbour_1: those on the harbour road have the right of way.
    junction = place("-harbour_1_0", 3)
    free = scenario(ego(place("-ferry_1_0", 70), place("-harbour_1_0", 60)), seconds=60.0)
    alone = passes(drive(free), "ego", junction)
    main = tuple(
        car(
            place("-harbour_2_0", 160 - 20 * i, speed=8.0),
            place("-harbour_1_0", 110, speed=8.0),
            name=f"main{i}",
            behavior=behavior,
            start_time=max(alone - 12.0, 0.0),
        )
        for i in range(4)
    )
    trace = drive(scenario(*free.ego_vehicles, npc_vehicles=main, seconds=60.0))
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert passes(trace, "ego", junction) > alone + 1.0
    # The others did not have to brake hard for it.
    for npc in main:
        braking = -np.nanmin(np.diff(speeds(trace, npc.id))) / trace.step_length
        assert braking < 3.5, npc.id


def test_a_permissive_left_turn_yields_to_oncoming_traffic() -> None:
    town, out = "tee-town", place("-ferry_1_0", 6)
    turn = scenario(
        ego(place("-high_4_0", 40), place("-high_4_0", 100), place("-ferry_1_0", 80)), on=town,
        traffic_lights=TrafficLights(times=LightTimes(green=60.0)), seconds=55.0,
    )  # fmt: skip
    alone = passes(drive(turn), "ego", out)
    oncoming = tuple(
        car(
            place("high_2_0", 50 - 15 * i, speed=8.0), place("high_4_0", 60, speed=8.0),
            name=f"on{i}", start_time=max(alone - 11.0, 0.0),
        )
        for i in range(3)
    )  # fmt: skip
    waits = scenario(
        *turn.ego_vehicles, npc_vehicles=oncoming, traffic_lights=turn.traffic_lights, seconds=55.0
    )
    trace = drive(waits)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert passes(trace, "ego", out) > alone + 1.0
    assert not trace.contacts


@pytest.mark.parametrize("right", [4.0, -4.0])
def test_it_lets_a_walker_cross(right: float) -> None:
    crossing = walker(
        place("harbour_1_0", 70, right=right),
        place("harbour_1_0", 70, right=-2.0 * right, speed=1.4),
        start_time=4.0,
    )
    what = scenario(
        ego(place("harbour_1_0", 15), place("harbour_1_0", 120)),
        npc_walkers=(crossing,), seconds=40.0,
    )  # fmt: skip
    trace = drive(what)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert not trace.contacts
    assert np.nanmin(speeds(trace, "ego")[80:-40]) < 5.0


def test_it_follows_a_slower_leader() -> None:
    leader = car(place("harbour_0_0", 60, speed=4.0), place("harbour_1_0", 100, speed=4.0))
    what = scenario(
        ego(place("harbour_0_0", 20), place("harbour_1_0", 60)), npc_vehicles=(leader,),
        seconds=90.0,
    )  # fmt: skip
    trace = drive(what)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    late = (trace.times > 30.0) & (trace.times < 48.0)
    assert np.nanmax(speeds(trace, "ego")[late & presence(trace, "ego")]) < 5.0
    assert closest(trace, "ego", "npc") > 5.5


def test_it_stops_behind_a_leader_that_brakes_hard() -> None:
    what = scenario(
        ego(place("harbour_0_0", 30), place("harbour_1_0", 60), initial_speed=9.0),
        npc_vehicles=(
            car(place("harbour_0_0", 50, speed=9.0), place("harbour_1_0", 100, speed=9.0)),
        ),
        npc_obstacles=(obstacle(place("harbour_0_0", 130), start_time=6.0),),
        seconds=25.0,
    )
    trace = drive(what)
    assert not trace.contacts
    assert speeds(trace, "ego")[-1] < 0.1


@pytest.mark.parametrize("weather", [Weather(), Weather(wetness=100, precipitation_deposits=100)])
def test_it_stops_behind_a_parked_car_in_any_weather(weather: Weather) -> None:
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 120)),
        npc_vehicles=(car(place("harbour_1_0", 80), behavior="replay"),), weather=weather,
        seconds=25.0,
    )  # fmt: skip
    trace = drive(what)
    assert not trace.contacts
    assert speeds(trace, "ego")[-1] < 0.1
    gap = closest(trace, "ego", "npc") - 4.9
    assert 0.5 < gap < 4.0


def test_it_passes_a_car_that_is_parked_beside_its_lane() -> None:
    what = scenario(
        ego(place("harbour_1_0", 10), place("harbour_1_0", 120)),
        npc_vehicles=(car(place("harbour_1_0", 70, right=3.2)),), seconds=30.0,
    )  # fmt: skip
    assert drive(what).ego_ends == (TerminalEvent.ARRIVED,)


@pytest.mark.parametrize(
    ("town", "route"),
    [
        ("arterial", (("eb_hill_0", 20.0), ("eb_farm_pocket_2", 60.0), ("school_n_0", 60.0))),
        ("arterial", (("eb_station_1", 20.0), ("eb_rose_pocket_0", 60.0), ("hill_s_0", 60.0))),
        ("highway", (("eb_1_2", 20.0), ("eb_a_decelerate_0", 200.0))),
    ],
)
def test_it_changes_lanes_where_its_route_needs_it(
    town: str, route: tuple[tuple[str, float], ...]
) -> None:
    points = [place(lane, s, on=town) for lane, s in route if lane in network(town).lane_by_id]
    trace = drive(scenario(ego(*points), on=town, seconds=120.0))
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    assert [e.message for e in trace.log_events if "changes to lane" in e.message]


def test_it_does_not_change_into_another_vehicle() -> None:
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
    trace = drive(what)
    assert not trace.contacts


def test_it_drives_more_slowly_when_told_so() -> None:
    fastest = []
    for factor in (1.0, 0.5):
        agent = IdmAgent(speed_factor=factor)
        what = scenario(ego(place("harbour_0_0", 20), place("harbour_0_0", 220)), seconds=40.0)
        fastest.append(float(np.nanmax(speeds(run(what, agent), "ego"))))
    assert fastest[1] < 0.6 * fastest[0]


def test_two_of_them_at_one_junction_both_get_through() -> None:
    egos = [
        ego(place(start, 40), place(end, 50), name=start)
        for start, end in (
            ("church_1_0", "-market_2_0"), ("market_2_0", "-church_1_0"),
            ("-market_3_0", "-market_2_0"),
        )
    ]  # fmt: skip
    trace = drive(scenario(*egos, seconds=60.0))
    assert set(trace.ego_ends) == {TerminalEvent.ARRIVED}


def test_it_does_not_skip_a_lap_of_a_route_that_passes_the_same_street_twice() -> None:
    """It changes lanes into a street that the route comes back to in the same lane."""
    town = "signal-grid"
    block = [
        place(lane, s, on=town)
        for lane, s in (("grand_3_1", 45), ("garden_2_1", 40), ("-queen_3_1", 45))
    ]
    end = float(network(town).lane("-bridge_2_1").arc[-1])
    what = scenario(
        ego(
            place("-bridge_2_1", 12, on=town),
            place("-bridge_2_2", end - 8.0, on=town),
            *block,
            place("-bridge_2_2", 0.5 * end + 0.37, on=town),
            place("grand_3_1", 30, on=town),
        ),
        on=town, seconds=None,
    )  # fmt: skip
    trace = drive(what)
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    steps = np.diff(trace.ego_values[:, 0, EgoCol.ROUTE_S])
    assert -0.5 < np.nanmin(steps) <= np.nanmax(steps) < 1.5
    assert trace.ego_routes[0].length > 500.0
    assert np.nansum(speeds(trace, "ego")) * 0.05 > 0.97 * trace.ego_routes[0].length


@pytest.mark.parametrize(
    "elsewhere", [place(ROAD, 52), place(ROAD, 25, right=15.0)], ids=["behind", "beside"]
)
def test_it_stops_behind_its_destination_and_beside_its_route(elsewhere: Waypoint) -> None:
    """It begins where it has not arrived, and drives on in the direction of its way."""
    what = scenario(ego(place(ROAD, 20), place(ROAD, 40), initial_speed=3.0), seconds=6.0)
    plan = plan_episode(what, network())
    (own,) = plan.egos
    moved = replace(own, start=(elsewhere.x, elsewhere.y, elsewhere.yaw or 0.0))
    episode = Episode(replace(plan, egos=(moved,)), [IdmAgent()])
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.ego_ends != (TerminalEvent.ARRIVED,)
    assert speeds(trace, "ego")[-1] < 0.1
    assert travelled(trace, "ego") < 5.0


class Rearranged(IdmAgent):
    """Gets arrays of another memory layout in two of three steps, as a wrapper may pass."""

    def __init__(self, every: int) -> None:
        super().__init__()
        self.every = every
        self.controls: list[AccelerationControl] = []

    def run_step(self, observation: Observation) -> AccelerationControl:
        if self.every and observation.step % self.every:
            observation.objects = np.asfortranarray(observation.objects)
            observation.ego = np.repeat(observation.ego, 2)[::2]
        control = super().run_step(observation)
        self.controls.append(control)
        return control


def test_it_decides_the_same_from_arrays_of_another_layout() -> None:
    what = scenario(
        ego(place(ROAD, 10), place(ROAD, 110)),
        npc_vehicles=(car(place(ROAD, 40, speed=3.0), place(ROAD, 100, speed=3.0)),),
        seconds=5.0,
    )
    usual, rearranged = Rearranged(0), Rearranged(3)
    run(what, usual)
    run(what, rearranged)
    assert len(usual.controls) == 100
    assert rearranged.controls == usual.controls
