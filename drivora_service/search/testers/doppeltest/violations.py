"""Telling new violations from known ones.

Two violations are the same if they are of the same type on the same routes: in a week of testing,
each should be reported once.
"""

from __future__ import annotations

from typing import TypeAlias

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Verdict
from drivora_service.search.genes import Part
from drivora_service.search.tester import Evaluation
from drivora_service.search.testers.doppeltest.chromosome import PATH, Chromosome

Place: TypeAlias = tuple[str, int | str]
Identity: TypeAlias = tuple[str, frozenset[Place]]


class ViolationLog:
    """All violations of a campaign, each once."""

    def __init__(self, chromosome: Chromosome) -> None:
        self._chromosome = chromosome
        self._blocks = {block.actor: block for block in chromosome.space.blocks}
        self._seen: set[Identity] = set()

    def count_new(self, evaluation: Evaluation) -> int:
        """Returns the number of new violations of an evaluation, and remembers them."""
        values = evaluation.proposal.values
        new = {self.identity(verdict, values) for verdict in evaluation.violations} - self._seen
        self._seen |= new
        return len(new)

    def identity(self, verdict: Verdict, values: FloatArray) -> Identity:
        """Returns the identity of a violation: the oracle, and the paths of the actors involved.

        In a deadlock these are all egos of the cycle; else the ego and its counterpart.
        """
        actors = verdict.evidence.get("cycle", (verdict.ego, verdict.counterpart))
        return verdict.oracle, frozenset(self._place(name, values) for name in actors if name)

    def _place(self, name: str, values: FloatArray) -> Place:
        """Returns an actor's path; for walkers and obstacles, the route that they obstruct.

        They choose from the egos that are present, numbered in order and cyclically.
        """
        block = self._blocks.get(name)
        if block is None:
            # Not in the gene space: an actor of the seed scenario, or of its background traffic.
            return "other", ""
        path = int(values[block.index(PATH)])
        if block.part in (Part.WALKER, Part.OBSTACLE):
            routes = self._chromosome.paths(values)
            path = int(routes[path % len(routes)])
        return block.part.value, path
