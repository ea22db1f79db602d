"""The runs of a batch as a comparison sees them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    FailureDefinition,
)
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.model import AgentChoice

_SHORT = 8
"""Digits of a hash that name a scenario without a label."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenScenario:
    """What a run drives, regardless of its agents.

    Attributes:
        content: Hash of the scenario without its agents, seed and extensions.
        seed: Seed of the scenario.
        town: Name of the road network.
    """

    content: str
    seed: int
    town: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedRun:
    """A run of a batch.

    Attributes:
        id: Id of the run.
        label: Display name; "" without one.
        scenario: What it drives.
        seed: Seed of the run: the scenario's, or the one that overrides it.
        cause: Why it was not judged; "" if it was.
        trace_sha256: Hash of the trace, kept or not; "" unless it was simulated to its end.
        oracles: Oracles that judged it; empty unless finished.
        verdicts: Those of them that are not passed, of all egos.
        metrics: Measured values by name; ``None`` is "not measurable".
        agents: Agent of each ego with all its parameters; empty unless it was simulated.
        agent: Names of the agents, joined by commas.
        configuration: The agents with the parameters that differ from their defaults.
        configuration_id: Id of the agents with all their parameters; "" if it is not known.
        versions: Versions of the software that took part, by name.
        definition: What counts as a failure in it, as it was defined when it was posted.
    """

    id: str
    label: str
    scenario: DrivenScenario
    seed: int
    status: RunStatus
    cause: str = ""
    trace_sha256: str = ""
    oracles: frozenset[str] = frozenset()
    verdicts: tuple[Verdict, ...] = ()
    metrics: Mapping[str, float | None] = field(default_factory=dict)
    agents: Mapping[str, AgentChoice] = field(default_factory=dict)
    agent: str = ""
    configuration: str = ""
    configuration_id: str = ""
    versions: Mapping[str, Any] = field(default_factory=dict)
    definition: FailureDefinition = DEFAULT_DEFINITION

    @property
    def name(self) -> str:
        """The label; without one, the town and the beginning of the scenario's hash."""
        return self.label or f"{self.scenario.town} ({self.scenario.content[:_SHORT]})"


def read_driven_scenario(document: str) -> DrivenScenario:
    """Returns what a scenario has the egos drive, regardless of the agents that drive them.

    The free data of other tools (``extensions``) is left out: it is never interpreted.

    Args:
        document: Canonical JSON text.
    """
    content = json.loads(document)
    seed = int(content.pop("seed"))
    content.pop("extensions", None)
    for ego in content["ego_vehicles"]:
        ego.pop("agent", None)
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return DrivenScenario(
        content=hashlib.sha256(text.encode()).hexdigest(),
        seed=seed,
        town=str(content["map_region"]["town"]),
    )
