"""Vehicles that SUMO is not told of, by looking into SUMO itself."""

from __future__ import annotations

import math
from dataclasses import replace

import libsumo
import pytest

from benchmarks.scenes import crowd_scene
from drivora_service.agents.interface import AccelerationControl
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import SimulatorError
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import (
    AgentChoice,
    BackgroundTraffic,
    NpcBehavior,
    Scenario,
    Weather,
)
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.traffic.holding import look_ahead_is_bounded, reach_of
from tests.simulation.episodes import Scripted, car, network, place, start, walker

LATE = 6.0


def crowd(seconds: float = 20.0, *, driven: int = 1, late: bool = False) -> Scenario:
    """Vehicles all over the highway, of which SUMO drives the first ones."""
    scene = crowd_scene(network("highway"), npcs=14, seconds=seconds)
    npcs = tuple(
        replace(
            npc,
            behavior=NpcBehavior.SUMO if number < driven else npc.behavior,
            start_time=LATE if late and number < driven else 0.0,
        )
        for number, npc in enumerate(scene.npc_vehicles)
    )
    return replace(scene, npc_vehicles=npcs)


def lanes_in_sumo() -> dict[str, str]:
    return {name: libsumo.vehicle.getLaneID(name) for name in libsumo.vehicle.getIDList()}


def held(episode: Episode) -> set[str]:
    return {actor.id for actor in episode._traffic._moved_list if actor.held}


def test_vehicles_far_from_what_sumo_drives_are_held_on_their_lanes() -> None:
    scene = crowd()
    expected = []
    episode = start(scene)
    while not episode.done:
        expected.append(lanes_in_sumo())
        episode.step()
    placed = trace_sha256(episode.finish())
    episode, ever = start(scene, holding=True), set[str]()
    for lanes in expected:
        assert lanes_in_sumo() == lanes
        ever |= held(episode)
        episode.step()
    assert len(ever) > 3
    assert "npc0" not in ever
    assert trace_sha256(episode.finish()) == placed


def test_what_is_near_a_vehicle_of_sumo_is_at_its_place_and_what_is_held_is_far() -> None:
    scene = crowd(30.0, driven=2)
    town = network("highway")
    episode = start(scene, holding=True)
    reach = reach_of(town, 1.0)
    while not episode.done:
        episode.step()
        look = episode.look()
        actors = {actor.id: actor for actor in look.actors}
        driven = [actors[name] for name in ("npc0", "npc1") if name in actors]
        for name in held(episode):
            x, y = libsumo.vehicle.getPosition(name)
            for one in driven:
                # One step of the vehicle of SUMO, and half the length of the held one.
                assert math.hypot(x - one.x, y - one.y) > reach - 6.0


@pytest.mark.parametrize(
    "scene",
    [
        crowd(driven=3),
        crowd(late=True),
        replace(crowd(late=True, driven=2), weather=Weather(wetness=80.0)),
        replace(crowd(), background_traffic=BackgroundTraffic(count=4, start_time=3.0)),
        replace(
            crowd(),
            ego_vehicles=(replace(crowd().ego_vehicles[0], agent=AgentChoice(name="sumo-krauss")),),
        ),
        replace(
            crowd(),
            ego_vehicles=(replace(crowd().ego_vehicles[0], agent=AgentChoice(name="sumo-idm")),),
        ),
    ],
    ids=["three", "late", "late and wet", "background", "ego of SUMO", "far-sighted ego"],
)
def test_traces_do_not_depend_on_holding(scene: Scenario) -> None:
    hashes = set()
    for holding in (False, True):
        episode = start(scene, holding=holding)
        while not episode.done:
            episode.step()
        hashes.add(trace_sha256(episode.finish()))
    assert len(hashes) == 1


def test_an_ego_that_stops_far_away_is_at_its_place_again() -> None:
    scene = crowd()

    def brakes() -> Scripted:
        return Scripted(lambda seen: AccelerationControl(-3.0 if seen.time > 6.0 else 1.0, 0.0))

    episode, was_held = start(scene, brakes(), holding=True), False
    while not episode.done:
        episode.step()
        was_held |= "ego_0" in held(episode)
    ego = next(actor for actor in episode.look().actors if actor.id == "ego_0")
    assert was_held
    assert "ego_0" not in held(episode)
    x, y = libsumo.vehicle.getPosition("ego_0")
    front = 0.5 * ego.length
    assert math.hypot(
        x - ego.x - front * math.cos(ego.yaw), y - ego.y - front * math.sin(ego.yaw)
    ) == pytest.approx(0.0, abs=0.05)


def test_nothing_is_held_without_being_asked_for_or_beside_background_traffic() -> None:
    background = replace(crowd(5.0), background_traffic=BackgroundTraffic(count=2))
    for scene, holding in ((crowd(5.0), False), (background, True)):
        episode = start(scene, holding=holding)
        while not episode.done:
            episode.step()
            assert not held(episode)


def test_a_run_in_which_vehicles_are_held_is_only_stepped() -> None:
    episode = start(crowd(), holding=True)
    here = place("eb_1_1", 20, on="highway", speed=8.0)
    there = place("eb_1_1", 90, on="highway", speed=8.0)
    with pytest.raises(SimulatorError, match="holding"):
        episode.add_vehicle(car(here, there))
    with pytest.raises(SimulatorError, match="holding"):
        episode.add_walker(walker(here, there))
    with pytest.raises(SimulatorError, match="holding"):
        episode.catch_up_sumo()


def test_the_reach_grows_with_speed_limits_and_on_slippery_roads() -> None:
    assert reach_of(network("highway"), 1.0) > reach_of(network("signal-grid"), 1.0) > 100.0
    assert reach_of(network("highway"), 0.2) > reach_of(network("highway"), 1.0)


def test_only_drivers_that_see_a_bounded_way_allow_it() -> None:
    assert look_ahead_is_bounded([object(), SumoDriver(car_following="krauss")])
    for model in ("idm", "eidm", "acc", "cacc"):
        assert not look_ahead_is_bounded([SumoDriver(car_following=model)])
