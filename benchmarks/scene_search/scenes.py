"""The scenes among which the search looks: seed scenarios times spaces times ADSs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from benchmarks.search_scenes import Scene, catalogues
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seeds import generate_seeds

STEP = 0.1
"""Seconds a step: half the steps of the default."""
LENGTHS_M = (100.0, 250.0)
SEEDS_OF_A_NETWORK = 6
FIRST_SEED = 501

AGENTS = ("idm", "plant-lite", "pdm-closed")

SPACES: Mapping[str, Mapping[str, Any]] = {
    "reactive traffic": {"vehicles": 5, "walkers": 0, "weather": False},
    "traffic and walkers": {"vehicles": 4, "walkers": 2, "weather": True},
    "replayed traffic": {"vehicles": 4, "walkers": 0, "behavior": "replay", "weather": False},
    "walkers": {"vehicles": 1, "walkers": 3, "weather": True, "max_walker_delay": 10.0},
    "obstacles": {"vehicles": 3, "walkers": 0, "obstacles": 2, "weather": True},
}


def scenes() -> Iterator[Scene]:
    """Yields all scenes, in an order in which every part is a sample of the whole."""
    towns = sorted(path.name for path in shipped_networks().iterdir() if path.is_dir())
    seeds = {
        town: list(
            generate_seeds(
                catalogues().networks.get(town),
                count=SEEDS_OF_A_NETWORK,
                min_length=LENGTHS_M[0],
                max_length=LENGTHS_M[1],
                seed=FIRST_SEED + place,
                agent="idm",
            )
        )
        for place, town in enumerate(towns)
    }
    for number in range(SEEDS_OF_A_NETWORK):
        for town in towns:
            scenario = json.loads(document_text(seeds[town][number]))
            scenario["step_length"] = STEP
            for ego in scenario["ego_vehicles"]:
                ego.pop("agent", None)
                ego["initial_speed"] = 8.0
            for name, space in SPACES.items():
                for agent in AGENTS:
                    yield Scene(
                        name=f"{town} {number}, {name}",
                        scenario=scenario,
                        space=dict(space),
                        agent=agent,
                    )
