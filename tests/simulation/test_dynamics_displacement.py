"""How vehicles move, measured at their positions and against closed forms.

Nothing here reads a speed or a rate of the model but to compare it with what the positions say.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from drivora_service.agents.interface import AccelerationControl
from drivora_service.observations.ground import NO_PATCHES
from drivora_service.observations.trace import Col
from drivora_service.scenario.model import VehicleDynamics, Weather
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.simulation.motion.vehicle_dynamics import (
    GRAVITY,
    Body,
    CommandMode,
    drive_vehicles,
)
from drivora_service.simulation.plans.plan_arrays import vehicle_limits
from tests.simulation.episodes import Scripted, accelerating, ego, place, run, scenario

CAR = actor_model(ActorKind.VEHICLE, "vehicle.lincoln.mkz_2017")
TRUCK = actor_model(ActorKind.VEHICLE, "vehicle.carlamotors.firetruck")
STEPS = (0.01, 0.02, 0.05, 0.1)
WIND = 1.3

Script = tuple[tuple[float, float, float], ...]
"""(seconds, acceleration, wheel angle), one after the other."""


def move(
    script: Script,
    dt: float,
    *,
    speed: float,
    friction: float = 1.0,
    dynamic: bool = False,
    wind: tuple[float, float] = (0.0, 0.0),
    model: ActorModel = CAR,
    patches: NDArray[np.float64] = NO_PATCHES,
) -> NDArray[np.float64]:
    """Returns the (n, 10) bodies of a vehicle that begins at the origin, heading east."""
    bodies = np.zeros((1, len(Body)))
    bodies[0, Body.SPEED] = speed
    limits = vehicle_limits([model], [dynamic])
    modes = np.array([int(CommandMode.DRIVE)])
    seen = [bodies[0].copy()]
    for seconds, acceleration, steer in script:
        command = np.array([[acceleration, steer, 0.0, 0.0]])
        for _ in range(round(seconds / dt)):
            drive_vehicles(bodies, limits, modes, command, friction, patches, np.array(wind), dt)
            seen.append(bodies[0].copy())
    return np.array(seen)


def driven(track: NDArray[np.float64]) -> float:
    """Metres along the way."""
    return float(np.hypot(*np.diff(track[:, :2], axis=0).T).sum())


def pulls(track: NDArray[np.float64], dt: float) -> NDArray[np.float64]:
    """Magnitude of the acceleration, from second differences of the positions, m/s²."""
    return np.asarray(np.hypot(*np.diff(track[:, :2], n=2, axis=0).T) / dt**2)


@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("model", [CAR, TRUCK])
def test_full_lock_is_a_circle_of_the_geometry_at_the_speed_that_is_recorded(
    model: ActorModel, dt: float
) -> None:
    lock = model.max_steer
    track = move(((20.0, 0.0, lock),), dt, speed=3.0, model=model)
    steady = track[round(3.0 / dt) :]
    # The box centre, half the wheelbase before the rear axle, which turns about L / tan(steer).
    radius = math.hypot(model.wheelbase / math.tan(lock), 0.5 * model.wheelbase)
    span = np.ptp(steady[:, :2], axis=0)
    assert span == pytest.approx(2.0 * radius, rel=0.003)
    by_positions = np.hypot(*np.diff(steady[:, :2], axis=0).T) / dt
    recorded = np.hypot(steady[:, Body.SPEED], steady[:, Body.SIDE_SPEED])
    assert by_positions == pytest.approx(recorded[1:], rel=0.002)
    assert by_positions == pytest.approx(3.0, rel=0.002)


def test_the_trace_of_a_run_at_full_lock_has_the_speed_of_its_positions() -> None:
    lock = Scripted(lambda _: AccelerationControl(0.0, 1.0))
    trace = run(
        scenario(
            ego(place("harbour_0_0", 60), place("harbour_0_0", 100), initial_speed=3.0), seconds=8.0
        ),
        lock,
    )
    states = trace.states[60:, 0]
    moved = np.hypot(*np.diff(states[:, [Col.X, Col.Y]], axis=0).T) / trace.step_length
    recorded = np.hypot(states[:, Col.VX], states[:, Col.VY])
    assert moved == pytest.approx(0.5 * (recorded[1:] + recorded[:-1]), rel=0.002)


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("dt", [*STEPS, 0.2, 0.03, 0.07])
@pytest.mark.parametrize("friction", [1.0, 0.4])
def test_braking_distance_is_that_of_the_positions(
    friction: float, dt: float, dynamic: bool
) -> None:
    track = move(((15.0, -20.0, 0.0),), dt, speed=20.0, friction=friction, dynamic=dynamic)
    braking = min(CAR.max_deceleration, friction * GRAVITY)
    assert driven(track) == pytest.approx(20.0**2 / (2.0 * braking), rel=0.005)
    assert track[-1, Body.Y] == 0.0


BRAKING_AND_STEERING: dict[str, tuple[float, Script]] = {
    "brakes in a bend": (25.0, ((1.0, 0.0, 0.06), (3.0, -20.0, 0.06))),
    "brakes and turns in at once": (20.0, ((3.0, -20.0, 0.5),)),
    "brakes gently and turns in hard": (25.0, ((3.0, -4.0, 0.61),)),
    "swerves": (20.0, ((0.5, 0.0, 0.3), (0.8, 0.0, -0.3), (1.5, -6.0, 0.2))),
    "pulls and turns": (6.0, ((3.0, 10.0, 0.5),)),
    "turns in and lets go": (18.0, ((1.0, 0.0, 0.61), (2.0, 0.0, 0.0))),
}


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("friction", [1.0, 0.7, 0.4])
@pytest.mark.parametrize("name", BRAKING_AND_STEERING)
def test_braking_and_steering_together_stay_within_the_friction_circle(
    name: str, friction: float, dynamic: bool
) -> None:
    speed, script = BRAKING_AND_STEERING[name]
    most = []
    for dt in STEPS:
        track = move(script, dt, speed=speed, friction=friction, dynamic=dynamic)
        most.append(float(pulls(track, dt).max()))
    assert max(most) <= 1.005 * friction * GRAVITY
    # The grip is used, or else this would say nothing.
    assert max(most) > 0.75 * min(friction * GRAVITY, CAR.max_deceleration)


@pytest.mark.parametrize("friction", [1.0, 0.4])
def test_a_vehicle_that_brakes_as_hard_as_it_can_still_steers_a_little(friction: float) -> None:
    track = move(((6.0, -20.0, 0.3),), 0.05, speed=20.0, friction=friction)
    straight = 20.0**2 / (2.0 * min(CAR.max_deceleration, friction * GRAVITY))
    assert driven(track) == pytest.approx(straight, rel=0.05)
    assert abs(track[-1, Body.Y]) > 0.5


def test_the_motor_limits_what_is_asked_at_speed_and_not_the_asking() -> None:
    half = 0.5 * CAR.max_speed
    left = 0.5 * CAR.max_acceleration
    for asked, got in ((0.5 * left, 0.5 * left), (0.9 * left, 0.9 * left), (99.0, left)):
        track = move(((0.4, asked, 0.0),), 0.05, speed=half)
        extra = track[-1, Body.X] - half * 0.4
        assert extra == pytest.approx(0.5 * got * 0.4**2, rel=0.03)
    # From standstill on full throttle: v = v_max (1 - exp(-a t / v_max)).
    rate = CAR.max_acceleration / CAR.max_speed
    track = move(((20.0, 99.0, 0.0),), 0.05, speed=0.0)
    expected = CAR.max_speed * (20.0 - (1.0 - math.exp(-rate * 20.0)) / rate)
    assert driven(track) == pytest.approx(expected, rel=0.002)


MANOEUVRES: dict[str, tuple[float, Script]] = {
    **BRAKING_AND_STEERING,
    "starts and turns at a junction": (0.0, ((2.0, 2.0, 0.0), (4.0, 0.0, 0.35), (2.0, -3.0, 0.0))),
    "circles at full lock": (4.0, ((10.0, 0.0, 0.61),)),
    "changes lanes": (30.0, ((1.0, 0.0, 0.01), (1.0, 0.0, -0.01), (1.0, 0.0, 0.0))),
}


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("friction", [1.0, 0.4])
@pytest.mark.parametrize("name", MANOEUVRES)
def test_the_same_manoeuvre_gives_the_same_path_whatever_the_step(
    name: str, friction: float, dynamic: bool
) -> None:
    speed, script = MANOEUVRES[name]
    wind = (0.6, -0.8)
    ways = {
        dt: move(script, dt, speed=speed, friction=friction, dynamic=dynamic, wind=wind)
        for dt in STEPS
    }
    finest = ways[0.01]
    for dt, way in ways.items():
        same_times = finest[:: round(dt / 0.01)]
        apart = np.hypot(*(way[:, :2] - same_times[:, :2]).T).max()
        assert apart <= 0.01 * driven(finest), dt


@pytest.mark.parametrize("dt", [0.03, 0.04, 0.07])
@pytest.mark.parametrize("dynamic", [False, True])
def test_steps_that_no_substep_divides_give_the_same_path(dt: float, dynamic: bool) -> None:
    script: Script = ((84 * 0.05, -1.0, 0.04),)
    finest = move(script, 0.01, speed=20.0, dynamic=dynamic)
    way = move(script, dt, speed=20.0, dynamic=dynamic)
    assert way[-1, :2] == pytest.approx(finest[-1, :2], abs=0.01 * driven(finest))


@pytest.mark.parametrize("dynamic", [False, True])
def test_the_wind_moves_a_vehicle_as_far_at_every_step_length(dynamic: bool) -> None:
    speed, seconds = 20.0, 10.0
    drifts = [
        move(((seconds, 0.0, 0.0),), dt, speed=speed, dynamic=dynamic, wind=(0.0, WIND))[-1, Body.Y]
        for dt in (0.02, 0.05, 0.1, 0.2)
    ]
    assert max(drifts) == pytest.approx(min(drifts), rel=0.01)
    # Two axles on tyres whose force rises by B C mu m g a radian hold a side force of m w at a slip
    # angle of w / (B C mu g); the vehicle moves by that angle beside its heading.
    expected = speed * seconds * WIND / (10.0 * 1.9 * GRAVITY)
    assert drifts[0] == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("dynamics", list(VehicleDynamics))
def test_the_wind_of_a_document_does_so_too(dynamics: VehicleDynamics) -> None:
    # The wind blows to the north-east; harbour_0_0 leads south.
    what = scenario(
        ego(
            place("harbour_0_0", 10), place("harbour_0_0", 200), initial_speed=10.0,
            dynamics=dynamics,
        ),
        weather=Weather(wind_intensity=100.0), seconds=8.0,
    )  # fmt: skip
    calm = replace(what, weather=Weather())
    found = []
    for dt in (0.02, 0.05, 0.2):
        ends = [
            run(replace(one, step_length=dt), accelerating(0.0)).states[-1, 0, [Col.X, Col.Y]]
            for one in (what, calm)
        ]
        found.append(float(np.hypot(*(ends[0] - ends[1]))))
    assert max(found) == pytest.approx(min(found), rel=0.01)
    assert found[0] == pytest.approx(80.0 * WIND * math.sqrt(0.5) / (19.0 * GRAVITY), rel=0.1)
