"""Drawing mutants again that could not change the run of any ego.

Such a mutant gives its parent's run once more: a simulation is spent, and the method learns that a
change had no effect where there was none. A mutant is drawn again if it follows from its parent's
run that the egos of both do the same: the genes that differ were without effect in that run
(``worker.without_effect``), or decode to the same scenario. That is a part of the mutants that do
not change any ego's run, since an ADS does not react to all that is within its perception.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.tester import Evaluation, TesterContext

ATTEMPTS = 20
"""Default number of mutants that are drawn again for one candidate at most."""
MOST_ATTEMPTS = 1000
"""Greatest number that a campaign may choose: each is decoded, which takes about a millisecond."""


def without_effect(evaluation: Evaluation) -> BoolArray:
    """Returns which genes (d,) of an evaluated candidate were without effect in its run."""
    flags = np.zeros(len(evaluation.proposal.values), dtype=np.bool_)
    flags[list(evaluation.without_effect)] = True
    return flags


@dataclass(frozen=True, slots=True, kw_only=True)
class Redrawing:
    """Draws mutants until one may change the run of an ego.

    Attributes:
        decode_alike: As in ``TesterContext``.
        attempts: Number of mutants that are drawn again at most; then the last one is taken.
    """

    decode_alike: Callable[[FloatArray, FloatArray], bool] | None
    attempts: int

    @classmethod
    def of(cls, context: TesterContext, attempts: int) -> Redrawing:
        """Returns the redrawing of a tester."""
        return cls(decode_alike=context.decode_alike, attempts=attempts)

    def draw(
        self, mutate: Callable[[], FloatArray], parent: FloatArray, idle: BoolArray
    ) -> tuple[FloatArray, int]:
        """Returns a mutant (d,) and how many were drawn again before it.

        Args:
            mutate: Draws a mutant.
            parent: (d,) repaired genes of its parent.
            idle: (d,) which of them were without effect in the parent's run.
        """
        values = mutate()
        for redrawn in range(self.attempts):
            if self.may_change(values, parent, idle):
                return values, redrawn
            values = mutate()
        return values, self.attempts

    def may_change(self, values: FloatArray, parent: FloatArray, idle: BoolArray) -> bool:
        """Returns whether a mutant may change the run of an ego; ``True`` if in doubt."""
        # Genes without effect first: what is left must decode to the parent's scenario.
        effective = np.where(idle, parent, values)
        if np.array_equal(effective, parent):
            return False
        return self.decode_alike is None or not self.decode_alike(parent, effective)
