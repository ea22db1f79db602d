"""Measurements of a run for a tester, computed in the worker, where the trace is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    # Code that only handles specs and reports must not load the dependencies of measuring.
    from drivora_service.observations.run_view import RunView


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """The measurement of one run by a feedback.

    Attributes:
        objectives: Values by name, in the feedback's fixed order; to be minimised, smaller is
            nearer to a failure. ``None`` is "not measurable", which a tester treats as worst.
        features: Tables by name, rows of equal length, all values finite.
    """

    objectives: Mapping[str, float | None]
    features: Mapping[str, tuple[tuple[float, ...], ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedbackChoice:
    """A feedback by its name in the catalogue, and its parameters."""

    name: str
    parameters: Mapping[str, Any] = field(default_factory=dict)


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
