"""When SUMO is told of the actors that the service moves, by looking into SUMO itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import libsumo
import pytest

from drivora_service.agents.interface import AccelerationControl
from drivora_service.observations.trace import TerminalEvent
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import BackgroundTraffic, Scenario, Weather
from drivora_service.simulation.episode import Episode
from tests.simulation.episodes import (
    ROAD,
    Scripted,
    car,
    ego,
    obstacle,
    place,
    scenario,
    standing,
    start,
    walker,
)


@dataclass(frozen=True, slots=True)
class InSumo:
    """All that a driver in SUMO can know of the others, and the time."""

    time: float
    vehicles: dict[str, tuple[object, ...]]
    lights: dict[str, str]


def in_sumo() -> InSumo:
    ask = libsumo.vehicle
    return InSumo(
        time=libsumo.simulation.getTime(),
        vehicles={
            name: (
                ask.getPosition(name),
                ask.getAngle(name),
                ask.getSpeed(name),
                ask.getLaneID(name),
                ask.getLanePosition(name),
                ask.getLateralLanePosition(name),
                ask.getWaitingTime(name),
                tuple(ask.getRoute(name)),
                ask.getRouteIndex(name),
                ask.getTypeID(name),
            )
            for name in ask.getIDList()
        },
        lights={
            light: libsumo.trafficlight.getRedYellowGreenState(light)
            for light in libsumo.trafficlight.getIDList()
        },
    )


def states_of(episode: Episode) -> list[InSumo]:
    """What SUMO holds after each step, the first frame included."""
    seen = [in_sumo()]
    while not episode.done:
        episode.step()
        seen.append(in_sumo())
    return seen


def of_every_moved_kind(**more: object) -> Scenario:
    """An ego whose wreck lies across two lanes, NPCs, a walker that crosses, an obstacle."""
    return scenario(
        ego(place("harbour_0_0", 40), place(ROAD, 120), name="crashes", initial_speed=6.0),
        ego(place("-north_2_0", 10), place("-north_2_0", 130), name="stands", start_time=1.0),
        npc_vehicles=(
            car(place("harbour_0_0", 60, right=-3.0), name="parked", behavior="replay"),
            car(
                place("-north_2_0", 40, speed=8.0), place("-north_2_0", 130, speed=8.0),
                name="reactive", start_time=2.0,
            ),
        ),
        npc_walkers=(walker(place(ROAD, 60, right=4.0), place(ROAD, 60, right=-4.0)),),
        npc_obstacles=(obstacle(place(ROAD, 100, right=2.0)),),
        seconds=20.0,
        **more,  # type: ignore[arg-type]  # fields of a scenario
    )  # fmt: skip


def begun(what: Scenario, *, mirrored: bool) -> Episode:
    steering = Scripted(lambda observation: AccelerationControl(0.5, 0.03))
    return start(what, steering, standing(), mirrored=mirrored)


def followed_by(what: Scenario, npc: object) -> Scenario:
    return replace(what, npc_vehicles=(*what.npc_vehicles, npc))  # type: ignore[arg-type]  # of the kind of the others


def driven(start_time: float, to: float = 110.0) -> object:
    """An NPC that SUMO drives past the scene, and that meets its walker and obstacle."""
    return car(
        place("harbour_0_0", 5, speed=8.0), place(ROAD, to, speed=8.0),
        name="driven", behavior="sumo", start_time=start_time,
    )  # fmt: skip


def test_sumo_is_told_nothing_where_it_drives_no_vehicle() -> None:
    before = states_of(start(scenario(ego(place(ROAD, 10), place(ROAD, 40))), mirrored=True))[-1]
    episode = begun(of_every_moved_kind(), mirrored=False)
    while not episode.done:
        episode.step()
        assert in_sumo() == before


def test_a_look_from_outside_finds_every_actor_where_it_is() -> None:
    what = of_every_moved_kind()
    expected = states_of(begun(what, mirrored=True))
    episode = begun(what, mirrored=False)
    episode.catch_up_sumo()
    assert in_sumo() == expected[0]
    looks = []
    while not episode.done:
        episode.step()
        step = episode.look().step
        if step % 7 == 0 or episode.done:
            episode.catch_up_sumo()
            assert in_sumo() == expected[step]
            looks.append(step)
            episode.catch_up_sumo()
            assert in_sumo() == expected[step]
    trace = episode.finish()
    assert trace.ego_ends[0] is TerminalEvent.COLLISION
    assert len(looks) > 20


def test_sumo_catches_up_when_its_first_vehicle_enters_and_lags_when_the_last_has_left() -> None:
    what = followed_by(of_every_moved_kind(), driven(3.0, to=20.0))
    # Without the parked car, which would stop it.
    what = replace(what, npc_vehicles=what.npc_vehicles[1:], max_sim_time=60.0)
    expected = states_of(begun(what, mirrored=True))
    episode = begun(what, mirrored=False)
    told = []
    while not episode.done:
        at = libsumo.simulation.getTime()
        episode.step()
        step = episode.look().step
        if libsumo.simulation.getTime() != at:
            assert in_sumo() == expected[step]
            told.append(step)
    entered = round(3.0 / what.step_length)
    assert told == list(range(entered, told[-1] + 1))
    left = max(k for k, state in enumerate(expected) if "driven" in state.vehicles)
    assert left < told[-1] <= left + 21 < len(expected) - 1


def test_sumo_catches_up_when_an_ego_is_handed_over() -> None:
    what = scenario(
        ego(place("harbour_0_0", 20), place(ROAD, 80), agent="sumo-idm", start_time=4.0),
        ego(place("-north_2_0", 10), place("-north_2_0", 130), name="other"),
        npc_walkers=(walker(place(ROAD, 30, right=4.0), place(ROAD, 30, right=-4.0)),),
        seconds=15.0,
    )
    expected = states_of(start(what, mirrored=True))
    episode = start(what)
    while not episode.done:
        episode.step()
        if episode.time >= 4.0 - 1e-9:
            assert in_sumo() == expected[episode.look().step]


def test_background_traffic_is_told_from_its_start_time_on() -> None:
    what = of_every_moved_kind(background_traffic=BackgroundTraffic(count=6, start_time=2.5))
    expected = states_of(begun(what, mirrored=True))
    episode = begun(what, mirrored=False)
    while not episode.done:
        episode.step()
        if episode.time >= 2.5 - 1e-9:
            assert in_sumo() == expected[episode.look().step]


def joined(episode: Episode) -> None:
    """An NPC of SUMO and a walker join after 5 s."""
    while not episode.done:
        episode.step()
        if episode.look().step == 100:
            episode.add_vehicle(driven(0.0))  # type: ignore[arg-type]  # a vehicle
            episode.add_walker(walker(place(ROAD, 90, right=3.0), name="late"))


def driven_on(episode: Episode) -> None:
    while not episode.done:
        episode.step()


SCENES: dict[str, tuple[Scenario, Callable[[Episode], None]]] = {
    "no vehicle of SUMO": (of_every_moved_kind(), driven_on),
    "from the start": (followed_by(of_every_moved_kind(), driven(0.0)), driven_on),
    "from the second step on": (followed_by(of_every_moved_kind(), driven(0.05)), driven_on),
    "after the crash": (followed_by(of_every_moved_kind(), driven(9.0)), driven_on),
    "one after the other": (
        followed_by(
            followed_by(of_every_moved_kind(), driven(1.0, to=5.0)),
            car(
                place("harbour_0_0", 5, speed=8.0), place(ROAD, 120, speed=8.0),
                name="second", behavior="sumo", start_time=14.0,
            ),
        ),
        driven_on,
    ),
    "on a wet road": (
        followed_by(of_every_moved_kind(weather=Weather(wetness=80.0)), driven(6.0)), driven_on,
    ),
    "background traffic": (
        of_every_moved_kind(background_traffic=BackgroundTraffic(count=8, start_time=7.0)),
        driven_on,
    ),
    "vehicles that join": (of_every_moved_kind(), joined),
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_traces_do_not_depend_on_when_sumo_is_told(name: str) -> None:
    what, drive = SCENES[name]
    hashes = set()
    for mirrored in (True, False):
        episode = begun(what, mirrored=mirrored)
        drive(episode)
        hashes.add(trace_sha256(episode.finish()))
    assert len(hashes) == 1
