"""Measurements of a run for a tester, computed in the worker, where the trace is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from drivora_service.feedback.objective_choice import ObjectiveChoice
from drivora_service.feedback.objective_values import ObjectiveValues

if TYPE_CHECKING:
    # Code that only handles specs and reports must not load the dependencies of measuring.
    from drivora_service.observations.run_view import RunView


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """The measurement of one run by a feedback.

    Attributes:
        objectives: Values by name, in the feedback's fixed order; to be minimised, smaller is
            nearer to a failure. ``None`` is "not measurable", which a tester treats as worst. A
            name that was not measured raises ``UnknownObjective``.
        features: Tables by name, rows of equal length, all values finite.
    """

    objectives: Mapping[str, float | None]
    features: Mapping[str, tuple[tuple[float, ...], ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Makes the objectives a mapping that refuses unknown names."""
        object.__setattr__(self, "objectives", ObjectiveValues(self.objectives))


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedbackChoice:
    """A feedback by its name in the catalogue, and its parameters.

    Attributes:
        objectives: Objectives that are measured and minimised in place of its own; empty: its own.
    """

    name: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    objectives: tuple[ObjectiveChoice, ...] = ()


class Feedback(Protocol):
    """Measures runs for a tester. Frozen dataclasses whose fields are the parameters implement it.

    Measuring is a pure function of the run: the same run gives the same measurement in every
    worker.
    """

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives of every measurement."""
        ...

    def measure(self, run: RunView) -> Measurement:
        """Returns the objectives and features of a run."""
        ...
