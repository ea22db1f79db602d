"""The weather of a document acts in an episode."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.agents.interface import AccelerationControl
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.scenario.model import Weather
from drivora_service.simulation.sumo import SumoWorld
from tests.simulation.episodes import (
    ROAD,
    Scripted,
    Watching,
    accelerating,
    car,
    ego,
    network,
    obstacle,
    parked,
    place,
    run,
    scenario,
    speeds,
    standing,
    start,
    track,
    travelled,
)

WET = Weather(wetness=100.0, precipitation_deposits=100.0)


def _braking_distance(weather: Weather) -> float:
    lane = "harbour_0_0"
    brake = Scripted(lambda o: AccelerationControl(-20.0 if o.time > 0.5 else 0.0, 0.0))
    what = scenario(
        ego(place(lane, 10), place(lane, 200), initial_speed=12.0), weather=weather, seconds=6.0
    )
    return travelled(run(what, brake), "ego")


def test_a_slippery_road_lengthens_the_braking_of_an_ego() -> None:
    assert _braking_distance(WET) > _braking_distance(Weather()) + 5.0


def _hardest_braking(behavior: str, weather: Weather) -> float:
    """m/s² of a vehicle before which a block appears at 4 s."""
    npc = car(place(ROAD, 5, speed=10.0), place(ROAD, 124, speed=10.0), behavior=behavior)
    free = scenario(parked(), npc_vehicles=(npc,), weather=weather, seconds=4.0)
    x, y = track(run(free, standing()), "npc")[-1]
    here = nearest_lane_position(network(), float(x), float(y))
    assert here is not None
    block = obstacle(place(ROAD, here.s + 19.0), start_time=4.0)
    blocked = replace(free, npc_obstacles=(block,), max_sim_time=8.0)
    return float(-np.nanmin(np.diff(speeds(run(blocked, standing()), "npc"))) / 0.05)


@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_a_slippery_road_weakens_the_braking_of_npcs(behavior: str) -> None:
    assert _hardest_braking(behavior, Weather()) > 4.4
    assert 1.5 < _hardest_braking(behavior, WET) <= 0.4 * 9.81 + 0.05


def test_fog_shortens_what_an_ego_perceives() -> None:
    cars = tuple(car(place(ROAD, s), name=f"at{s}") for s in (30, 60, 90, 120))
    seen = {}
    for density in (0.0, 100.0):
        eye = Watching()
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 22)), npc_vehicles=cars,
            weather=Weather(fog_density=density), seconds=0.5,
        )  # fmt: skip
        run(what, eye)
        seen[density] = [len(objects) for objects in eye.seen]
    assert set(seen[0.0]) == {4}
    assert max(seen[100.0]) == 2


def test_noise_and_drop_out_are_seeded() -> None:
    def watched(seed: int, weather: Weather) -> list[np.ndarray]:
        eye = Watching()
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 60)),
            npc_vehicles=tuple(car(place(ROAD, s), name=f"at{s}") for s in (25, 40)),
            weather=weather, seed=seed, seconds=5.0,
        )  # fmt: skip
        run(what, eye)
        return eye.seen

    fog = Weather(fog_density=100.0)
    first, again, other = watched(1, fog), watched(1, fog), watched(2, fog)
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert any(not np.array_equal(a, b) for a, b in zip(first, other, strict=True))
    counts = np.array([len(objects) for objects in first])
    assert 0.05 < np.mean(counts < 2) < 0.6
    near = np.array([objects[0, 0] for objects in first if len(objects) == 2])
    assert 0.1 < near.std() < 0.8
    clear = watched(1, Weather())
    assert all(np.array_equal(a, clear[0]) for a in clear)


def test_egos_do_not_share_their_noise() -> None:
    eyes = (Watching(), Watching())
    what = scenario(
        ego(place(ROAD, 10), place(ROAD, 60), name="a"),
        ego(place("-harbour_1_0", 110), place("-harbour_1_0", 120), name="b"),
        npc_vehicles=(car(place(ROAD, 30)),), weather=Weather(fog_density=100.0), seconds=1.0,
    )  # fmt: skip
    run(what, *eyes)

    def errors(eye: Watching) -> list[float]:
        spot = place(ROAD, 30)
        return [float(o[:, 0][np.abs(o[:, 0] - spot.x) < 4.0].sum()) for o in eye.seen]

    assert errors(eyes[0]) != errors(eyes[1])


def test_wind_pushes_an_ego_off_its_line_but_not_one_that_stands() -> None:
    def drift(wind: float, initial_speed: float) -> float:
        what = scenario(
            ego(place("harbour_0_0", 10), place("harbour_0_0", 200), initial_speed=initial_speed),
            weather=Weather(wind_intensity=wind), seconds=4.0,
        )  # fmt: skip
        # The road leads south, the wind blows to the north-east.
        way = track(run(what, accelerating(0.0)), "ego")
        return float(way[-1, 0])

    assert drift(100.0, 10.0) > drift(0.0, 10.0) + 0.05
    assert drift(100.0, 0.0) == drift(0.0, 0.0)


def test_friction_is_told_to_sumo_only_where_the_road_is_slippery(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[float] = []
    original = SumoWorld.set_friction

    def listen(world: SumoWorld, edges: object, friction: float) -> None:
        told.append(friction)
        original(world, edges, friction)  # type: ignore[arg-type]  # passed on as it came

    monkeypatch.setattr(SumoWorld, "set_friction", listen)
    start(scenario(parked(), seconds=0.1), standing(), mirrored=True)
    assert told == []
    start(scenario(parked(), weather=WET, seconds=0.1), standing(), mirrored=True)
    assert told == [pytest.approx(0.4)]
