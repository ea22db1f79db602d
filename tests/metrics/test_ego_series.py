"""The series of an ego, compared with SUMO's own state and with places of boxes."""

from __future__ import annotations

import math
from typing import Any

import libsumo
import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import PedalControl
from drivora_service.geometry.outlines import box_corners
from drivora_service.metrics.ego_series import COLUMNS, INTEGERS, ego_series
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import AgentChoice, BackgroundTraffic, EgoVehicle
from drivora_service.simulation.episode import Episode
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.simulation.episodes import (
    CAR,
    ROAD,
    Scripted,
    car,
    ego,
    network,
    place,
    run,
    scenario,
    start,
)

Values = dict[str, NDArray[Any]]


def series(trace: Trace, on: str = "tee-town") -> Values:
    return dict(ego_series(RunView(trace, network(on)).egos[0]))


@pytest.fixture(scope="module")
def driven_by_sumo() -> tuple[Values, list[dict[str, Any]], Trace]:
    """A car of SUMO through signals among others: its series, and SUMO's state at each step."""
    grid = network("signal-grid")
    route = tuple(
        place(lane, s, on="signal-grid") for lane, s in (("-grand_4_1", 10.0), ("-grand_1_1", 60.0))
    )
    what = scenario(
        EgoVehicle(id="ego", model=CAR, route=route, agent=AgentChoice(name="sumo-krauss")),
        on="signal-grid",
        seconds=60.0,
        background_traffic=BackgroundTraffic(count=25),
        seed=3,
    )
    driver = AgentCatalogue().create("sumo-krauss", {})
    episode: Episode = start(what, driver, mirrored=True)  # type: ignore[arg-type]  # of either kind
    seen: list[dict[str, Any]] = [{}]
    while not episode.done:
        episode.step()
        vehicle = libsumo.vehicle
        if "ego" not in vehicle.getIDList():
            break
        seen.append(
            {
                "speed": vehicle.getSpeed("ego"),
                "limit": libsumo.lane.getMaxSpeed(vehicle.getLaneID("ego")),
                "lane": vehicle.getLaneID("ego"),
                "signals": vehicle.getNextTLS("ego"),
                "leader": vehicle.getLeader("ego", 60.0),
                "min_gap": vehicle.getMinGap("ego"),
            }
        )
    trace = episode.finish()
    return dict(ego_series(RunView(trace, grid).egos[0])), seen, trace


def test_speed_limit_and_signal_are_those_of_sumo(
    driven_by_sumo: tuple[Values, list[dict[str, Any]], Trace],
) -> None:
    values, seen, _ = driven_by_sumo
    count = min(len(seen), len(values["step"]))
    assert count > 400
    lanes = network("signal-grid").lanes
    signals = 0
    for k in range(1, count):
        assert values["speed"][k] == pytest.approx(seen[k]["speed"], abs=0.15)
        if (
            not lanes[values["lane"][k]].is_internal
            and lanes[values["lane"][k]].id == seen[k]["lane"]
        ):
            assert values["speed_limit"][k] == pytest.approx(seen[k]["limit"])
        if seen[k]["signals"] and values["light"][k] and values["light_distance"][k] > 5.0:
            _, _, distance, letter = seen[k]["signals"][0]
            assert values["light_distance"][k] == pytest.approx(distance, abs=1.5)
            expected = {"G": 1, "g": 1, "y": 2, "r": 3, "u": 3}[letter]
            # SUMO's state is that of the step that led here; at a switch they may differ once.
            if k + 1 < count and seen[k + 1]["signals"]:
                assert values["light"][k] in (expected, values["light"][k - 1])
            signals += 1
    assert signals > 100


def test_the_gap_to_the_actor_ahead_is_that_of_sumo(
    driven_by_sumo: tuple[Values, list[dict[str, Any]], Trace],
) -> None:
    values, seen, trace = driven_by_sumo
    compared = 0
    for k in range(1, min(len(seen), len(values["step"]))):
        leader = seen[k]["leader"]
        if not leader or not leader[0] or values["lead_actor"][k] < 0:
            continue
        if trace.actors[values["lead_actor"][k]].id != leader[0] or abs(values["steer"][k]) > 0.02:
            continue
        gap = leader[1] + seen[k]["min_gap"]
        if gap < 25.0:
            assert values["lead_gap"][k] == pytest.approx(gap, abs=0.8)
            compared += 1
    assert compared > 20


def test_motion_is_that_of_the_displacement() -> None:
    trace = run(scenario(ego(place(ROAD, 5), place(ROAD, 110)), seconds=12.0))
    values = series(trace)
    places = trace.states[values["step"], 0][:, [Col.X, Col.Y]]
    moved = np.hypot(*np.diff(places, axis=0).T) / trace.step_length
    mean = 0.5 * (values["speed"][1:] + values["speed"][:-1])
    assert moved == pytest.approx(mean, abs=0.05)
    assert np.sum(moved) * trace.step_length == pytest.approx(
        values["route_distance"][-1] - values["route_distance"][0], abs=0.5
    )
    gained = np.diff(values["speed"]) / trace.step_length
    assert gained == pytest.approx(values["acceleration"][1:], abs=0.2)
    assert values["route_left"] + values["route_distance"] == pytest.approx(
        trace.ego_routes[0].length
    )


