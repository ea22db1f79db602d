"""The runs during which faults are injected: short drives of good agents, and hostile ones."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from typing import Any

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds

GOOD = "steady"
"""The agent of good runs: drives as ``idm`` does, and takes some tenths of a second for it."""

SLOW = "slow"
"""Drives as ``steady`` does, and takes some seconds for it."""

KINDS = 12
"""Different good scenarios."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A run that a test posts.

    Attributes:
        agent: Name of the agent.
        kind: Which of the scenarios.
        seed: Makes a hostile run's scenario one of its own, so that no quarantine concerns another.
    """

    agent: str
    kind: int
    seed: int

    @property
    def is_good(self) -> bool:
        """Whether the run must be finished, with the trace of an undisturbed run."""
        return self.agent in (GOOD, SLOW, "idm")

    @property
    def document(self) -> str:
        """The scenario in JSON."""
        content = json.loads(_drives()[self.kind])
        content["ego_vehicles"][0]["agent"] = {"name": self.agent}
        return json.dumps(content | {"seed": self.seed})


@cache
def _drives() -> tuple[str, ...]:
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    found = generate_seeds(network, count=KINDS, min_length=30, max_length=60, seed=4, agent=GOOD)
    return tuple(document_text(document) for document in found)


def good_runs(count: int, *, agent: str = GOOD) -> list[Run]:
    """Returns so many good runs."""
    return [Run(agent=agent, kind=n % KINDS, seed=n % KINDS) for n in range(count)]


def among(good: list[Run], hostile: list[str], *, seed: int) -> list[Run]:
    """Returns good runs with hostile ones evenly between them, of scenarios of their own."""
    runs = list(good)
    distance = max(1, len(good) // (len(hostile) + 1))
    for number, agent in enumerate(hostile):
        rogue = Run(agent=agent, kind=number % KINDS, seed=1000 + 100 * seed + number)
        runs.insert((number + 1) * distance + number, rogue)
    return runs


def campaign(simulations: int) -> dict[str, Any]:
    """Returns the document of a small campaign."""
    content = json.loads(Run(agent=GOOD, kind=0, seed=3).document)
    return {
        "name": "under faults",
        "tester": {"name": "random"},
        "agent": {"name": "idm"},
        "scenario": content,
        "space": {"vehicles": 2, "walkers": 2},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": simulations},
        "seed": 3,
    }
