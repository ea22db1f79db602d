"""The components of a tester that can be replaced one by one.

A testing method is an algorithm over candidates with five components: *mutation* makes a candidate
from another, *execution* evaluates it (``campaigns.evaluator``), *oracles* judge the run,
*feedback* measures it (``feedback.measurement``), and *selection* chooses the survivors. Mutation
and selection are here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.genes import GeneSpace


class Mutation(Protocol):
    """Operator that changes a candidate."""

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
            values: (d,) genes of the parent; not changed.
            space: Their bounds.
            random: Generator for every draw.
            strength: Amount of change, relative to the mutation's usual amount.
        """
        ...


class Selection(Protocol):
    """Survivor selection."""

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Chooses from candidates by their objectives.

        Args:
            objectives: (n, m) to be minimised; NaN is not measurable and worse than any number.
            count: Number of candidates to choose; more than n only from a selection that repeats.
            random: Generator for every draw.

        Returns:
            (count,) indices of the chosen, best first if there is an order.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Components:
    """Components that replace a tester's own; ``None`` keeps the tester's."""

    mutation: Mutation | None = None
    selection: Selection | None = None
