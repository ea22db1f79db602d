"""Slippery patches while the weather changes: the lower friction of place and time counts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.interface import AccelerationControl
from drivora_service.observations.recorded_conditions import frictions_under
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import (
    FrictionPatch,
    NpcVehicle,
    Scenario,
    VehicleDynamics,
    Waypoint,
    Weather,
    WeatherChange,
)
from drivora_service.scenario.weather import weather_effects
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
)

RAIN = Weather(precipitation=100.0, wetness=100.0, precipitation_deposits=100.0)
WET = weather_effects(RAIN).friction
ICE, DAMP = 0.2, 0.6
GRAVITY, BRAKES = 9.81, 8.5
SPEED = 15.0
BRAKING = Scripted(lambda seen: AccelerationControl(-20.0, 0.0))


def patch(s: float, *, length: float, friction: float) -> FrictionPatch:
    """One from side to side of the road, ``length`` metres from ``s`` on."""
    middle = place(ROAD, s + 0.5 * length)
    return FrictionPatch(id="ice", location=middle, length=length, width=8.0, friction=friction)


def braking(*changes: tuple[float, Weather], patches: tuple[FrictionPatch, ...] = ()) -> Scenario:
    """An ego 5 m along the road that brakes from the beginning on, in dynamic tyres."""
    ego_ = ego(
        place(ROAD, 5), place(ROAD, 120), initial_speed=SPEED, dynamics=VehicleDynamics.DYNAMIC
    )
    return scenario(
        ego_, friction_patches=patches, seconds=9.0,
        weather_changes=tuple(WeatherChange(time=t, weather=w) for t, w in changes),
    )  # fmt: skip


def way(trace: Trace, name: str = "ego") -> float:
    """Metres to the standstill."""
    assert speeds(trace, name)[-1] < 0.01
    return float(np.nansum(speeds(trace, name)) * trace.step_length)


def test_rain_on_the_way_to_a_patch_and_the_patch_lengthen_the_braking_distance() -> None:
    """1 s on dry road, then rain, and from 18 m on ice: each stretch by its own grip."""
    dry = SPEED - BRAKES * 0.5, SPEED * 0.5 - 0.5 * BRAKES * 0.25
    edge = 18.0
    squared = dry[0] ** 2 - 2.0 * WET * GRAVITY * (edge - dry[1])
    assert squared > 0.0
    wanted = edge + squared / (2.0 * ICE * GRAVITY)
    ice = patch(5.0 + edge, length=80.0, friction=ICE)
    both = run(braking((0.5, RAIN), patches=(ice,)), BRAKING)
    assert way(both) == pytest.approx(wanted, rel=0.03)
    rain, icy = run(braking((0.5, RAIN)), BRAKING), run(braking(patches=(ice,)), BRAKING)
    assert way(rain) == pytest.approx(dry[1] + dry[0] ** 2 / (2.0 * WET * GRAVITY), rel=0.03)
    assert way(both) > max(way(rain), way(icy)) + 3.0


def test_the_recorded_friction_under_an_ego_is_the_lower_of_place_and_time() -> None:
    ice = patch(5.0 + 18.0, length=80.0, friction=ICE)
    trace = run(braking((0.5, RAIN), patches=(ice,)), BRAKING)
    row = row_of(trace, "ego")
    found = frictions_under(trace, trace.actors[row], 0, trace.states[:, row])
    gone = np.hypot(*(track(trace, "ego") - track(trace, "ego")[0]).T)
    half = 1.5
    assert (found[:10] == 1.0).all()
    assert (found[10:][gone[10:] < 18.0 - half] == WET).all()
    assert (found[gone > 18.0 + half] == ICE).all()
    later = frictions_under(trace, trace.actors[row], 5, trace.states[5:, row])
    assert np.array_equal(later, found[5:])


def test_a_patch_with_more_grip_than_the_rain_leaves_shows_only_while_it_is_dry() -> None:
    damp = patch(5.0, length=110.0, friction=DAMP)
    alone, on_patch = (
        run(braking((0.0, RAIN), (1.0, Weather()), patches=patches), BRAKING)
        for patches in ((), (damp,))
    )
    assert np.array_equal(alone.states[:21], on_patch.states[:21], equal_nan=True)
    speed = SPEED - WET * GRAVITY * 1.0
    begun = SPEED * 1.0 - 0.5 * WET * GRAVITY
    assert way(on_patch) == pytest.approx(begun + speed**2 / (2.0 * DAMP * GRAVITY), rel=0.03)
    assert way(alone) == pytest.approx(begun + speed**2 / (2.0 * BRAKES), rel=0.03)


def _follower(braked: bool, *changes: WeatherChange, patches: tuple[FrictionPatch, ...]) -> Trace:
    blocks = (obstacle(place(ROAD, 54), start_time=2.0),) if braked else ()
    return run(
        scenario(
            parked(),
            npc_vehicles=(car(place(ROAD, 5, speed=12.0), place(ROAD, 124, speed=12.0)),),
            npc_obstacles=blocks, friction_patches=patches, weather_changes=changes, seconds=9.0,
        ),
        standing(),
    )  # fmt: skip


def test_npc_vehicles_have_the_lower_friction_of_place_and_time_too() -> None:
    """Rain from 2 s on, when a block appears; ice from 42 m on."""
    rain = WeatherChange(time=2.0, weather=RAIN)
    ice = patch(42.0, length=40.0, friction=ICE)

    def hardest(trace: Trace, *, on_ice: bool) -> float:
        x, y = ice.location.x, ice.location.y
        away = np.hypot(*(track(trace, "npc") - (x, y)).T)
        here = (away < 20.0) == on_ice
        slower = -np.diff(speeds(trace, "npc")) / trace.step_length
        return float(np.nanmax(np.where(here[:-1] & here[1:], slower, -np.inf)))

    both = _follower(True, rain, patches=(ice,))
    assert hardest(both, on_ice=False) == pytest.approx(WET * GRAVITY, abs=0.05)
    assert hardest(both, on_ice=True) == pytest.approx(ICE * GRAVITY, abs=0.05)
    dry = _follower(True, patches=(ice,))
    assert hardest(dry, on_ice=False) > WET * GRAVITY + 1.0


def _corner(**more: Any) -> NpcVehicle:
    return car(place("harbour_0_0", 60, speed=9.0), place("ferry_1_0", 40, speed=9.0), **more)


def _icy_corner(*npcs: NpcVehicle) -> tuple[Scenario, Waypoint]:
    dry = plan_npc(_corner(), network(), 1.0).path
    bend = np.abs(np.gradient(dry.yaw, dry.arc))[dry.arc < 110.0]
    sharpest = int(np.argmax(bend))
    spot = Waypoint(x=float(dry.line[sharpest, 0]), y=float(dry.line[sharpest, 1]), yaw=0.0)
    ice = FrictionPatch(id="ice", location=spot, length=40.0, width=40.0, friction=ICE)
    return scenario(parked(), npc_vehicles=npcs, friction_patches=(ice,), seconds=25.0), spot


def _side(trace: Trace, spot: Waypoint) -> float:
    """m/s² to the side in the corner."""
    row = row_of(trace, "npc")
    away = np.abs(track(trace, "npc") - (spot.x, spot.y)).max(axis=1)
    side = trace.speeds(row) * np.abs(trace.states[:, row, Col.YAW_RATE])
    return float(np.nanmax(side[away < 19.0]))


def test_an_actor_that_joins_a_run_knows_the_patches_in_its_bends() -> None:
    what, spot = _icy_corner(_corner(joins=True, start_time=1.0))
    told = run(what, standing())
    assert _side(told, spot) <= ICE * GRAVITY
    dry = replace(what, friction_patches=())
    assert _side(run(dry, standing()), spot) > 2.0 * ICE * GRAVITY
    empty, _ = _icy_corner()
    episode = start(empty, standing())
    for _ in range(10):
        episode.step()
    episode.add_vehicle(replace(_corner(), start_time=1.0))
    while not episode.done:
        episode.step()
    added = episode.finish()
    assert episode.scenario == what
    assert np.array_equal(added.states, told.states, equal_nan=True)


@pytest.mark.parametrize("friction", [0.1, 0.2])
def test_an_actor_that_joins_plans_by_the_lower_of_the_patch_and_the_weather_of_its_time(
    friction: float,
) -> None:
    what, spot = _icy_corner(_corner(joins=True, start_time=1.0))
    (ice,) = what.friction_patches
    icy = replace(
        what,
        friction_patches=(replace(ice, friction=friction),),
        weather_changes=(WeatherChange(time=0.5, weather=RAIN),),
    )
    assert friction < WET
    assert 0.3 * friction * GRAVITY < _side(run(icy, standing()), spot) <= friction * GRAVITY
    # Without the patch the rain is what counts.
    wet = replace(icy, friction_patches=())
    side = _side(run(wet, standing()), spot)
    assert friction * GRAVITY < side <= WET * GRAVITY


def test_a_skid_in_a_bend_follows_place_and_time() -> None:
    """A vehicle that steers hard has the side grip of what is under it."""
    wide = FrictionPatch(
        id="ice", location=place(ROAD, 60), length=300.0, width=300.0, friction=ICE
    )
    steering = Scripted(lambda seen: AccelerationControl(0.0, 0.3))

    def sideways(friction: float, *changes: WeatherChange) -> tuple[float, float]:
        """m/s² to the side within the second second, and within the fourth."""
        what = scenario(
            ego(place(ROAD, 60), place(ROAD, 120), initial_speed=9.0,
                dynamics=VehicleDynamics.DYNAMIC),
            friction_patches=(replace(wide, friction=friction),), weather_changes=changes,
            seconds=4.0,
        )  # fmt: skip
        trace = run(what, steering)
        row = row_of(trace, "ego")
        side = trace.speeds(row) * np.abs(trace.states[:, row, Col.YAW_RATE])
        return float(np.nanmedian(side[25:40])), float(np.nanmedian(side[65:]))

    rain = WeatherChange(time=2.0, weather=RAIN)
    before, after = sideways(DAMP, rain)
    assert before > 1.2 * WET * GRAVITY
    assert after <= WET * GRAVITY * 1.03
    # Where there is less grip than that already, the rain changes nothing.
    assert sideways(ICE, rain) == pytest.approx(sideways(ICE), abs=1e-12)
