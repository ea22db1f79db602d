"""What the actions of an adversary add: where, when, and whether at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivora_service.adversaries.adversary_vehicles import MANOEUVRES
from drivora_service.adversaries.intervening import SKIES, intervene
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.runs.adversary import ACTIONS, Action
from drivora_service.scenario.model import MapRegion, Region, Scenario, Weather
from drivora_service.scenario.validation import validate_data
from drivora_service.scenario.weather import weather_effects
from tests.adversaries.games import alone, decide, game, now
from tests.simulation.episodes import (
    ROAD,
    Blind,
    ego,
    network,
    obstacle,
    place,
    presence,
    scenario,
    speeds,
    start,
    track,
)

EXAMPLES = Path(__file__).parents[2] / "openscenario_schemas" / "examples"


def of_two_lanes(name: str) -> Scenario:
    """An ego on the right of two or more lanes, with a long way ahead."""
    net = network(name)
    lane = max(
        (one for one in net.lanes if one.drivable and one.left >= 0 and not one.is_internal),
        key=lambda one: one.length,
    )
    return scenario(
        ego(
            place(lane.id, 0.3 * lane.length, on=name),
            place(lane.id, lane.length - 5.0, on=name),
            initial_speed=10.0,
        ),
        on=name,
        seconds=20.0,
    )


def after(what: Scenario, action: Action, *, speed: float = 8.0) -> Trace:
    """The run of an ego that drives on regardless, with one action at the beginning."""
    playing = game(what, Blind(speed))
    assert decide(playing, action).intervention.has_effect
    return playing.finish()


def ahead(trace: Trace, row: int) -> float:
    """Metres from the ego to the added actor along the ego's heading."""
    mine, other = trace.states[row, 0], trace.states[row, -1]
    return float((other[0] - mine[0]) * np.cos(mine[2]) + (other[1] - mine[1]) * np.sin(mine[2]))


def aside(trace: Trace, row: int) -> float:
    """The same to the left of it."""
    mine, other = trace.states[row, 0], trace.states[row, -1]
    return float((other[1] - mine[1]) * np.cos(mine[2]) - (other[0] - mine[0]) * np.sin(mine[2]))


def test_a_vehicle_ahead_brakes_on_the_ego_s_lane() -> None:
    trace = after(alone(), Action.VEHICLE_BRAKES)
    first = int(np.argmax(presence(trace, "adversary:0")))
    assert first == 1
    assert 10.0 < ahead(trace, first) < 20.0
    assert abs(aside(trace, first)) < 0.5
    speed = speeds(trace, "adversary:0")
    assert speed[first] == pytest.approx(8.0, abs=0.5)
    assert np.nanmin(speed) < 1.0


def test_a_vehicle_that_stands_leaves_again() -> None:
    playing = game(alone(seconds=60.0, speed=0.0), interval=40.0)
    decide(playing, Action.VEHICLE_STANDS)
    there = presence(playing.finish(), "adversary:0")
    assert 15.0 < there.sum() * 0.05 < 30.0


def test_a_vehicle_cuts_in_from_the_left() -> None:
    trace = after(of_two_lanes("arterial"), Action.VEHICLE_CUTS_IN_LEFT)
    first = int(np.argmax(presence(trace, "adversary:0")))
    assert 6.0 < ahead(trace, first) < 12.0
    assert 2.5 < aside(trace, first) < 4.5
    # Its braking is met by an ego that drives on regardless.
    assert trace.ego_ends == (TerminalEvent.COLLISION,)
    last = trace.ego_end_steps[0]
    assert abs(aside(trace, last)) < 0.6
    assert 0.0 < ahead(trace, last) < 6.0


def test_a_vehicle_cuts_in_only_from_a_lane_that_there_is() -> None:
    for action in (Action.VEHICLE_CUTS_IN_LEFT, Action.VEHICLE_CUTS_IN_RIGHT):
        playing = game(alone(), Blind())
        assert not decide(playing, action).intervention.has_effect
        assert len(playing.finish().actors) == 1


def test_a_vehicle_crosses_the_ego_s_route_when_the_ego_is_there() -> None:
    data = (EXAMPLES / "signalised-grid.json").read_bytes()
    what = validate_data(data, NetworkCatalogue(shipped_networks()), None).scenario
    what = replace(what, background_traffic=None, npc_vehicles=(), npc_walkers=())
    playing = game(what, Blind(8.0), interval=15.0)
    assert decide(playing, Action.VEHICLE_CROSSES).intervention.has_effect
    trace = playing.finish()
    both = np.flatnonzero(presence(trace, "adversary:0") & trace.present[:, 0])
    gaps = np.hypot(*(trace.states[both, 0, :2] - trace.states[both, -1, :2]).T)
    assert gaps.min() < 12.0
    nearest = both[np.argmin(gaps)]
    assert np.cos(trace.states[nearest, 0, 2] - trace.states[nearest, -1, 2]) < 0.9


