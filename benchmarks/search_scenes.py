"""Scenes whose space is searched, outside a campaign."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.engine import Search
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A seed scenario, its space, and the ADS of its egos.

    Attributes:
        scenario: The document; agents that it names do not count.
        space: What varies, as in a campaign file.
        agent: Name of the ADS.
        parameters: Those of its parameters that differ from their defaults.
        oracles: What counts; empty: :data:`SEARCHED_ORACLES`.
    """

    name: str
    scenario: dict[str, Any]
    space: dict[str, Any]
    agent: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    oracles: tuple[str, ...] = ()

    @property
    def driver(self) -> str:
        """The ADS with its parameters, as tables name it."""
        return ", ".join(
            [self.agent, *(f"{key} {value}" for key, value in self.parameters.items())]
        )


STUDIES = Path(__file__).parent / "studies"
FREQUENT = STUDIES / "one-ego.yaml"
"""Study with scenes at which failures are frequent, of one ego."""
SEVERAL_EGOS = STUDIES / "several-egos.yaml"
"""Study with scenes of several egos."""


SEARCHED_ORACLES = (
    "collision",
    "red_light",
    "off_road",
    "wrong_way",
    "route_deviation",
    "blocked",
    "deadlock",
)
SEARCHED_COUNTS = "possibly_at_fault"
"""What the published studies counted, which was the default when they were made: all that is not
known to be another's fault, by these oracles."""


@cache
def catalogues() -> Catalogues:
    """Returns the catalogues of campaigns; one a process."""
    return Catalogues(NetworkCatalogue(shipped_networks()))


def scenes_of(study: Path, agent: str) -> tuple[Scene, ...]:
    """Reads the scenes of a study file; each has a scenario and a space of its own."""
    return tuple(
        Scene(
            name=one["label"],
            scenario=json.loads((study.parent / one["file"]).read_text()),
            space=one["space"],
            agent=agent,
        )
        for one in yaml.safe_load(study.read_text())["scenarios"]
    )


def campaign_document(
    scene: Scene, tester: str = "random", *, seed: int = 1, simulations: int = 1
) -> dict[str, Any]:
    """Writes a campaign in a scene."""
    return {
        "name": scene.name,
        "tester": {"name": tester},
        "agent": {"name": scene.agent, "parameters": dict(scene.parameters)},
        "scenario": scene.scenario,
        "space": scene.space,
        "budget": {"simulations": simulations},
        "seed": seed,
        "counts": SEARCHED_COUNTS,
        "oracles": list(scene.oracles or SEARCHED_ORACLES),
    }


def prepare_scene(scene: Scene, *, seed: int = 1, simulations: int = 1) -> Search:
    """Prepares random search in a scene.

    Raises:
        InvalidDocument: The scene has no such space.
    """
    document = campaign_document(scene, seed=seed, simulations=simulations)
    valid = read_campaign(json.dumps(document), catalogues())
    return prepare_search(valid, catalogues(), run_prefix="scene")
