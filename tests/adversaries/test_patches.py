"""An adversary acts on a road with slippery patches, whose grip counts with that of its weather."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.adversaries.playing import play
from drivora_service.agents.interface import AccelerationControl
from drivora_service.observations.recorded_conditions import frictions_under, road_frictions
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.avoidability.assess import assess
from drivora_service.runs.adversary import EXTENSION, Action
from drivora_service.scenario.model import FrictionPatch, Scenario
from drivora_service.scenario.weather import weather_effects
from drivora_service.simulation.episode import Episode
from tests.adversaries.games import alone, decide, game
from tests.adversaries.test_game import RANDOM, check_replay
from tests.simulation.episodes import ROAD, Blind, Scripted, network, place, row_of, speeds, start

ICE = FrictionPatch(id="ice", location=place(ROAD, 70), length=60.0, width=8.0, friction=0.15)


def icy(what: Scenario) -> Scenario:
    return replace(what, friction_patches=(ICE,))


@pytest.mark.parametrize("seed", range(3))
def test_what_was_played_on_patches_is_replayed_without_the_adversary(seed: int) -> None:
    played = play(start(icy(alone())), replace(RANDOM, seed=seed, interval=2.0))
    assert len(played.scenario.extensions[EXTENSION]) >= 2
    assert played.scenario.friction_patches == (ICE,)
    check_replay(played)


def _played(what: Scenario, *actions: Action) -> tuple[Episode, Trace]:
    """A game with the actions two seconds apart, until its ego's part ends."""
    playing = game(what, Blind(8.0), interval=2.0)
    for action in actions:
        decide(playing, action)
    while not playing.is_over:
        decide(playing, Action.NOTHING)
    return playing.episode, playing.finish()


def test_rain_of_the_adversary_and_a_patch_count_together() -> None:
    episode, trace = _played(icy(alone()), Action.NOTHING, Action.HEAVY_RAIN)
    wet = weather_effects(episode.weather).friction
    assert ICE.friction < wet < 1.0
    row = row_of(trace, "ego")
    there = trace.present[:, row]
    last = int(np.flatnonzero(there)[-1])
    under = frictions_under(trace, trace.actors[row], 0, trace.states[: last + 1, row])
    road = road_frictions(trace, 0, last + 1)
    assert set(road.tolist()) == {1.0, wet}
    assert (road[:40] == 1.0).all()
    assert (road[40:] == wet).all()
    away = np.hypot(*(trace.states[: last + 1, row, :2] - (ICE.location.x, ICE.location.y)).T)
    assert (under[away < 28.0] == ICE.friction).all()
    beside = away > 32.0
    assert np.array_equal(under[beside], road[beside])


def test_a_vehicle_of_the_adversary_brakes_by_the_grip_of_the_patch() -> None:
    """It appears ahead and brakes: on ice by no more than that allows."""

    def hardest(what: Scenario) -> float:
        playing = game(what, Scripted(lambda seen: AccelerationControl(0.0, 0.0)), interval=1.0)
        done = decide(playing, Action.NOTHING)
        done = decide(playing, Action.VEHICLE_BRAKES)
        (added,) = done.intervention.actors
        while not playing.is_over:
            decide(playing, Action.NOTHING)
        trace = playing.finish()
        return float(-np.nanmin(np.diff(speeds(trace, added))) / trace.step_length)

    everywhere = replace(alone(), friction_patches=(replace(ICE, length=400.0, width=400.0),))
    assert hardest(everywhere) <= ICE.friction * 9.81 + 0.02
    assert hardest(alone()) > 2.0 * ICE.friction * 9.81


def test_a_collision_that_the_adversary_causes_is_assessed_by_the_grip_of_place_and_time() -> None:
    def evidence(what: Scenario, *actions: Action) -> float:
        _, trace = _played(what, Action.NOTHING, *actions, Action.VEHICLE_STANDS)
        (contact,) = [one for one in trace.contacts if one.ego == 0][:1]
        ego = RunView(trace, network()).egos[0]
        found = assess(ego, contact.step - ego.first, contact.other)
        return float(found.evidence["friction"])

    wide = replace(alone(), friction_patches=(replace(ICE, length=400.0, width=400.0),))
    damp = replace(wide, friction_patches=(replace(ICE, length=400.0, width=400.0, friction=0.9),))
    assert evidence(alone()) == 1.0
    assert evidence(wide) == ICE.friction
    assert evidence(wide, Action.HEAVY_RAIN) == ICE.friction
    assert evidence(damp) == 0.9
    assert evidence(damp, Action.HEAVY_RAIN) < 0.9
