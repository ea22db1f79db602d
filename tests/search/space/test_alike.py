"""Candidates that decode to scenarios which cannot be told apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.model import Scenario, Weather
from drivora_service.scenario.weather import weather_effects
from drivora_service.search.mutation import GaussianMutation, RedrawBlock, RedrawSlice
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from tests.search.space.seeds import block_named, drawn, space_around

SPACES = {
    "one ego": lambda: space_around(
        "tee-town", SpaceOptions(vehicles=4, walkers=2, obstacles=2, lights=True)
    ),
    "egos": lambda: space_around("old-town", SpaceOptions(egos=4, vehicles=3, optional=True)),
    "grid": lambda: space_around("signal-grid", SpaceOptions(vehicles=5, optional=True)),
}


def text_of(space: ScenarioSpace, scenario: Scenario) -> str:
    """The scenario with nothing of the weather but its effects."""
    clear = replace(scenario, weather=Weather())
    return f"{canonical_json(clear)} {weather_effects(scenario.weather)}"


@pytest.mark.parametrize("name", sorted(SPACES))
def test_it_agrees_with_repairing_and_decoding_the_whole(name: str) -> None:
    space = SPACES[name]()
    random = np.random.default_rng(8)
    alike = different = 0
    for number in range(6):
        parent = drawn(space, number)
        whole = text_of(space, space.scenario(parent))
        for mutation in (RedrawSlice(), GaussianMutation(), RedrawBlock()):
            for _ in range(25):
                values = mutation.mutate(parent, space.genes, random)
                same = text_of(space, space.scenario(space.repair(values))) == whole
                found = space.decode_alike(parent, values)
                # Repairing may also bring a mutant back to its parent: that is not found.
                assert same or not found
                alike += found
                different += not same
    assert alike > 5
    assert different > 100


def test_a_lane_that_is_not_there_and_clouds_at_noon_have_no_effect() -> None:
    space = SPACES["one ego"]()
    values = drawn(space, 3)
    sky = block_named(space, "weather")
    values[sky.index("sun_altitude_angle")] = 80.0
    cloudy = values.copy()
    cloudy[sky.index("cloudiness")] = 100.0 - values[sky.index("cloudiness")]
    assert space.decode_alike(values, cloudy)
    foggy = values.copy()
    foggy[sky.index("fog_density")] = 85.0 - values[sky.index("fog_density")]
    assert not space.decode_alike(values, foggy)


def test_a_start_that_differs_by_less_than_a_document_tells_is_another() -> None:
    """Repairing compares exact places."""
    space = SPACES["one ego"]()
    values = drawn(space, 3)
    moved = values.copy()
    start = block_named(space, "vehicle_0").index("start")
    moved[start] += 1e-9 if values[start] < 0.5 else -1e-9
    same = space.scenario(moved).npc_vehicles == space.scenario(values).npc_vehicles
    assert same
    assert not space.decode_alike(values, moved)
