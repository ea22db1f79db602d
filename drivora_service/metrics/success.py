"""Success of an ego: arrival without infractions."""

from __future__ import annotations

from drivora_service.metrics.infractions import counted_collisions
from drivora_service.metrics.judgement import Judgement
from drivora_service.oracles.verdict import Outcome

RULES = ("red_light", "stop_sign", "lane_keeping", "route_deviation", "blocked")
"""Oracles whose violation is an infraction of Bench2Drive, beside counted collisions.

Slowness is none. ``off_road`` and ``wrong_way`` judge more strictly than the benchmark, whose test
of driving outside the lanes is ``lane_keeping``.
"""


def success(judgement: Judgement) -> float | None:
    """Returns 1 for arrival without infraction, else 0 (Bench2Drive).

    Collisions without the ego's fault are infractions too, as in that benchmark.

    Returns:
        ``None`` if the ego arrived and an oracle was not measurable, or arrival was not judged, or
        not measurable: an artefact of the simulator ended the run.
    """
    arrival = judgement.by("destination")
    if arrival is None:
        return None
    if arrival[0].outcome is Outcome.VIOLATED:
        return 0.0
    found = [counted_collisions(judgement), *(judgement.violations(rule) for rule in RULES)]
    if any(found):
        return 0.0
    return None if any(violations is None for violations in found) else 1.0