def test_pedals_are_those_that_an_agent_pressed() -> None:
    pressed = [(0.6, 0.0), (0.0, 0.4)]

    def answer(observation: Any) -> PedalControl:
        throttle, brake = pressed[observation.step >= 40]
        return PedalControl(throttle, brake, 0.0)

    trace = run(scenario(ego(place(ROAD, 5), place(ROAD, 110)), seconds=3.0), Scripted(answer))
    values = series(trace)
    k = values["step"]
    for part, (throttle, brake) in ((k < 39, pressed[0]), ((k > 42) & (k < 55), pressed[1])):
        assert values["throttle"][part] == pytest.approx(throttle)
        assert values["brake"][part] == pytest.approx(brake)


def test_times_to_collision_are_those_of_boxes_that_move_on() -> None:
    what = scenario(
        ego(place(ROAD, 5), place(ROAD, 110), initial_speed=12.0),
        npc_vehicles=(car(place(ROAD, 60, speed=3.0), place(ROAD, 120, speed=3.0), name="slow"),),
        seconds=4.0,
    )
    trace = run(what)
    values = series(trace)
    times = values["time_to_collision"]
    finite = np.flatnonzero(np.isfinite(times))
    assert len(finite) > 20
    for k in finite[::7].tolist():
        assert values["time_to_collision_actor"][k] == 1
        row = int(values["step"][k])
        apart = [
            moved(trace, row, 0, seconds).distance(moved(trace, row, 1, seconds))
            for seconds in (times[k] - 0.05, times[k])
        ]
        assert apart[0] > 0.0
        assert apart[1] < 1e-6
    assert values["gap_actor"].tolist() == [1] * len(times)
    for k in range(0, len(times), 9):
        row = int(values["step"][k])
        gap = moved(trace, row, 0, 0.0).distance(moved(trace, row, 1, 0.0))
        assert values["gap"][k] == pytest.approx(gap, abs=1e-6)


def moved(trace: Trace, row: int, actor: int, seconds: float) -> shapely.Polygon:
    """Returns an actor's box after some time at its velocity."""
    state, size = trace.states[row, actor], trace.actors[actor]
    x, y = state[Col.X] + seconds * state[Col.VX], state[Col.Y] + seconds * state[Col.VY]
    corners = box_corners(
        np.array([x]), np.array([y]), np.array([state[Col.YAW]]), size.length, size.width
    )
    return shapely.Polygon(corners[0])


def test_braking_that_is_needed_behind_a_slower_car() -> None:
    steps = 10
    leader = SyntheticActor(id="lead", motion=Motion.steady(30.0, 0.0, steps=steps, speed=4.0))
    trace = make_trace(
        [SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=steps, speed=10.0))], [leader]
    )
    trace.meta["friction"] = 0.5
    values = dict(ego_series(RunView(trace, straight_road()).egos[0]))
    gap = 30.0 - 0.5 * (trace.actors[0].length + trace.actors[1].length)
    assert values["lead_gap"][0] == pytest.approx(gap)
    assert values["required_deceleration"][0] == pytest.approx(6.0**2 / (2.0 * gap))
    assert values["time_to_collision"][0] == pytest.approx(gap / 6.0)
    assert values["grip"] == pytest.approx(0.5 * 9.81)


def test_a_bend_leaves_less_grip_and_lonely_egos_have_no_gaps() -> None:
    radius, speed, dt = 20.0, 8.0, 0.05
    angle = np.arange(40) * speed * dt / radius
    motion = Motion.along(
        radius * np.sin(angle), radius * (1.0 - np.cos(angle)), step_length=dt, yaw=angle
    )
    trace = make_trace([SyntheticEgo(motion=motion)], step_length=dt)
    trace.meta["friction"] = 0.6
    values = dict(ego_series(RunView(trace, straight_road()).egos[0]))
    middle = slice(5, 35)
    across = speed**2 / radius
    assert values["lateral_acceleration"][middle] == pytest.approx(across, rel=0.01)
    left = math.sqrt((0.6 * 9.81) ** 2 - across**2)
    assert values["available_grip"][middle] == pytest.approx(left, rel=0.01)
    for name in ("gap", "lead_gap", "lead_speed", "time_to_collision"):
        assert np.isnan(values[name]).all(), name
    for name in ("gap_actor", "lead_actor", "time_to_collision_actor"):
        assert (values[name] == -1).all(), name


def test_columns_are_declared_with_their_kinds() -> None:
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=3))])
    values = ego_series(RunView(trace, straight_road()).egos[0])
    assert list(values) == [column.name for column in COLUMNS]
    for column in COLUMNS:
        assert column.description.endswith(".")
        whole = bool(np.issubdtype(values[column.name].dtype, np.integer))
        assert whole is (column.name in INTEGERS)


def test_an_ego_that_never_began_has_no_rows() -> None:
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=3), start_time=9.0)])
    values = ego_series(RunView(trace, straight_road()).egos[0])
    assert {len(column) for column in values.values()} == {0}
