"""SUMO's own state against the world's rows: what SUMO holds is what the trace records."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import libsumo
import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.observations.trace import Col, TerminalEvent, Trace
from drivora_service.scenario.model import BackgroundTraffic, RouteEnd, Scenario
from drivora_service.simulation.episode import Episode
from tests.simulation.episodes import (
    ROAD,
    car,
    ego,
    obstacle,
    place,
    row_of,
    scenario,
    speeds,
    standing,
    start,
    track,
    walker,
)

TOLERANCE = 0.5
"""Metres along the heading."""
HALF_LANE = 1.75
"""Metres across it: a vehicle that changes lanes on its route is in the middle of one in SUMO."""


@dataclass(slots=True)
class InSumo:
    """What libsumo said after each step: front bumpers by vehicle, metres."""

    frames: list[dict[str, tuple[float, float]]] = field(default_factory=list)

    def look(self) -> None:
        position = libsumo.vehicle.getPosition
        frame = {vehicle: position(vehicle) for vehicle in libsumo.vehicle.getIDList()}
        self.frames.append(frame)


def mirrored(what: Scenario, *agents: object) -> tuple[Trace, InSumo]:
    """Runs an episode and asks libsumo at every step."""
    named = [
        AgentCatalogue().create(one.agent.name, one.agent.parameters)
        for one in what.ego_vehicles[len(agents) :]
    ]
    episode: Episode = start(what, *agents, *named, mirrored=True)  # type: ignore[arg-type]  # of either kind
    seen = InSumo()
    seen.look()
    while not episode.done:
        episode.step()
        seen.look()
    return episode.finish(), seen


def front(trace: Trace, name: str, step: int) -> NDArray[np.float64]:
    """Where the trace has a front bumper."""
    actor = trace.actors[row_of(trace, name)]
    x, y, yaw = trace.states[step, actor.row, [Col.X, Col.Y, Col.YAW]]
    return np.array((x, y)) + 0.5 * actor.length * np.array((math.cos(yaw), math.sin(yaw)))


def check(trace: Trace, seen: InSumo, ids: Sequence[str] = ()) -> None:
    """Compares every step: who is there, and where."""
    chosen = set(ids) or {actor.id for actor in trace.actors}
    for step, frame in enumerate(seen.frames):
        expected = {a.id for a in trace.actors if trace.present[step, a.row]} & chosen
        assert expected == frame.keys() & chosen, f"step {step}"
        for name in expected:
            yaw = trace.states[step, row_of(trace, name), Col.YAW]
            dx, dy = front(trace, name, step) - frame[name]
            along = abs(dx * math.cos(yaw) + dy * math.sin(yaw))
            across = abs(-dx * math.sin(yaw) + dy * math.cos(yaw))
            assert along < TOLERANCE, f"{name} is {along:.2f} m off in SUMO at step {step}"
            assert across < HALF_LANE, f"{name} is {across:.2f} m beside in SUMO at step {step}"


WITNESS = ego(place("-north_2_0", 10), place("-north_2_0", 130), name="witness")


@pytest.mark.parametrize("agent", ["sumo-krauss", "sumo-idm", "idm"])
def test_an_ego_that_has_arrived_is_gone_in_sumo_too_and_traffic_flows_on(agent: str) -> None:
    what = scenario(
        ego(place(ROAD, 30), place(ROAD, 80), agent=agent),
        WITNESS,
        npc_vehicles=(
            car(
                place("harbour_0_0", 60, speed=8.0), place(ROAD, 120, speed=8.0),
                behavior="sumo", start_time=2.0,
            ),
        ),
        seconds=40.0,
    )  # fmt: skip
    driver = AgentCatalogue().create(agent, {})
    trace, seen = mirrored(what, driver, standing())
    assert trace.ego_ends[0] is TerminalEvent.ARRIVED
    assert trace.ego_end_steps[0] < trace.step_count - 400
    check(trace, seen)
    # It drives its whole route, past the start and the goal of the ego, without a stop.
    npc = trace.states[trace.present[:, row_of(trace, "npc")], row_of(trace, "npc")]
    goal = place(ROAD, 80)
    assert float(np.min(np.hypot(npc[:, 0] - goal.x, npc[:, 1] - goal.y))) < 3.0
    assert not trace.present[-1, row_of(trace, "npc")]
    assert float(np.hypot(npc[40:, Col.VX], npc[40:, Col.VY]).min()) > 2.0


@pytest.mark.parametrize("agent", ["sumo-krauss", "sumo-idm"])
def test_the_wreck_of_an_ego_that_sumo_drove_stays_where_it_is_and_stops_traffic(
    agent: str,
) -> None:
    oncoming = car(
        place("harbour_0_0", 120, speed=8.0), place("harbour_0_0", 20, speed=8.0),
        name="oncoming", behavior="replay",
    )  # fmt: skip
    behind = car(
        place("harbour_0_0", 5, speed=8.0), place(ROAD, 120, speed=8.0),
        name="behind", behavior="sumo", start_time=6.0,
    )  # fmt: skip
    what = scenario(
        ego(place("harbour_0_0", 20), place(ROAD, 60), agent=agent, initial_speed=5.0),
        WITNESS,
        npc_vehicles=(oncoming, behind),
        seconds=40.0,
    )
    driver = AgentCatalogue().create(agent, {})
    trace, seen = mirrored(what, driver, standing())
    assert trace.ego_ends[0] is TerminalEvent.COLLISION
    crash = trace.ego_end_steps[0]
    check(trace, seen, ("ego", "behind", "witness"))
    wreck = np.array([frame["ego"] for frame in seen.frames[crash:]])
    assert float(np.ptp(wreck, axis=0).max()) < TOLERANCE
    # Behind it, not behind the place where it started, 20 m and more before.
    start_pose = place("harbour_0_0", 20)
    apart = np.hypot(*(track(trace, "behind")[-1] - track(trace, "ego")[-1]))
    assert speeds(trace, "behind")[-1] < 0.1
    assert apart == pytest.approx(0.5 * 4.9 + 0.5 * 4.9 + 2.5, abs=1.0)
    assert np.hypot(*(track(trace, "ego")[-1] - (start_pose.x, start_pose.y))) > 8.0


def test_sumo_holds_every_kind_of_actor_where_the_trace_has_it() -> None:
    on = "signal-grid"
    what = scenario(
        ego(place("grand_1_1", 20, on=on), place("grand_3_2", 80, on=on), name="one"),
        ego(
            place("castle_1_1", 20, on=on), place("queen_3_1", 60, on=on), name="two",
            agent="sumo-eidm", start_time=2.0, initial_speed=4.0,
        ),
        on=on,
        npc_vehicles=(
            car(place("grand_1_1", 60, on=on), place("grand_2_1", 60, on=on), name="reactive"),
            car(
                place("-bridge_2_1", 20, on=on), place("-bridge_1_1", 60, on=on), name="driven",
                behavior="sumo", start_time=1.0,
            ),
        ),
        npc_walkers=(
            walker(place("grand_1_1", 90, on=on, right=6), place("grand_1_1", 90, on=on, right=-2)),
        ),
        npc_obstacles=(obstacle(place("queen_2_1", 50, on=on, right=3.0)),),
        background_traffic=BackgroundTraffic(count=10, start_time=1.0),
        seconds=45.0,
    )  # fmt: skip
    check(*mirrored(what))


def test_a_vehicle_that_brakes_hard_stands_and_stays_does_so_in_sumo() -> None:
    middle = replace(place(ROAD, 60, speed=14.0), wait=2.0)
    npc = car(
        place(ROAD, 5, speed=14.0), middle, place(ROAD, 115, speed=14.0),
        at_end=RouteEnd.STAY, deceleration=12.0,
    )  # fmt: skip
    trace, seen = mirrored(scenario(WITNESS, npc_vehicles=(npc,), seconds=25.0), standing())
    check(trace, seen, ["npc"])
    places = np.array([frame["npc"] for frame in seen.frames if "npc" in frame])
    speed = np.hypot(*np.diff(places, axis=0).T) / 0.05
    braking = (speed[:-2] - speed[2:]) / 0.1
    # Its model's braking, and no more, up to SUMO's matching of places to lanes.
    assert 8.0 < braking.max() < 9.0
    assert np.count_nonzero(speed < 1e-3) > 40
    assert (speed[-100:] < 1e-3).all()


def test_sumos_drivers_stop_behind_a_vehicle_that_stays_at_its_end() -> None:
    stays = car(place(ROAD, 40, speed=10.0), place(ROAD, 90, speed=10.0), at_end=RouteEnd.STAY)
    driven = car(place(ROAD, 10), place(ROAD, 120), name="driven", behavior="sumo", start_time=4.0)
    trace, seen = mirrored(
        scenario(WITNESS, npc_vehicles=(stays, driven), seconds=30.0), standing()
    )
    check(trace, seen, ["npc", "driven"])
    end = [track(trace, name)[-1] for name in ("npc", "driven")]
    gap = float(np.hypot(*(end[0] - end[1]))) - 4.9
    assert 0.5 < gap < 6.0
    assert speeds(trace, "driven")[-1] < 0.1
