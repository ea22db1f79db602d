"""What is added to a running episode is written down so that a run of it is the same run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivora_service.errors import SimulatorError
from drivora_service.observations.recorded_conditions import perception_ranges, road_frictions
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.canonical import canonical_json, from_canonical, scenario_sha256
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import (
    BackgroundTraffic,
    Scenario,
    VehicleDynamics,
    Weather,
    WeatherChange,
)
from drivora_service.scenario.validation import validate_document
from drivora_service.scenario.weather import weather_effects
from drivora_service.simulation.episode import Episode
from drivora_service.simulation.episode_changes import (
    NEVER,
    Changes,
    change_step,
    changes_anything,
    join_step,
    joining_actors,
)
from drivora_service.simulation.perception.perceived_again import perceive_again
from tests.scenario.conftest import AGENTS
from tests.simulation.episodes import (
    ROAD,
    Blind,
    Scripted,
    car,
    ego,
    network,
    obstacle,
    place,
    presence,
    run,
    scenario,
    speeds,
    standing,
    start,
    walker,
)
from tests.simulation.perception.test_perceived_again import FOG, check, recorded, several_egos

RAIN = Weather(precipitation=100.0, wetness=100.0, precipitation_deposits=100.0)
WIND = Weather(wind_intensity=100.0)

Act = Callable[[Episode], None]


def busy(weather: Weather) -> Scenario:
    """All kinds of actors, so that rows, random draws and SUMO's calls could be mixed up."""
    return scenario(
        ego(place(ROAD, 5), place(ROAD, 118), initial_speed=6.0),
        npc_vehicles=(
            car(place(ROAD, 30, speed=5.0), place(ROAD, 120, speed=5.0), name="ahead"),
            car(
                place("harbour_0_0", 60, speed=8.0), place(ROAD, 120, speed=8.0), name="driven",
                behavior="sumo", start_time=1.0,
            ),
        ),
        npc_walkers=(walker(place(ROAD, 90, right=6.0, speed=1.5), place(ROAD, 90, right=-6.0)),),
        npc_obstacles=(obstacle(place(ROAD, 100, right=4.0), start_time=3.0),),
        background_traffic=BackgroundTraffic(count=6),
        weather=weather,
        seconds=14.0,
        seed=11,
    )  # fmt: skip


def interfere(episode: Episode) -> None:
    """Adds actors of all kinds, some for later and in one step, and changes the weather."""
    while not episode.done:
        step = episode.look().step
        if step == 40:
            # A walker first: its row is nevertheless behind that of the vehicle.
            episode.add_walker(walker(place(ROAD, 60, right=3.0), name="added-walker"))
            episode.add_vehicle(
                car(place(ROAD, 60, right=-3.0, speed=4.0), place(ROAD, 110, speed=4.0), name="one")
            )
            episode.add_vehicle(
                car(
                    place("harbour_0_0", 20, speed=8.0), place(ROAD, 120), name="driven-later",
                    behavior="sumo", start_time=5.0,
                )
            )  # fmt: skip
        if step == 80:
            episode.change_weather(RAIN)
        if step == 100:
            episode.add_walker(
                walker(
                    place(ROAD, 80, right=3.0), place(ROAD, 80, right=-9.0), name="in-one-step",
                    start_time=6.0,
                )
            )  # fmt: skip
            episode.add_vehicle(
                car(
                    place(ROAD, 2, speed=9.0), place(ROAD, 120, speed=9.0), name="behind",
                    behavior="replay", start_time=6.0,
                )
            )  # fmt: skip
        if step == 160:
            episode.change_weather(FOG)
        episode.step()


@pytest.mark.parametrize("weather", [Weather(), FOG], ids=["clear", "fog"])
def test_the_scenario_of_a_run_with_additions_is_the_same_run(weather: Weather) -> None:
    what = busy(weather)
    episode = start(what)
    interfere(episode)
    live = episode.finish()
    told = episode.scenario
    again = run(from_canonical(canonical_json(told)))
    assert trace_sha256(again) == trace_sha256(live)
    assert live.scenario_sha256 == scenario_sha256(told) != scenario_sha256(what)
    # What was added made a difference, and came in the order that is written down.
    plain = run(what)
    assert not np.array_equal(plain.states[-1, 0], live.states[plain.step_count - 1, 0])
    added = ("one", "added-walker", "driven-later", "behind", "in-one-step")
    assert tuple(a.id for a in live.actors[-5:]) == added
    # SUMO lets a vehicle in when there is room.
    for name, first in (("one", 41), ("added-walker", 41), ("behind", 120), ("in-one-step", 120)):
        assert int(np.argmax(presence(live, name))) == first


