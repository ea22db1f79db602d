"""Slippery patches act on every body, by displacement and against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.agents.interface import AccelerationControl
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.observations.ground import patch_array
from drivora_service.observations.recorded_conditions import PATCHES_KEY
from drivora_service.observations.trace import Col
from drivora_service.scenario.model import (
    BackgroundTraffic,
    FrictionPatch,
    NpcVehicle,
    Scenario,
    VehicleDynamics,
    Waypoint,
    Weather,
)
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY, Body, CommandMode
from drivora_service.simulation.plans.planning_npcs import plan_npc
from tests.simulation.episodes import (
    ROAD,
    Scripted,
    car,
    ego,
    network,
    obstacle,
    parked,
    place,
    row_of,
    run,
    scenario,
    speeds,
    standing,
    start,
    track,
    travelled,
)
from tests.simulation.motion.test_vehicle_dynamics import drive as command_car
from tests.simulation.test_dynamics_displacement import CAR, STEPS, move, pulls

ICE = 0.2


def patch(
    centre: Waypoint, *, length: float = 100.0, width: float = 8.0, friction: float = ICE
) -> FrictionPatch:
    return FrictionPatch(id="ice", location=centre, length=length, width=width, friction=friction)


def laid(
    x: float, *, y: float = 0.0, length: float, width: float = 8.0, friction: float = ICE
) -> NDArray[np.float64]:
    """A patch along the x axis, as kernels take it."""
    return patch_array(
        [
            {
                "x": x,
                "y": y,
                "z": 0.0,
                "yaw": 0.0,
                "length": length,
                "width": width,
                "friction": friction,
            }
        ]
    )


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("friction", [0.1, 0.2, 0.5])
@pytest.mark.parametrize("dt", STEPS)
def test_an_ego_on_a_patch_stops_by_the_grip_there(
    dt: float, friction: float, dynamic: bool
) -> None:
    ice = laid(0.0, length=2000.0, friction=friction)
    speed = 12.0
    seconds = speed / (friction * GRAVITY) + 1.0
    seconds = math.ceil(seconds)
    body = move(((seconds, -20.0, 0.0),), dt, speed=speed, dynamic=dynamic, patches=ice)
    assert body[-1, Body.X] == pytest.approx(speed**2 / (2 * friction * GRAVITY), rel=0.02)


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("dt", STEPS)
def test_an_ego_that_brakes_into_a_patch_loses_grip_axle_by_axle(dt: float, dynamic: bool) -> None:
    brakes = min(CAR.max_deceleration, GRAVITY)
    edge, half, speed = 10.0, 0.5 * CAR.wheelbase, 18.0
    body = move(
        ((30.0, -20.0, 0.0),), dt, speed=speed, dynamic=dynamic,
        patches=laid(edge + 500.0, length=1000.0),
    )  # fmt: skip
    # The front axle meets the ice half a wheelbase before the centre does, the rear as much later.
    on_ice = ICE * GRAVITY
    between = 0.5 * (on_ice + (min(brakes, GRAVITY) if dynamic else GRAVITY))
    at_front = speed**2 - 2.0 * brakes * (edge - half)
    at_rear = at_front - 2.0 * between * CAR.wheelbase
    stop = edge + half + at_rear / (2.0 * on_ice)
    assert body[-1, Body.X] == pytest.approx(stop, rel=0.02)


def test_a_patch_crossed_between_two_steps_acts() -> None:
    """A step of 0.2 s at 20 m/s covers 4 m; the patch is 2 m long."""
    ice = laid(11.0, length=2.0, friction=0.05)
    crossed = move(((4.0, -8.0, 0.0),), 0.2, speed=20.0, patches=ice)
    fine = move(((4.0, -8.0, 0.0),), 0.01, speed=20.0, patches=ice)
    dry = move(((4.0, -8.0, 0.0),), 0.2, speed=20.0)
    assert crossed[-1, Body.X] == pytest.approx(fine[-1, Body.X], abs=0.05)
    assert crossed[-1, Body.X] > dry[-1, Body.X] + 0.2


@pytest.mark.parametrize("dynamic", [False, True])
def test_a_bend_on_a_patch_is_limited_by_the_grip_there(dynamic: bool) -> None:
    script = ((4.0, 0.0, 0.15),)
    dt = 0.01
    icy = move(script, dt, speed=12.0, dynamic=dynamic, patches=laid(0, length=400, width=400))
    dry = move(script, dt, speed=12.0, dynamic=dynamic)
    # Two seconds on, when the tyres of the skidding vehicle have settled.
    assert pulls(icy, dt)[200:].max() <= ICE * GRAVITY * 1.03
    assert pulls(dry, dt)[200:].max() > 2.5 * ICE * GRAVITY
    turned = abs(icy[-1, Body.YAW] - icy[200, Body.YAW])
    assert turned < 0.5 * abs(dry[-1, Body.YAW] - dry[200, Body.YAW])


@pytest.mark.parametrize("dynamic", [False, True])
def test_nothing_changes_before_the_front_axle_meets_a_patch(dynamic: bool) -> None:
    script = ((2.0, -1.0, 0.02), (2.0, -6.0, -0.02))
    icy = move(script, 0.05, speed=15.0, dynamic=dynamic, patches=laid(45.0, length=30.0))
    dry = move(script, 0.05, speed=15.0, dynamic=dynamic)
    before = dry[:, Body.X] < 30.0 - 0.5 * CAR.wheelbase - 0.05 * 15.0
    assert before.sum() > 30
    assert np.array_equal(icy[before], dry[before])
    assert not np.array_equal(icy, dry)


def test_a_patch_beside_the_way_or_with_more_grip_than_the_road_changes_nothing() -> None:
    script = ((3.0, -6.0, 0.0),)
    dry = move(script, 0.05, speed=15.0)
    beside = move(script, 0.05, speed=15.0, patches=laid(15.0, y=10.0, length=60.0))
    assert np.array_equal(beside, dry)
    wet = move(script, 0.05, speed=15.0, friction=0.4)
    drier = laid(15.0, length=60.0, friction=0.6)
    assert np.array_equal(move(script, 0.05, speed=15.0, friction=0.4, patches=drier), wet)


def test_an_ego_that_is_placed_at_poses_keeps_to_the_grip_too() -> None:
    still = (0.0, 0.0, math.nan, math.nan)
    track_ = command_car(
        300, still, speed=10.0, mode=CommandMode.POSE, patches=laid(0.0, length=200.0)
    )
    assert track_[-1, Body.X] == pytest.approx(10.0**2 / (2 * ICE * GRAVITY), rel=0.05)


def _braking_ego(dynamics: VehicleDynamics, *patches: FrictionPatch) -> Scenario:
    return scenario(
        ego(place(ROAD, 8), place(ROAD, 120), initial_speed=10.0, dynamics=dynamics),
        friction_patches=patches, seconds=9.0,
    )  # fmt: skip


@pytest.mark.parametrize("dynamics", list(VehicleDynamics))
def test_the_patch_of_a_document_acts_on_its_ego(dynamics: VehicleDynamics) -> None:
    brake = Scripted(lambda o: AccelerationControl(-20.0, 0.0))
    icy = run(_braking_ego(dynamics, patch(place(ROAD, 50))), brake)
    assert travelled(icy, "ego") == pytest.approx(10.0**2 / (2 * ICE * GRAVITY), rel=0.03)
    dry = run(_braking_ego(dynamics), brake)
    assert travelled(dry, "ego") == pytest.approx(10.0**2 / (2 * 8.5), rel=0.05)


def _npc(behavior: str) -> NpcVehicle:
    return car(place(ROAD, 5, speed=10.0), place(ROAD, 124, speed=10.0), behavior=behavior)


def _stopping(behavior: str, *patches: FrictionPatch) -> NDArray[np.float64]:
    """(n, 2) metres driven and m/s of a vehicle from the moment when a block appears before it."""
    free = scenario(parked(), npc_vehicles=(_npc(behavior),), friction_patches=patches, seconds=4.0)
    x, y = track(run(free, standing()), "npc")[-1]
    here = nearest_lane_position(network(), float(x), float(y))
    assert here is not None
    block = obstacle(place(ROAD, here.s + 16.0), start_time=4.0)
    what = replace(free, npc_obstacles=(block,), max_sim_time=9.0)
    trace = run(what, standing())
    points, speed = track(trace, "npc")[80:], speeds(trace, "npc")[80:]
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    return np.column_stack((way, speed))


@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_an_npc_on_a_patch_brakes_by_the_grip_there(behavior: str) -> None:
    stop = _stopping(behavior, patch(place(ROAD, 62), length=124.0))
    first, last = stop[np.searchsorted(-stop[:, 1], -9.0)], stop[np.searchsorted(-stop[:, 1], -7.0)]
    needed = (first[1] ** 2 - last[1] ** 2) / (2.0 * ICE * GRAVITY)
    assert last[0] - first[0] == pytest.approx(needed, rel=0.03)
    dry = _stopping(behavior)
    assert np.diff(dry[:, 1]).min() / 0.05 < -4.0


@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_an_npc_gets_its_brakes_back_behind_a_patch(behavior: str) -> None:
    npc = _npc(behavior)
    free = scenario(parked(), npc_vehicles=(npc,), seconds=3.0)
    dry = track(run(free, standing()), "npc")
    here = nearest_lane_position(network(), *map(float, dry[-1]))
    assert here is not None
    # The vehicle leaves the ice 6 m after a block has appeared 24 m before it.
    ice = patch(place(ROAD, here.s + 6.0 - 20.0), length=40.0, friction=0.1)
    block = obstacle(place(ROAD, here.s + 24.0), start_time=3.0)
    what = replace(free, npc_obstacles=(block,), friction_patches=(ice,), max_sim_time=8.0)
    trace = run(what, standing())
    points, speed = track(trace, "npc"), speeds(trace, "npc")
    away = np.hypot(*(points - (ice.location.x, ice.location.y)).T)
    braking = -np.diff(speed) / 0.05
    on, off = away[:-1] < 19.0, (away[:-1] > 20.5) & (np.arange(len(braking)) > 60)
    assert np.nanmax(braking[on]) <= 0.1 * GRAVITY + 0.02
    assert np.nanmax(braking[off]) > 3.0


def test_an_ego_that_sumo_drives_brakes_by_the_grip_of_a_patch() -> None:
    def hardest(*patches: FrictionPatch) -> float:
        what = scenario(
            ego(place(ROAD, 8), place(ROAD, 122), agent="sumo-krauss", initial_speed=10.0),
            npc_obstacles=(obstacle(place(ROAD, 60), start_time=2.5),),
            friction_patches=patches, seconds=7.0,
        )  # fmt: skip
        return float(-np.nanmin(np.diff(speeds(run(what), "ego"))) / 0.05)

    assert hardest() > 3.5
    assert hardest(patch(place(ROAD, 62), length=124.0)) <= ICE * GRAVITY + 0.02


def test_background_traffic_keeps_to_the_grip_of_a_patch() -> None:
    everywhere = FrictionPatch(
        id="ice", location=place(ROAD, 60), length=200.0, width=200.0, friction=0.1
    )
    what = scenario(
        parked(), background_traffic=BackgroundTraffic(count=40), friction_patches=(everywhere,),
        seconds=25.0,
    )  # fmt: skip
    trace = run(what, standing())
    rows = [actor.row for actor in trace.actors if actor.role.value == "background"]
    cos, sin = math.cos(everywhere.location.yaw or 0.0), math.sin(everywhere.location.yaw or 0.0)
    checked = 0
    for row in rows:
        dx = trace.states[:, row, Col.X] - everywhere.location.x
        dy = trace.states[:, row, Col.Y] - everywhere.location.y
        inside = (np.abs(dx * cos + dy * sin) < 99.0) & (np.abs(dy * cos - dx * sin) < 99.0)
        both = inside[2:] & inside[1:-1] & inside[:-2]
        change = np.diff(trace.speeds(row))[1:][both] / 0.05
        checked += len(change)
        assert np.abs(change).max(initial=0.0) <= 0.1 * GRAVITY + 0.02
    assert checked > 200


def test_a_follower_knows_the_patches_in_its_bends() -> None:
    corner = car(place("harbour_0_0", 60, speed=9.0), place("ferry_1_0", 40, speed=9.0))
    dry = plan_npc(corner, network(), 1.0).path
    bend = np.abs(np.gradient(dry.yaw, dry.arc))[dry.arc < 110.0]
    sharpest = int(np.argmax(bend))
    spot = Waypoint(x=float(dry.line[sharpest, 0]), y=float(dry.line[sharpest, 1]), yaw=0.0)
    what = scenario(
        parked(), npc_vehicles=(corner,), friction_patches=(patch(spot, length=40, width=40),),
        seconds=25.0,
    )  # fmt: skip

    def hardest(what: Scenario) -> float:
        """m/s² to the side, inside the square."""
        trace = run(what, standing())
        row = row_of(trace, "npc")
        away = np.abs(track(trace, "npc") - (spot.x, spot.y)).max(axis=1)
        side = trace.speeds(row) * np.abs(trace.states[:, row, Col.YAW_RATE])
        return float(np.nanmax(side[away < 19.0]))

    # Paths are polylines, so turning is uneven: planned is 0.6 of the grip.
    assert hardest(what) <= ICE * GRAVITY
    assert hardest(replace(what, friction_patches=())) > 2.0 * ICE * GRAVITY


def test_a_patch_on_another_level_is_not_under_a_vehicle() -> None:
    brake = Scripted(lambda o: AccelerationControl(-20.0, 0.0))
    above = replace(place(ROAD, 50), z=8.0)
    bridge = run(_braking_ego(VehicleDynamics.KINEMATIC, patch(above)), brake)
    dry = run(_braking_ego(VehicleDynamics.KINEMATIC), brake)
    assert np.array_equal(bridge.states, dry.states, equal_nan=True)


def test_a_patch_that_nothing_touches_changes_no_bit_of_a_run() -> None:
    def states(*patches: FrictionPatch) -> NDArray[np.float64]:
        what = scenario(
            ego(place(ROAD, 8), place(ROAD, 120)),
            npc_vehicles=(
                car(place(ROAD, 40), place(ROAD, 120)),
                car(place("harbour_0_0", 40), place(ROAD, 20), name="s", behavior="sumo"),
            ),
            friction_patches=patches, weather=Weather(wetness=50.0), seconds=8.0,
        )  # fmt: skip
        return run(what).states

    far = patch(place("-north_2_0", 40), length=10.0)
    assert np.array_equal(states(far), states(), equal_nan=True)


def test_runs_with_patches_are_equal_however_sumo_is_told() -> None:
    what = scenario(
        ego(place(ROAD, 8), place(ROAD, 120)),
        npc_vehicles=(
            car(place(ROAD, 40, speed=9.0), place(ROAD, 120, speed=9.0)),
            car(place("harbour_0_0", 60), place(ROAD, 90), name="s", behavior="sumo"),
        ),
        friction_patches=(patch(place(ROAD, 60), length=30.0),), seconds=12.0,
    )  # fmt: skip

    def states(**how: bool) -> NDArray[np.float64]:
        episode = start(what, **how)
        while not episode.done:
            episode.step()
        return episode.finish().states

    first = states()
    for how in ({}, {"mirrored": True}, {"holding": True}):
        assert np.array_equal(states(**how), first, equal_nan=True)


def test_the_trace_records_the_patches_with_their_direction() -> None:
    spot = replace(place(ROAD, 50), yaw=None)
    trace = run(_braking_ego(VehicleDynamics.KINEMATIC, patch(spot)), standing())
    (recorded,) = trace.meta[PATCHES_KEY]
    assert recorded["id"] == "ice"
    assert recorded["yaw"] == pytest.approx(place(ROAD, 50).yaw, abs=0.05)
    assert (recorded["length"], recorded["width"], recorded["friction"]) == (100.0, 8.0, ICE)
    assert PATCHES_KEY not in run(_braking_ego(VehicleDynamics.KINEMATIC), standing()).meta
