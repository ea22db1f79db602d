"""Seed scenarios of the shipped networks."""

from __future__ import annotations

import functools

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.seeds import generate_seeds
from drivora_service.scenario.validation import validate_document

NETWORKS = NetworkCatalogue(shipped_networks())
SHIPPED = NETWORKS.names()


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
