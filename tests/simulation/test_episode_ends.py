"""How an ego's part ends, and what that means for the others."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import AgentContext, Observation, PoseControl
from drivora_service.errors import AgentError
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, EgoCol, Light, TerminalEvent
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.oracles.blocked import Blocked
from drivora_service.oracles.destination import Destination
from drivora_service.oracles.route_deviation import RouteDeviation
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.model import AgentChoice, EgoVehicle, LightTimes, TrafficLights
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.planning import plan_episode
from tests.simulation.episodes import (
    ROAD,
    Blind,
    car,
    closest,
    contacts,
    ego,
    network,
    obstacle,
    place,
    presence,
    run,
    scenario,
    speeds,
    standing,
    start,
    track,
    walker,
)


@pytest.mark.parametrize("agent", ["idm", "sumo-krauss"])
def test_an_ego_that_arrives_leaves_the_road(agent: str) -> None:
    there = place(ROAD, 60)
    what = scenario(
        ego(place(ROAD, 10), there, agent=agent),
        ego(place("-north_2_0", 10), place("-north_2_0", 130), name="other"),
        seconds=16.0,
    )
    trace = run(what)
    assert trace.ego_ends[0] is TerminalEvent.ARRIVED
    step = trace.ego_end_steps[0]
    assert step < trace.step_count - 20
    assert presence(trace, "ego")[: step + 1].all()
    assert not presence(trace, "ego")[step + 2 :].any()
    assert np.hypot(*(track(trace, "ego")[step] - (there.x, there.y))) < 10.0


def test_an_arrived_ego_does_not_block_the_way() -> None:
    what = scenario(
        ego(place(ROAD, 30), place(ROAD, 60), name="first"),
        ego(place(ROAD, 10), place(ROAD, 120), name="second"),
        seconds=30.0,
    )
    assert run(what).ego_ends == (TerminalEvent.ARRIVED, TerminalEvent.ARRIVED)


def test_hitting_an_npc_ends_the_part_and_the_wreck_stays() -> None:
    what = scenario(
        ego(place(ROAD, 30), place(ROAD, 120)),
        npc_vehicles=(
            car(place(ROAD, 70), name="parked"),
            car(place(ROAD, 5, speed=8.0), place(ROAD, 120, speed=8.0), name="behind"),
        ),
        seconds=12.0,
    )
    # The part of the only ego is over, so is the run.
    alone = run(what, Blind())
    assert alone.ego_ends == (TerminalEvent.COLLISION,)
    assert alone.ego_end_steps[0] == alone.step_count - 1 == alone.contacts[0].step
    assert contacts(alone) == [("ego", "parked")]
    witness = ego(place("-north_2_0", 10), place("-north_2_0", 130), name="witness")
    what = scenario(*what.ego_vehicles, witness, npc_vehicles=what.npc_vehicles, seconds=12.0)
    trace = run(what, Blind(), standing())
    crash = trace.ego_end_steps[0]
    assert trace.ego_ends == (TerminalEvent.COLLISION, TerminalEvent.TIME_LIMIT)
    assert presence(trace, "ego").all()
    assert np.all(speeds(trace, "ego")[crash + 1 :] == 0.0)
    assert np.ptp(track(trace, "ego")[crash + 1 :], axis=0).max() == 0.0
    assert closest(trace, "behind", "ego") > 5.0
    assert speeds(trace, "behind")[-1] < 0.1


def test_two_egos_that_meet_have_both_collided() -> None:
    what = scenario(
        ego(place(ROAD, 20), place(ROAD, 120), name="hits"),
        ego(place(ROAD, 60), place(ROAD, 120), name="stands"),
        ego(place("-north_2_0", 10), place("-north_2_0", 130), name="far"),
        seconds=8.0,
    )
    trace = run(what, Blind(), standing(), standing())
    assert set(contacts(trace)) == {("hits", "stands"), ("stands", "hits")}
    assert trace.ego_ends == (
        TerminalEvent.COLLISION, TerminalEvent.COLLISION, TerminalEvent.TIME_LIMIT,
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["obstacle", "walker", "obstacle late", "walker late"])
def test_hitting_what_stands_in_the_way_ends_the_part(kind: str) -> None:
    begin = 3.0 if "late" in kind else 0.0
    more = (
        {"npc_obstacles": (obstacle(place(ROAD, 60), start_time=begin),)}
        if "obstacle" in kind
        else {"npc_walkers": (walker(place(ROAD, 60), start_time=begin),)}
    )
    trace = run(scenario(ego(place(ROAD, 20), place(ROAD, 120)), **more), Blind())
    assert trace.ego_ends == (TerminalEvent.COLLISION,)
    assert [other for _, other in contacts(trace)] in (["box"], ["walker"])


def test_an_ego_that_stands_for_a_minute_is_stuck() -> None:
    what = scenario(
        ego(place(ROAD, 20), place(ROAD, 120), start_time=1.0),
        ego(place("-north_2_0", 10), place("harbour_0_0", 130), name="other", start_time=20.0),
        seconds=100.0,
    )
    trace = run(what, standing(), standing())
    assert trace.ego_ends == (TerminalEvent.STUCK, TerminalEvent.STUCK)
    assert trace.times[trace.ego_end_steps[0]] == pytest.approx(61.0, abs=0.11)
    assert trace.times[trace.ego_end_steps[1]] == pytest.approx(80.0, abs=0.11)


def test_a_scenario_may_let_an_ego_stand_for_longer() -> None:
    what = scenario(ego(place(ROAD, 20), place(ROAD, 120)), seconds=120.0, stuck_after=90.0)
    # The time limit of so short a route would end it before.
    plan = plan_episode(what, network())
    plan = replace(plan, egos=tuple(replace(one, time_limit=120.0) for one in plan.egos))
    episode = Episode(plan, [standing()])
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.ego_ends == (TerminalEvent.STUCK,)
    assert trace.times[trace.ego_end_steps[0]] == pytest.approx(90.0, abs=0.11)
    outcomes = [
        Blocked(duration=duration).judge(RunView(trace, network()))[0].outcome
        for duration in (60.0, 90.0, 95.0)
    ]
    assert outcomes == [Outcome.VIOLATED, Outcome.VIOLATED, Outcome.NOT_MEASURABLE]


class Straight:
    """Drives straight on from where it started, whatever its route does."""

    def setup_env(self, context: AgentContext) -> None:
        self.step = 8.0 * context.step_length

    def run_step(self, observation: Observation) -> PoseControl:
        x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
        return PoseControl(x + self.step * math.cos(yaw), y + self.step * math.sin(yaw), yaw, 8.0)


def test_an_ego_that_leaves_its_route_ends_and_the_others_go_on() -> None:
    what = scenario(
        ego(
            place("-bridge_3_2", 40, on="signal-grid"),
            place("queen_3_1", 60, on="signal-grid"),
            name="leaves",
        ),
        ego(
            place("-bridge_1_1", 10, on="signal-grid"),
            place("-bridge_1_1", 80, on="signal-grid"),
            name="stays",
        ),
        on="signal-grid",
        seconds=30.0,
    )
    trace = run(what, Straight(), standing())
    assert trace.ego_ends == (TerminalEvent.ROUTE_DEVIATION, TerminalEvent.TIME_LIMIT)
    last = trace.ego_end_steps[0]
    away = np.abs(trace.ego_values[: last + 1, 0, EgoCol.ROUTE_LATERAL])
    assert away[:-1].max() <= 30.0 < away[-1]
    assert np.ptp(track(trace, "leaves")[last:], axis=0).max() == 0.0
    view = RunView(trace, network("signal-grid"))
    deviation = RouteDeviation().judge(view)[0]
    assert (deviation.outcome, deviation.step) == (Outcome.VIOLATED, last)
    assert Destination().judge(view)[0].evidence["reason"] == "route_deviation"


def test_an_ego_that_drives_long_beside_its_route_has_left_it() -> None:
    what = scenario(
        ego(place(ROAD, 20), place(ROAD, 120)),
        ego(place("-north_2_0", 10), place("-north_2_0", 130), name="other"),
        seconds=20.0,
    )
    plan = plan_episode(what, network())
    first = plan.egos[0]
    beside = first.route.line + 20.0 * np.array(
        [math.sin(first.start[2]), -math.cos(first.start[2])]
    )
    plan = replace(
        plan, egos=(replace(first, route=replace(first.route, line=beside)), plan.egos[1])
    )
    episode = Episode(plan, [Straight(), standing()])
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.ego_ends[0] is TerminalEvent.ROUTE_DEVIATION
    away = np.abs(trace.ego_values[: trace.ego_end_steps[0] + 1, 0, EgoCol.ROUTE_LATERAL])
    assert away.max() < 30.0
    view = RunView(trace, network())
    beside_it = view.egos[0].moved[away > 15.0].sum()
    assert beside_it == pytest.approx(0.3 * first.route.length, abs=0.5)
    deviation = RouteDeviation().judge(view)[0]
    assert (deviation.outcome, deviation.step) == (Outcome.VIOLATED, trace.ego_end_steps[0])


def test_an_ego_that_waits_at_red_is_not_stuck() -> None:
    on = "signal-grid"
    dark = TrafficLights(times=LightTimes(green=80.0, yellow=3.0))
    egos = [
        ego(place(lane, 70, on=on), place(end, 60, on=on), place(last, 60, on=on), name=lane)
        for lane, end, last in (
            ("grand_1_1", "grand_2_1", "grand_4_1"),
            ("castle_1_1", "castle_2_1", "queen_4_1"),
        )
    ]
    trace = run(scenario(*egos, on=on, traffic_lights=dark, seconds=130.0))
    stood = [(speeds(trace, e.id) < 0.1) & (trace.times < 82.0) for e in egos]
    waits = int(np.argmax([s.sum() for s in stood]))
    assert stood[waits].sum() * 0.05 > 62.0
    assert trace.ego_lights[stood[waits], waits].max() == Light.RED
    assert TerminalEvent.STUCK not in trace.ego_ends


def test_the_time_of_a_route_and_of_the_run_are_limits() -> None:
    short = ego(place(ROAD, 20), place(ROAD, 30), name="short")
    long = ego(place("harbour_0_0", 20), place("harbour_0_0", 200), name="long")
    trace = run(scenario(short, long, seconds=20.0), standing(), standing())
    assert trace.ego_ends == (TerminalEvent.TIME_LIMIT, TerminalEvent.TIME_LIMIT)
    # 0.8 s a metre of route and 5 s to start.
    assert trace.times[trace.ego_end_steps[0]] == pytest.approx(13.0, abs=0.2)
    assert trace.times[-1] == 20.0
    assert trace.ego_end_steps[1] == trace.step_count - 1
    assert presence(trace, "short").all()


def test_without_a_limit_the_run_lasts_as_long_as_its_longest_route_may() -> None:
    what = scenario(ego(place(ROAD, 20), place(ROAD, 30)), seconds=None)
    trace = run(what, standing())
    assert trace.times[-1] == pytest.approx(13.0, abs=0.2)
    assert trace.max_sim_time == pytest.approx(13.0, abs=0.2)


SUMO_DRIVERS = ("sumo-krauss", "sumo-idm", "sumo-eidm", "sumo-acc", "sumo-cacc")


@pytest.mark.parametrize("agent", SUMO_DRIVERS)
def test_sumos_drivers_drive_an_ego_and_a_crashed_one_stays(agent: str) -> None:
    what = scenario(
        ego(place("harbour_0_0", 20), place(ROAD, 60), agent=agent, initial_speed=5.0),
        seconds=60.0,
    )
    assert run(what).ego_ends == (TerminalEvent.ARRIVED,)
    oncoming = car(
        place("harbour_0_0", 120, speed=8.0), place("harbour_0_0", 20, speed=8.0), behavior="replay"
    )
    witness = ego(place("-north_2_0", 10), place("-north_2_0", 130), name="witness")
    what = scenario(*what.ego_vehicles, witness, npc_vehicles=(oncoming,), seconds=15.0)
    driver = AgentCatalogue().create(agent, {})
    episode = start(what, driver, standing())  # type: ignore[arg-type]  # one of SUMO's drivers
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.ego_ends[0] is TerminalEvent.COLLISION
    assert np.all(speeds(trace, "ego")[trace.ego_end_steps[0] + 1 :] == 0.0)


def test_sumos_drivers_differ() -> None:
    ways = []
    ahead = car(place("harbour_0_0", 45, speed=6.0), place(ROAD, 60, speed=6.0))
    for agent in SUMO_DRIVERS:
        one = ego(place("harbour_0_0", 20), place(ROAD, 60), agent=agent)
        trace = run(scenario(one, npc_vehicles=(ahead,), seconds=8.0))
        ways.append(float(np.nansum(speeds(trace, "ego"))))
    assert len(set(ways)) == len(SUMO_DRIVERS)


def overtaker(lane_change_model: str, name: str = "ego") -> EgoVehicle:
    town = "highway"
    one = ego(
        place("eb_1_0", 20, on=town), place("eb_1_0", 300, on=town), name=name,
        initial_speed=20.0,
    )  # fmt: skip
    parameters = {"lane_change_model": lane_change_model}
    return replace(one, agent=AgentChoice(name="sumo-krauss", parameters=parameters))


def test_sl2015_moves_sideways_where_lc2013_jumps() -> None:
    town = "highway"
    slow = car(
        place("eb_1_0", 70, on=town, speed=6.0), place("eb_1_0", 300, on=town, speed=6.0),
        behavior="sumo",
    )  # fmt: skip
    steps, hashes = {}, []
    for model in ("LC2013", "SL2015", "LC2013"):
        what = scenario(overtaker(model), on=town, npc_vehicles=(slow,), seconds=20.0)
        trace = run(what)
        hashes.append(trace_sha256(trace))
        way = track(trace, "ego")
        aside = way[:, 1] - np.polyval(np.polyfit(way[:, 0], way[:, 1], 1), way[:, 0])
        steps[model] = float(np.abs(np.diff(aside)).max())
    assert steps["LC2013"] > 2.0
    assert 0.01 < steps["SL2015"] < 0.2
    # Sublanes end with the run that has them.
    assert hashes[0] == hashes[2] != hashes[1]


def test_one_run_has_one_lane_change_model() -> None:
    two = (overtaker("LC2013"), overtaker("SL2015", name="other"))
    with pytest.raises(AgentError, match="lane_change_model") as failure:
        run(scenario(*two, on="highway"))
    assert failure.value.cause == "agent_parameters"
