"""Telling violations that are new from those that were seen before.

Two violations are one if they are of the same type on the same routes: whoever tests for a week
wants to read each of them once.
"""

from __future__ import annotations

from typing import TypeAlias

from drivora_service.geometry.arrays import FloatArray
from drivora_service.oracles.verdict import Verdict
from drivora_service.search.genes import Part
from drivora_service.search.tester import Evaluation
from drivora_service.search.testers.doppeltest.chromosome import PATH, Chromosome

Place: TypeAlias = tuple[str, int | str]
Key: TypeAlias = tuple[str, frozenset[Place]]


class ViolationLog:
    """All violations of a campaign, each once."""

    def __init__(self, chromosome: Chromosome) -> None:
        self._chromosome = chromosome
        self._blocks = {block.actor: block for block in chromosome.space.blocks}
        self._seen: set[Key] = set()

    def count_new(self, evaluation: Evaluation) -> int:
        """Counts the violations of an evaluation that no earlier one had, and remembers them."""
        values = evaluation.proposal.values
        new = {self.key(verdict, values) for verdict in evaluation.violations} - self._seen
        self._seen |= new
        return len(new)

    def key(self, verdict: Verdict, values: FloatArray) -> Key:
        """Returns what makes a violation: the rule, and where those who took part were driving.

        Of a deadlock all egos in the cycle take part; else the ego and its counterpart.
        """
        actors = verdict.evidence.get("cycle", (verdict.ego, verdict.counterpart))
        return verdict.oracle, frozenset(self._place(name, values) for name in actors if name)

    def _place(self, name: str, values: FloatArray) -> Place:
        """Returns an actor's path; of walkers and obstacles, the route that they are in the way of.

        Those choose from the egos that are present, counted in order and over again.
        """
        block = self._blocks.get(name)
        if block is None:
            # Not of the gene space: an actor of the seed scenario, or of its background traffic.
            return "other", ""
        path = int(values[block.index(PATH)])
        if block.part in (Part.WALKER, Part.OBSTACLE):
            routes = self._chromosome.paths(values)
            path = int(routes[path % len(routes)])
        return block.part.value, path
