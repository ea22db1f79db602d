"""The parts of a tester that can be replaced one by one.

A testing method is a way of working (an algorithm over candidates) with five parts: *mutation*
makes a candidate from another, *execution* evaluates it (``campaigns.evaluator``), *oracles* judge
the run, *feedback* measures it (``feedback.measurement``), and *selection* says whom to go on with.
Mutation and selection are here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drivora_service.geometry.arrays import FloatArray, IntArray
from drivora_service.search.genes import GeneSpace


class Mutation(Protocol):
    """Makes a candidate from another."""

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy, within the bounds.

        Args:
            values: (d,) genes of the parent; left as they are.
            space: Their bounds.
            random: For every draw.
            strength: How much to change, against the mutation's usual measure.
        """
        ...


class Selection(Protocol):
    """Says whom to go on with."""

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Chooses from candidates by their objectives.

        Args:
            objectives: (n, m) to be minimised; NaN is not measurable and worse than any number.
            count: How many are wanted; more than n only from a selection that repeats.
            random: For every draw.

        Returns:
            (count,) indices of the chosen, best first where there is an order.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Components:
    """Parts that a campaign puts in place of a tester's own; ``None`` keeps the tester's."""

    mutation: Mutation | None = None
    selection: Selection | None = None
