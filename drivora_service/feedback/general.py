"""The general objectives as a feedback, for testers without a feedback of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.objectives import default_objectives, score_run
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.observations.run_view import RunView
from drivora_service.parameters import read_parameters


@dataclass(frozen=True, slots=True, kw_only=True)
class General:
    """Measures every general objective, each of the ego nearest to a failure."""

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return tuple(objective.name for objective in default_objectives())

    def measure(self, run: RunView) -> Measurement:
        """Returns each objective of the ego with the smallest score."""
        scores = score_run(run)
        return Measurement(objectives={name: scores[name] for name in self.objectives})


def _create(parameters: Mapping[str, Any]) -> General:
    return read_parameters(General, parameters, of="feedback 'general'")


GENERAL = FeedbackPlugin(
    name="general",
    description="the general objectives: gap, time to collision, progress, stuck time, goal",
    create=_create,
)