@pytest.mark.parametrize(
    ("action", "side"),
    [
        (Action.WALKER_RIGHT, -1.0),
        (Action.WALKER_LEFT, 1.0),
        (Action.RUNNER_RIGHT, -1.0),
        (Action.RUNNER_LEFT, 1.0),
    ],
)
def test_a_walker_crosses_where_the_ego_will_be(action: Action, side: float) -> None:
    trace = after(alone(), action)
    first = int(np.argmax(presence(trace, "adversary:0")))
    assert ahead(trace, first) > 6.0
    assert 2.0 < side * aside(trace, first) < 8.0
    mine, other = track(trace, "ego"), track(trace, "adversary:0")
    gaps = np.hypot(*(mine - other).T)
    assert np.nanmin(gaps) < 3.0
    limit = 1.5 if action in (Action.WALKER_LEFT, Action.WALKER_RIGHT) else 3.1
    assert np.nanmax(speeds(trace, "adversary:0")) <= limit


@pytest.mark.parametrize("action", SKIES)
def test_the_sky_changes_what_it_names_and_only_once(action: Action) -> None:
    weather = Weather(
        precipitation=5.0, wetness=5.0, fog_density=5.0, sun_altitude_angle=30.0,
        wind_intensity=9.0,
    )  # fmt: skip
    playing = game(alone(weather=weather), Blind())
    done = decide(playing, action).intervention
    assert set(done.weather.items()) <= set(SKIES[action].items())
    assert done.weather
    (change,) = playing.scenario.weather_changes
    assert change.time == 0.0
    for name, value in SKIES[action].items():
        assert getattr(change.weather, name) == value
    assert change.weather.wind_intensity == 9.0
    assert not decide(playing, action).intervention.has_effect
    assert len(playing.scenario.weather_changes) == 1


def test_the_skies_differ_in_what_they_do() -> None:
    fine = weather_effects(Weather())
    for action, worse in (
        (Action.HEAVY_RAIN, "friction"),
        (Action.LIGHT_RAIN, "friction"),
        (Action.FOG, "perception_range"),
        (Action.NIGHT, "perception_range"),
        (Action.DUSK, "perception_range"),
    ):
        effects = weather_effects(Weather(**SKIES[action]))
        assert getattr(effects, worse) < getattr(fine, worse), action


def test_no_actor_appears_in_another() -> None:
    spot = 5.0 + 8.0 * 2.5 + 12.0
    what = alone(npc_obstacles=(obstacle(place(ROAD, spot)),))
    playing = game(what)
    assert not decide(playing, Action.VEHICLE_STANDS).intervention.has_effect
    assert decide(game(alone()), Action.VEHICLE_STANDS).intervention.has_effect


def test_no_actor_appears_outside_the_region() -> None:
    first, last = place(ROAD, 5), place(ROAD, 120)
    region = Region(
        min_x=min(first.x, last.x) - 1.5, max_x=max(first.x, last.x) + 1.5,
        min_y=min(first.y, last.y) - 1.5, max_y=max(first.y, last.y) + 1.5,
    )  # fmt: skip
    what = alone(map_region=MapRegion(town="tee-town", region_segment=region))
    inside = [action for action in ACTIONS if decide(game(what), action).intervention.actors]
    anywhere = [action for action in ACTIONS if decide(game(alone()), action).intervention.actors]
    assert set(inside) < set(anywhere)
    for action in inside:
        playing = game(what, Blind())
        decide(playing, action)
        vehicles, walkers = playing.scenario.npc_vehicles, playing.scenario.npc_walkers
        routes = [one.route for one in vehicles] + [one.route for one in walkers]
        for point in (point for route in routes for point in route):
            assert region.min_x <= point.x <= region.max_x
            assert region.min_y <= point.y <= region.max_y


@pytest.mark.parametrize("action", MANOEUVRES)
def test_nothing_is_added_beyond_the_end_of_the_route(action: Action) -> None:
    what = scenario(ego(place(ROAD, 5), place(ROAD, 12)), seconds=10.0)
    episode = start(what, Blind())
    done = intervene(episode, now(episode), action)
    assert not done.has_effect
    assert episode.scenario is what


def test_vehicles_are_on_lanes() -> None:
    what = of_two_lanes("arterial")
    for action in MANOEUVRES:
        playing = game(what, Blind())
        decide(playing, action)
        for vehicle in playing.scenario.npc_vehicles:
            for point in vehicle.route:
                near = nearest_lane_position(network("arterial"), point.x, point.y)
                assert near is not None
                assert abs(near.lateral) < 2.0
