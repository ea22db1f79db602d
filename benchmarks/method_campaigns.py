"""A campaign of every method on generated scenarios, and one on a scene with failures.

The space, the oracles and the ADS of each are such that the method can do what it is for.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from benchmarks.search_scenes import (
    FREQUENT,
    SEARCHED_COUNTS,
    SEARCHED_ORACLES,
    SEVERAL_EGOS,
    campaign_document,
    scenes_of,
)
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds

_LAWS = ("law_38_red_light", "law_44_lane_change", "law_45_speed_limit", "law_46_turn_speed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What the campaign of a method has, apart from defaults.

    Attributes:
        space: Its space, as in a campaign file.
        oracles: Its oracles; none: ``SEARCHED_ORACLES``.
        agent: Name of the ADS.
        parameters: Parameters of the tester.
    """

    space: dict[str, Any] = field(default_factory=dict)
    oracles: tuple[str, ...] = ()
    agent: str = "idm"
    parameters: dict[str, Any] = field(default_factory=dict)

    def of(self, tester: str) -> dict[str, Any]:
        """Returns the keys of a campaign file."""
        return {
            "tester": {"name": tester, "parameters": self.parameters},
            "agent": {"name": self.agent},
            "space": self.space,
            "counts": SEARCHED_COUNTS,
            "oracles": list(self.oracles or SEARCHED_ORACLES),
        }


# A needless detour needs an ADS that changes lanes, and actors ahead of it that do not react.
_DETOURS = Setting(
    space={
        "vehicles": 4,
        "walkers": 0,
        "obstacles": 2,
        "weather": False,
        "optional": True,
        "behavior": "replay",
    },
    oracles=("non_optimal_decision",),
    agent="idm-mobil",
)

BUDGET: dict[str, Setting] = {
    "random": Setting(),
    "avfuzzer": Setting(),
    "behavexplor": Setting(),
    "samota": Setting(),
    "doppeltest": Setting(
        space={"egos": 4, "vehicles": 0, "walkers": 2, "weather": False, "lights": True}
    ),
    "lawbreaker": Setting(oracles=("collision", *_LAWS)),
    "drivefuzz": Setting(
        space={"vehicles": 5, "walkers": 3, "obstacles": 2, "patches": 3, "optional": True}
    ),
    "decictor": _DETOURS,
    # It learns within the budget.
    "deepcollision": Setting(parameters={"learning_starts": 200, "exploration_steps": 500}),
}
"""On generated scenarios."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Telling:
    """A scene of the studies with failures in a few simulations.

    Attributes:
        scene: Name of the scene.
        setting: What its campaign has in place of the scene's; ``None``: all is the scene's.
    """

    scene: str
    setting: Setting | None = None


_MOTORWAY = "motorway in rain"
TELLING: dict[str, Telling] = {
    "random": Telling(scene=_MOTORWAY),
    "avfuzzer": Telling(scene=_MOTORWAY),
    "behavexplor": Telling(scene=_MOTORWAY),
    "samota": Telling(scene=_MOTORWAY),
    "doppeltest": Telling(scene="church lane, eight egos"),
    "lawbreaker": Telling(
        scene=_MOTORWAY,
        setting=Setting(
            space={"vehicles": 4, "walkers": 0, "weather": False},
            oracles=("collision", *_LAWS),
            agent="idm-mobil",
        ),
    ),
    "drivefuzz": Telling(
        scene=_MOTORWAY,
        setting=Setting(
            space={
                "vehicles": 8,
                "walkers": 0,
                "patches": 4,
                "weather": False,
                "optional": True,
            }
        ),
    ),
    "decictor": Telling(scene="wet arterial", setting=_DETOURS),
    # Its checkpoints and its learning begin before it is killed.
    "deepcollision": Telling(
        scene=_MOTORWAY,
        setting=Setting(
            space={"vehicles": 1, "walkers": 0, "weather": False},
            parameters={
                "interval": 4.0,
                "learning_starts": 40,
                "exploration_steps": 100,
                "checkpoint_every": 10,
            },
        ),
    ),
}
"""Scenes in which each finds something."""


def make_generated_campaign(
    networks: NetworkCatalogue, tester: str, town: str, *, seed: int, simulations: int
) -> dict[str, Any]:
    """Writes a campaign on a generated seed scenario."""
    setting = BUDGET[tester]
    (document,) = generate_seeds(
        networks.get(town), count=1, min_length=150.0, max_length=250.0, seed=1, agent=setting.agent
    )
    return {
        **setting.of(tester),
        "name": f"{tester} on {town}",
        "scenario": json.loads(document_text(document)),
        "budget": {"simulations": simulations},
        "seed": seed,
    }


def make_telling_campaign(tester: str, *, seed: int, simulations: int) -> dict[str, Any]:
    """Writes a campaign on a scene in which the method finds something."""
    telling = TELLING[tester]
    scenes = [scene for study in (FREQUENT, SEVERAL_EGOS) for scene in scenes_of(study, "idm")]
    scene = next(scene for scene in scenes if scene.name == telling.scene)
    document = campaign_document(scene, tester, seed=seed, simulations=simulations)
    return document if telling.setting is None else {**document, **telling.setting.of(tester)}
