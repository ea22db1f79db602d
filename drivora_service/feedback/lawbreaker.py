"""The feedback of LawBreaker: how far each way to violate a traffic law is from happening.

Sun et al., *LawBreaker: An Approach for Specifying Traffic Laws and Fuzzing Autonomous Vehicles*
(ASE 2022).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.oracles.laws.law import Law
from drivora_service.oracles.laws.law_judging import violation_robustness
from drivora_service.oracles.laws.library import LawLibrary
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import RunView


@dataclass(frozen=True, slots=True, kw_only=True)
class LawbreakerParameters:
    """The feedback has no parameters: it measures all laws."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LawbreakerFeedback:
    """Measures the negated greatest robustness of every sub-violation, of the worst ego.

    Attributes:
        laws: The laws.
    """

    laws: tuple[Law, ...]

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives: ``LAW/1`` is the first sub-violation of a law."""
        return objectives_of(self.laws)

    def measure(self, run: RunView) -> Measurement:
        """Measures a run; not measurable if no ego has started."""
        cases = [case for law in self.laws for case in law.sub_violations]
        measured = [violation_robustness(ego, cases) for ego in run.egos if ego.count]
        worst = [-max(values) for values in zip(*measured, strict=True)] or [None] * len(cases)
        return Measurement(objectives=dict(zip(self.objectives, worst, strict=True)))


def objectives_of(laws: Sequence[Law]) -> tuple[str, ...]:
    """Returns the names of the sub-violations of laws, in their order."""
    return tuple(
        f"{law.name}/{number}" for law in laws for number in range(1, len(law.sub_violations) + 1)
    )


def law_of(objective: str) -> str:
    """Returns the law of a sub-violation."""
    return objective.rpartition("/")[0]


def lawbreaker_feedback(laws: Sequence[Law] | None = None) -> FeedbackPlugin:
    """Returns the feedback of some laws; ``None``: the shipped ones."""
    return FeedbackPlugin(
        name="lawbreaker",
        description="how far each way to violate a traffic law is from happening",
        create=partial(_create, laws=laws),
    )


def _create(parameters: Mapping[str, Any], *, laws: Sequence[Law] | None) -> LawbreakerFeedback:
    read_parameters(LawbreakerParameters, parameters, of="feedback 'lawbreaker'")
    if laws is None:
        library = LawLibrary()
        laws = [library.law(name) for name in library.names()]
    return LawbreakerFeedback(laws=tuple(laws))
