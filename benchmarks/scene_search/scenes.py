"""The scenes among which the search looks: seed scenarios times spaces times ADSs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from benchmarks.reference_scene import NoReferenceError, add_driven_paths
from benchmarks.search_scenes import Scene, catalogues
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds

STEP = 0.1
"""Seconds a step: half the steps of the default."""
LENGTHS_M = (100.0, 250.0)
DETOUR_LENGTHS_M = (250.0, 500.0)
"""Room for a lane change that leaves the reference path for two fifths of the way."""
SEEDS_OF_A_NETWORK = 4
FIRST_SEED = 501

AGENTS: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("plant-lite", {}),
    ("sumo-krauss", {}),
)
"""Names and parameters."""

_TRAFFIC: Mapping[str, Any] = {
    "optional": True,
    "max_deceleration": 8.0,
    "max_lateral_acceleration": 4.0,
}
"""Vehicles that brake and change lanes as hard as drivers do in need; each may be absent."""
SPACES: Mapping[str, Mapping[str, Any]] = {
    "traffic": {**_TRAFFIC, "vehicles": 5, "walkers": 0, "weather": False},
    "traffic and walkers": {**_TRAFFIC, "vehicles": 4, "walkers": 2, "weather": True},
    "everything": {
        **_TRAFFIC,
        "vehicles": 4,
        "walkers": 2,
        "obstacles": 2,
        "patches": 3,
        "weather": True,
    },
    "traffic that stands": {
        **_TRAFFIC,
        "vehicles": 5,
        "walkers": 0,
        "weather": True,
        "max_wait": 10.0,
        "at_end": "stay",
    },
    "traffic and patches": {
        **_TRAFFIC,
        "vehicles": 4,
        "walkers": 0,
        "patches": 6,
        "weather": False,
    },
    "less traffic and patches": {
        **_TRAFFIC,
        "vehicles": 3,
        "walkers": 0,
        "patches": 4,
        "weather": False,
    },
    "little traffic and patches": {
        **_TRAFFIC,
        "vehicles": 2,
        "walkers": 0,
        "patches": 3,
        "weather": False,
    },
}


LAW_AGENT = "sumo-krauss"
LAW_SPACES = ("traffic and walkers", "everything", "traffic that stands")
"""An ADS that makes mistakes of its own, and what may tempt it to make them."""

DETOURING_AGENTS = ("sumo-krauss", "idm-mobil")
"""They change lanes: an ADS that keeps to its lane makes no detours."""
_IN_THE_WAY: Mapping[str, Any] = {
    # A reactive vehicle could be late by any time, and so may not be on the ego's way at all.
    "behavior": "replay",
    "optional": True,
    "walkers": 0,
    "weather": False,
}
SPACES_OF_DETOURS: Mapping[str, Mapping[str, Any]] = {
    "vehicles": {**_IN_THE_WAY, "vehicles": 6},
    "vehicles and obstacles": {**_IN_THE_WAY, "vehicles": 4, "obstacles": 3},
    "slow vehicles": {**_IN_THE_WAY, "vehicles": 6, "max_speed_factor": 0.7},
}


def failing_scenes() -> Iterator[Scene]:
    """Yields scenes for failures, in an order in which every part is a sample of the whole."""
    for name, scenario in _seed_scenarios(LENGTHS_M):
        for space_name, space in SPACES.items():
            for agent, parameters in AGENTS:
                yield Scene(
                    name=f"{name}, {space_name}",
                    scenario=scenario,
                    space=dict(space),
                    agent=agent,
                    parameters=parameters,
                )


def law_scenes() -> Iterator[Scene]:
    """Yields those of the scenes for failures at which ways to violate traffic laws are counted."""
    for scene in failing_scenes():
        if scene.agent == LAW_AGENT and scene.name.partition(", ")[2] in LAW_SPACES:
            yield scene


def detour_scenes() -> Iterator[Scene]:
    """Yields scenes for needless detours, with the path that the ADS takes without other actors."""
    for name, scenario in _seed_scenarios(DETOUR_LENGTHS_M):
        for agent in DETOURING_AGENTS:
            try:
                told = add_driven_paths(scenario, agent)
            except NoReferenceError:
                continue
            for space_name, space in SPACES_OF_DETOURS.items():
                yield Scene(
                    name=f"{name}, {space_name}",
                    scenario=json.loads(told),
                    space=dict(space),
                    agent=agent,
                    oracles=("non_optimal_decision",),
                )


def _seed_scenarios(lengths_m: tuple[float, float]) -> Iterator[tuple[str, dict[str, Any]]]:
    towns = sorted(path.name for path in shipped_networks().iterdir() if path.is_dir())
    seeds = {
        town: list(
            generate_seeds(
                catalogues().networks.get(town),
                count=SEEDS_OF_A_NETWORK,
                min_length=lengths_m[0],
                max_length=lengths_m[1],
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
            yield f"{town} {number}", scenario
