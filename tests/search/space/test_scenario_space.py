"""Scenarios decoded from genes: valid, within the options, and the same each time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.scenario.canonical import canonical_json
from drivora_service.search.space.options import SpaceOptions
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.validity import find_problems
from tests.search.space.seeds import NETWORKS, SHIPPED, seed_scenario

OPTIONS = SpaceOptions(vehicles=3, walkers=1, obstacles=1, lights=True)


@pytest.fixture(scope="module", params=SHIPPED)
def space(request: pytest.FixtureRequest) -> ScenarioSpace:
    seed = seed_scenario(request.param)
    return ScenarioSpace(seed, NETWORKS.get(request.param), OPTIONS)


def test_hardly_any_repaired_sample_is_invalid(space: ScenarioSpace) -> None:
    samples = space.genes.sample(np.random.default_rng(3), 60)
    found = [
        find_problems(space.scenario(space.repair(values)), NETWORKS, ["idm"]) for values in samples
    ]
    assert not [problems for problems in found if problems]


@settings(max_examples=15)
@given(number=st.integers(0, 2**32 - 1))
def test_repaired_values_are_within_the_bounds_and_stay(space: ScenarioSpace, number: int) -> None:
    values = space.genes.sample(np.random.default_rng(number)) * 1.3
    repaired = space.repair(values)
    assert space.genes.within(repaired)
    assert np.array_equal(space.repair(repaired), repaired)


def test_the_same_seed_gives_the_same_space(space: ScenarioSpace) -> None:
    again = ScenarioSpace(space.seed, space.network, OPTIONS)
    assert again.genes.blocks == space.genes.blocks
    values = space.repair(space.genes.sample(np.random.default_rng(9)))
    assert np.array_equal(again.repair(values), values)
    assert canonical_json(again.scenario(values)) == canonical_json(space.scenario(values))
