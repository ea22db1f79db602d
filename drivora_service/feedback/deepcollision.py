"""The feedback of DeepCollision: the greatest probability of a collision in a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from drivora_service.feedback.collision_probability import collision_probability
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

SAFETY = "safety"
"""The objective: 1 minus the greatest probability of a collision; 0 for a collision."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeepcollisionFeedback:
    """Measures how far a run was from a collision, of the worst ego; it has no parameters."""

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (SAFETY,)

    def measure(self, run: RunView) -> Measurement:
        """Measures a run; not measurable if no ego drove."""
        values = [_safety(ego) for ego in run.egos if ego.count]
        return Measurement(objectives={SAFETY: min(values, default=None)})


def _safety(ego: EgoView) -> float:
    trace = ego.trace
    # Those that the simulator made are not in its part.
    if any(c.ego == ego.row and c.step < ego.first + ego.count for c in trace.contacts):
        return 0.0
    rows = slice(ego.first, ego.first + ego.count)
    risks = collision_probability(trace.states[rows], trace.present[rows], trace.actors, ego.row)
    return float(1.0 - risks.max())


def _create(parameters: Mapping[str, Any]) -> DeepcollisionFeedback:
    return read_parameters(DeepcollisionFeedback, parameters, of="feedback 'deepcollision'")


DEEPCOLLISION = FeedbackPlugin(
    name="deepcollision",
    description="the greatest probability of a collision, from safety distances",
    create=_create,
)
