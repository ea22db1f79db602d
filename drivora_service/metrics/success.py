"""Success of an ego: arrival without infractions."""

from __future__ import annotations

from drivora_service.metrics.judgement import Judgement
from drivora_service.oracles.verdict import Outcome

RULES = (
    "collision",
    "red_light",
    "stop_sign",
    "off_road",
    "wrong_way",
    "lane_keeping",
    "route_deviation",
    "blocked",
)
"""Oracles whose violation is an infraction in Bench2Drive's sense; slowness is not."""


def success(judgement: Judgement) -> float | None:
    """Returns 1 for arrival without infraction, else 0 (Bench2Drive).

    Collisions without the ego's fault are infractions too, as in that benchmark.

    Returns:
        ``None`` if the ego arrived and an oracle was not measurable, or arrival was not judged.
    """
    arrival = judgement.by("destination")
    if arrival is None:
        return None
    if arrival[0].outcome is Outcome.VIOLATED:
        return 0.0
    found = [judgement.violations(rule) for rule in RULES]
    if any(found):
        return 0.0
    return None if any(violations is None for violations in found) else 1.0
