"""A method without its feedback: its operators work, but the told results are shuffled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drivora_service.search.tester import Evaluation, EvaluationStatus, Proposal, Tester


class ShuffledFeedback:
    """Tells a tester, for each candidate, the results of one of the candidates judged so far.

    It is drawn uniformly, the candidate itself included, so that the tester sees results that are
    distributed as its own. Whether a candidate is valid is told truly, and so is which of its genes
    had no effect: mutants are drawn again as with feedback, so that the twin differs in nothing but
    the feedback.
    """

    def __init__(self, tester: Tester, random: np.random.Generator) -> None:
        self._tester, self._random = tester, random
        self._judged: list[Evaluation] = []

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Asks the tester."""
        return self._tester.ask(room)

    def tell(self, evaluation: Evaluation) -> None:
        """Tells the tester the results of another candidate."""
        if evaluation.status is EvaluationStatus.JUDGED:
            self._judged.append(evaluation)
            other = self._judged[int(self._random.integers(len(self._judged)))]
            evaluation = replace(
                evaluation,
                violations=other.violations,
                verdicts=other.verdicts,
                scores=other.scores,
                measurement=other.measurement,
            )
        self._tester.tell(evaluation)