def test_a_run_for_workers_is_the_same_although_it_may_hold_actors() -> None:
    episode = start(busy(Weather()))
    interfere(episode)
    held = start(episode.scenario, holding=True)
    while not held.done:
        held.step()
    assert trace_sha256(held.finish()) == trace_sha256(episode.finish())


def test_the_document_of_a_run_with_additions_is_valid_and_the_same_run() -> None:
    episode = start(busy(Weather()))
    interfere(episode)
    document = to_document(episode.scenario)
    valid = validate_document(document, _Networks(), AGENTS)
    assert trace_sha256(run(valid.scenario)) == trace_sha256(episode.finish())


class _Networks:
    def names(self) -> tuple[str, ...]:
        return ("tee-town",)

    def get(self, name: str):  # type: ignore[no-untyped-def]  # as the catalogue has it
        return network(name)


def test_an_actor_that_is_only_late_has_its_row_among_the_others() -> None:
    late = car(place(ROAD, 60, right=-3.0), name="late", start_time=2.0)
    joins = replace(late, joins=True)
    for actor, row in ((late, 1), (joins, 3)):
        what = scenario(
            ego(place(ROAD, 20), place(ROAD, 120)),
            npc_vehicles=(actor, car(place(ROAD, 100))),
            npc_walkers=(walker(place(ROAD, 90, right=5.0)),),
            seconds=3.0,
        )
        trace = run(what)
        assert [a.id for a in trace.actors].index("late") == row
        assert presence(trace, "late").tolist() == [False] * 40 + [True] * 21


def test_what_an_ego_perceived_with_additions_is_computed_again(tmp_path: Path) -> None:
    what = several_egos(Weather())
    what = replace(
        what,
        npc_vehicles=(
            *what.npc_vehicles,
            car(place(ROAD, 60, right=-3.0), name="joins", start_time=3.0, joins=True),
            car(place(ROAD, 50, right=-3.0), name="never", start_time=300.0, joins=True),
        ),
        weather_changes=(
            WeatherChange(time=2.0, weather=FOG),
            WeatherChange(time=6.0, weather=Weather()),
            WeatherChange(time=8.0, weather=FOG),
        ),
    )
    trace, witnesses = recorded(what, tmp_path / "run.parquet")
    assert "never" not in {actor.id for actor in trace.actors}
    for row, witness in enumerate(witnesses):
        check(perceive_again(what, EgoView(trace, network(), row)), witness)
    with pytest.raises(AssertionError):
        check(
            perceive_again(
                replace(what, weather_changes=what.weather_changes[:1]),
                EgoView(trace, network(), 0),
            ),
            witnesses[0],
        )


def test_weather_changes_the_grip_and_the_wind_at_its_time() -> None:
    def braking_from(weather: Weather) -> float:
        """Metres driven until standstill, braking fully from 15 m/s after 0.5 s."""
        what = scenario(ego(place(ROAD, 5), place(ROAD, 118), initial_speed=15.0), seconds=8.0)
        what = replace(what, weather_changes=(WeatherChange(time=0.5, weather=weather),))
        trace = run(what, Scripted(lambda seen: _braking(seen.time)))
        assert speeds(trace, "ego")[-1] == 0.0
        return float(np.nansum(speeds(trace, "ego")) * trace.step_length)

    dry, wet = braking_from(Weather()), braking_from(RAIN)
    grip = 9.81 * weather_effects(RAIN).friction
    assert grip == pytest.approx(0.4 * 9.81)
    assert wet - 7.5 == pytest.approx(15.0**2 / 2.0 / grip, abs=1.5)
    assert dry < 0.7 * wet


def _braking(time: float):  # type: ignore[no-untyped-def]  # a control
    from drivora_service.agents.interface import AccelerationControl

    return AccelerationControl(0.0 if time < 0.5 - 1e-9 else -9.0, 0.0)


def test_wind_of_a_later_weather_pushes_an_ego_aside_from_then_on() -> None:
    what = scenario(ego(place(ROAD, 5), place(ROAD, 118), initial_speed=10.0), seconds=4.0)
    what = replace(
        what,
        ego_vehicles=(replace(what.ego_vehicles[0], dynamics=VehicleDynamics.DYNAMIC),),
    )
    changed = replace(what, weather_changes=(WeatherChange(time=2.0, weather=WIND),))
    calm, windy = (run(one, Scripted(lambda seen: _braking(0.0))) for one in (what, changed))
    assert np.array_equal(calm.states[:41, 0], windy.states[:41, 0])
    assert not np.array_equal(calm.states[42:, 0], windy.states[42:, 0])


