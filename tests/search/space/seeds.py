"""Seed scenarios, and spaces around them."""

from __future__ import annotations

import functools

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from drivora_service.search.genes import Block
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions

NETWORKS = NetworkCatalogue(shipped_networks())
SHIPPED = NETWORKS.names()
DEFAULT = SpaceOptions()


@functools.lru_cache(maxsize=64)
def seed_scenario(town: str, number: int = 0, networks: NetworkCatalogue = NETWORKS) -> Scenario:
    """One ego on a route of 150 to 250 m."""
    documents = generate_seeds(
        networks.get(town),
        count=number + 1,
        min_length=150.0,
        max_length=250.0,
        seed=1,
        agent="idm",
    )
    return validate_document(list(documents)[number], networks, ["idm"]).scenario


@functools.lru_cache(maxsize=64)
def space_around(
    town: str,
    options: SpaceOptions = DEFAULT,
    number: int = 0,
    networks: NetworkCatalogue = NETWORKS,
) -> ScenarioSpace:
    """The space around a seed scenario."""
    seed = seed_scenario(town, number, networks)
    return ScenarioSpace(seed, networks.get(town), options)


def drawn(space: ScenarioSpace, number: int) -> FloatArray:
    """Repaired values, drawn with a generator of that seed."""
    return space.repair(space.genes.sample(np.random.default_rng(number)))


def block_named(space: ScenarioSpace, name: str) -> Block:
    """A block of the genes."""
    return next(block for block in space.genes.blocks if block.name == name)
