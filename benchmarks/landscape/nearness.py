"""Measures by which a scenario may be near to a failure; smaller is nearer."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from drivora_service.feedback.avfuzzer import SAFETY_MARGIN, AvfuzzerFeedback
from drivora_service.feedback.behavexplor import DEGREE, BehavexplorFeedback
from drivora_service.feedback.drivefuzz import QUALITY, DrivefuzzFeedback
from drivora_service.feedback.measurement import Feedback
from drivora_service.feedback.samota import VEHICLE, SamotaFeedback
from drivora_service.observations.run_view import RunView
from drivora_service.oracles.avoidability.careful_driver import GRAVITY

Measure = Callable[[RunView], float]


def _of(feedback: Feedback, objective: str) -> Measure:
    def measure_objective(run: RunView) -> float:
        value = feedback.measure(run).objectives[objective]
        return math.inf if value is None else value

    return measure_objective


def braking_margin(run: RunView) -> float:
    """Returns one less the greatest deceleration that an ego needed, over what its tyres give.

    Needed is what avoids a crash with the actor ahead, which brakes on.
    """
    grip = float(run.trace.meta["friction"]) * GRAVITY
    needed = [float(ego.proximity.required_deceleration.max()) for ego in run.egos if ego.count]
    return 1.0 - max(needed, default=0.0) / grip


MEASURES: Mapping[str, Measure] = {
    "needed braking over grip": braking_margin,
    "avfuzzer": _of(AvfuzzerFeedback(), SAFETY_MARGIN),
    "behavexplor": _of(BehavexplorFeedback(), DEGREE),
    "drivefuzz": _of(DrivefuzzFeedback(), QUALITY),
    "samota": _of(SamotaFeedback(), VEHICLE),
}
"""The needed braking, and the objective of each method; of SAMOTA's six, that of collisions."""