def test_a_trace_tells_the_conditions_at_every_row() -> None:
    what = scenario(ego(place(ROAD, 5), place(ROAD, 118)), seconds=3.0)
    what = replace(
        what,
        weather_changes=(
            WeatherChange(time=1.0, weather=RAIN),
            WeatherChange(time=2.0, weather=FOG),
            WeatherChange(time=9.0, weather=RAIN),
        ),
    )
    trace = run(what, standing())
    wet = weather_effects(RAIN).friction
    assert road_frictions(trace, 0, 61).tolist() == [1.0] * 20 + [wet] * 20 + [1.0] * 21
    assert road_frictions(trace, 30, 20).tolist() == [wet] * 10 + [1.0] * 10
    ranges = perception_ranges(trace, 0, 61)
    assert ranges[19] == 150.0
    assert ranges[40] == weather_effects(FOG).perception_range < 100.0
    del trace.meta["friction"], trace.meta["weather_changes"]
    assert np.isnan(road_frictions(trace, 0, 3)).all()


def test_a_scenario_without_changes_has_no_trace_of_them() -> None:
    what = scenario(ego(place(ROAD, 5), place(ROAD, 118)), seconds=1.0)
    trace = run(what, standing())
    assert "weather_changes" not in trace.meta
    assert not changes_anything(what)
    assert start(what, standing()).scenario is what


def test_the_weather_of_one_time_is_set_once() -> None:
    episode = start(scenario(ego(place(ROAD, 5), place(ROAD, 118)), seconds=2.0), standing())
    for _ in range(10):
        episode.step()
    episode.change_weather(RAIN)
    episode.change_weather(FOG)
    assert episode.scenario.weather_changes == (WeatherChange(time=0.5, weather=FOG),)
    episode.step()
    episode.change_weather(RAIN)
    assert [change.time for change in episode.scenario.weather_changes] == [
        0.5, pytest.approx(0.55),
    ]  # fmt: skip


def test_nothing_changes_after_the_end_or_while_actors_are_held() -> None:
    what = scenario(ego(place(ROAD, 5), place(ROAD, 118)), seconds=0.05)
    episode = start(what, standing())
    episode.step()
    with pytest.raises(SimulatorError, match="ended"):
        episode.change_weather(RAIN)
    with pytest.raises(SimulatorError, match="holding"):
        start(what, standing(), holding=True).change_weather(RAIN)


def test_the_id_of_an_actor_that_is_still_to_join_is_taken() -> None:
    episode = start(scenario(ego(place(ROAD, 5), place(ROAD, 118))), Blind())
    episode.add_walker(walker(place(ROAD, 80, right=5.0), start_time=60.0))
    with pytest.raises(SimulatorError, match="'walker'"):
        episode.add_vehicle(car(place(ROAD, 80), name="walker"))


@pytest.mark.parametrize(
    ("time", "joins", "changes"),
    [(0.0, 0, 0), (0.05, 0, 1), (0.06, 1, 2), (0.1, 1, 2), (0.15000000000000002, 2, 3)],
)
def test_steps_of_times(time: float, joins: int, changes: int) -> None:
    assert join_step(time, 0.05) == joins
    assert change_step(time, 0.05) == changes


def test_actors_of_one_step_join_in_the_order_of_the_document() -> None:
    what = scenario(
        ego(place(ROAD, 5), place(ROAD, 118)),
        npc_vehicles=tuple(
            car(place(ROAD, 80), name=name, start_time=time, joins=joins)
            for name, time, joins in (("b", 1.0, True), ("x", 0.5, False), ("a", 1.0, True))
        ),
        npc_walkers=(
            walker(place(ROAD, 80), name="first", start_time=0.5, joins=True),
            walker(place(ROAD, 80), name="c", start_time=1.0, joins=True),
        ),
    )
    assert [(step, a.id) for step, a in joining_actors(what)] == [
        (9, "first"), (19, "b"), (19, "a"), (19, "c"),
    ]  # fmt: skip
    changes = Changes(what)
    assert changes.next_step == 9
    assert [a.id for a in changes.take(9).joining] == ["first"]
    assert changes.next_step == 19
    assert [a.id for a in changes.take(19).joining] == ["b", "a", "c"]
    assert changes.next_step == NEVER
