"""Weather and lights from genes."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.scenario.model import LightTimes, TrafficLights, Weather
from drivora_service.scenario.weather import weather_effects
from drivora_service.search.genes import Part
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.simulation.plans.light_programs import run_programs
from tests.search.space.seeds import NETWORKS, block_named, drawn, seed_scenario, space_around

CONDITIONS = SpaceOptions(vehicles=0, walkers=0, weather=True, lights=True)


@settings(max_examples=30)
@given(number=st.integers(0, 2**32 - 1))
def test_every_weather_can_be_driven_in(number: int) -> None:
    space = space_around("tee-town", CONDITIONS)
    effects = weather_effects(space.scenario(drawn(space, number)).weather)
    assert effects.friction >= 0.7
    # From 50 km/h, after a second, with all the grip that there is.
    speed = 50.0 / 3.6
    assert effects.perception_range > speed + speed**2 / (2.0 * 9.81 * effects.friction)


def test_the_genes_are_the_fields_of_the_weather_and_the_rest_is_the_seeds() -> None:
    seed = replace(
        seed_scenario("tee-town"), weather=Weather(wind_intensity=30.0, fog_distance=5.0)
    )
    space = ScenarioSpace(seed, NETWORKS.get("tee-town"), CONDITIONS)
    values = drawn(space, 2)
    block = block_named(space, "weather")
    weather = space.scenario(values).weather
    for gene in block.genes:
        assert getattr(weather, gene.name) == values[block.index(gene.name)]
    assert (weather.wind_intensity, weather.fog_distance) == (30.0, 5.0)


def test_lights_vary_only_where_there_are_any() -> None:
    assert space_around("tee-town", CONDITIONS).genes.of(Part.LIGHTS)
    assert not space_around("highway", CONDITIONS).genes.of(Part.LIGHTS)


def test_all_greens_last_as_the_gene_says() -> None:
    space = space_around("tee-town", CONDITIONS)
    values = drawn(space, 3)
    values[block_named(space, "lights").index("green")] = 12.0
    values[block_named(space, "lights").index("offset")] = 7.0
    lights = space.scenario(values).traffic_lights
    for program in run_programs(space.network.programs, lights):
        assert program.offset == 7.0
        greens = [p.duration for p in program.phases if set(p.state) & set("Gg")]
        greens = [duration for duration in greens if duration not in (3.0, 4.0)]
        assert greens == pytest.approx([12.0] * len(greens))


def test_a_junction_keeps_the_times_that_the_seed_gives_it() -> None:
    seed = seed_scenario("tee-town")
    name = sorted(NETWORKS.get("tee-town").programs)[0]
    lights = TrafficLights(
        times=LightTimes(yellow=4.0), junctions={name: LightTimes(green=20.0, yellow=4.0)}
    )
    space = ScenarioSpace(
        replace(seed, traffic_lights=lights), NETWORKS.get("tee-town"), CONDITIONS
    )
    values = drawn(space, 3)
    found = space.scenario(values).traffic_lights
    offset = values[block_named(space, "lights").index("offset")]
    assert found.times.yellow == 4.0
    assert found.junctions[name] == LightTimes(green=20.0, yellow=4.0, offset=offset)
