"""Random testing: every candidate is drawn from the gene space."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.aims import Guidance
from drivora_service.search.components import Components
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.turn import Turn

_AT_ONCE = 32
"""Number of candidates that are drawn at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomParameters:
    """Random testing has no parameters."""


class RandomTester:
    """Draws candidates uniformly, regardless of the evaluations."""

    def __init__(self, context: TesterContext) -> None:
        self._context = context
        self._turn = Turn()
        self._drawn: deque[FloatArray] = deque()

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes as many as there is room for."""
        while len(self._drawn) < room:
            # Several draws at once are those of one after another, and nothing else is drawn.
            self._drawn.extend(self._context.space.sample(self._context.random, _AT_ONCE))
        drawn = tuple(Proposal(values=self._drawn.popleft(), origin="initial") for _ in range(room))
        return self._turn.propose(drawn, room)

    def tell(self, evaluation: Evaluation) -> None:
        """Checks the order of the evaluations."""
        self._turn.take(evaluation)


def _create(
    context: TesterContext, _parameters: RandomParameters, _components: Components
) -> RandomTester:
    return RandomTester(context)


RANDOM = TesterPlugin(
    name="random",
    title="Random",
    description="draws every candidate from the gene space",
    source="the baseline of every comparison",
    parameters=RandomParameters,
    feedback=FeedbackChoice(name="general"),
    create=_create,
    is_generational=False,
    guidance=Guidance.NONE,
)
