"""Candidates in a scenario space."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from drivora_service.campaigns.candidates import Candidate
from drivora_service.geometry.arrays import FloatArray
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.genes import GeneSpace
from drivora_service.search.space.scenario_space import ScenarioSpace


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioCandidates:
    """Decodes values, and checks the scenario as documents are checked.

    Attributes:
        networks: Where its town is looked up.
        agents: Names of the agents that exist.
    """

    space: ScenarioSpace
    networks: NetworkCatalogue
    agents: Collection[str]

    @property
    def genes(self) -> GeneSpace:
        """What can be varied."""
        return self.space.genes

    def prepare(self, values: FloatArray) -> Candidate:
        """Repairs values (d,), decodes them, and checks the scenario."""
        repaired = self.space.repair(values)
        scenario = self.space.scenario(repaired)
        problems = scenario_problems(scenario, self.networks, self.agents)
        if problems:
            found = "; ".join(f"{problem.pointer}: {problem.message}" for problem in problems)
            return Candidate(values=repaired, problem=found)
        return Candidate(values=repaired, document=canonical_json(scenario))
