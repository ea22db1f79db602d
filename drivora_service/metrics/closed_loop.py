"""nuPlan's closed-loop score, and its parts.

The product of the multipliers times the weighted mean of the rest. Progress is compared with a
computed free drive instead of an expert's log: see ``free_flow``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from drivora_service.metrics.free_flow import free_flow
from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.measured import Combine, Measured
from drivora_service.metrics.projected_contact import contact_projected
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import EgoCol, Role
from drivora_service.oracles.speeding import overspeed
from drivora_service.oracles.verdict import Outcome, Verdict

TOLERATED_OVERSPEED = 2.23
"""Mean overspeed at which the speed score is 0, m/s."""

LEAST_PROGRESS = 0.2
"""Share of the reference's progress from which on the ego makes progress."""

TOLERATED_OUTSIDE = 0.3
"""Metres that a corner may be outside the drivable area, at any moment."""

NO_COLLISION = "nuplan_no_at_fault_collision"
DRIVABLE_AREA = "nuplan_drivable_area"
DIRECTION = "nuplan_driving_direction"
MAKING_PROGRESS = "nuplan_making_progress"
PROGRESS = "nuplan_progress_to_free_flow"
TIME_TO_COLLISION = "nuplan_time_to_collision"
SPEED_LIMIT = "nuplan_speed_limit"
COMFORT = "nuplan_comfort"

MULTIPLIERS = (NO_COLLISION, DRIVABLE_AREA, DIRECTION, MAKING_PROGRESS)
"""Parts that multiply the score."""

WEIGHTS = {PROGRESS: 5.0, TIME_TO_COLLISION: 5.0, SPEED_LIMIT: 4.0, COMFORT: 2.0}
"""Weights of the others in their mean."""

Parts = Mapping[str, float | None]


def measure_closed_loop(run: RunView, judgements: tuple[Judgement, ...]) -> tuple[Measured, ...]:
    """Measures nuPlan's closed-loop score and its parts, each 0..1.

    An ego whose part an artefact of the simulator ended has no score, and no measured progress.
    """
    parts = [_parts(ego, j) for ego, j in zip(run.egos, judgements, strict=True)]
    scores = [
        None if ego.artefact is not None else closed_loop_score(own)
        for ego, own in zip(run.egos, parts, strict=True)
    ]
    return (
        _make_measured("nuplan_closed_loop", scores),
        *(_make_measured(name, [own[name] for own in parts]) for name in (*MULTIPLIERS, *WEIGHTS)),
    )


def closed_loop_score(parts: Parts) -> float | None:
    """Returns the score; ``None`` if a part is missing and no multiplier makes it 0 anyway."""
    multipliers = [parts[name] for name in MULTIPLIERS]
    if 0.0 in multipliers:
        return 0.0
    product, total = 1.0, 0.0
    for multiplier in multipliers:
        if multiplier is None:
            return None
        product *= multiplier
    for name, weight in WEIGHTS.items():
        value = parts[name]
        if value is None:
            return None
        total += weight * value
    return product * total / math.fsum(WEIGHTS.values())


def _make_measured(name: str, values: Sequence[float | None]) -> Measured:
    return Measured(name=name, values=tuple(values), combine=Combine.MEAN)


def _parts(ego: EgoView, judgement: Judgement) -> Parts:
    at_fault = _at_fault(judgement)
    compared = free_flow(ego) if ego.count and ego.artefact is None else None
    progress = None if compared is None else compared.ratio
    return {
        NO_COLLISION: None if at_fault is None else _no_collision(at_fault),
        DRIVABLE_AREA: _drivable_area(ego, judgement),
        DIRECTION: _direction(judgement),
        MAKING_PROGRESS: None if progress is None else float(progress >= LEAST_PROGRESS),
        PROGRESS: progress,
        TIME_TO_COLLISION: _time_to_collision(ego, at_fault),
        SPEED_LIMIT: _speed_limit(ego),
        COMFORT: _score_oracle(judgement, "discomfort"),
    }


def _at_fault(judgement: Judgement) -> tuple[Verdict, ...] | None:
    """Returns the collisions at the ego's fault, by nuPlan's rule."""
    collisions = judgement.violations("collision")
    if collisions is None:
        return None
    return tuple(c for c in collisions if c.evidence["nuplan_at_fault"])


def _no_collision(at_fault: tuple[Verdict, ...]) -> float:
    """1 without collisions at fault, 0.5 for one with an object, else 0."""
    if not at_fault:
        return 1.0
    objects = sum(c.evidence["counterpart_role"] == Role.NPC_OBSTACLE for c in at_fault)
    return 0.5 if len(at_fault) == objects == 1 else 0.0


def _score_oracle(judgement: Judgement, oracle: str) -> float | None:
    found = judgement.violations(oracle)
    return None if found is None else float(not found)


def _drivable_area(ego: EgoView, judgement: Judgement) -> float | None:
    """Returns 1 if the ego stayed in the drivable area, else 0.

    ``off_road`` excuses a shallow excess that is short; nuPlan does not.
    """
    if judgement.by("off_road") is None:
        return None
    return float(not (ego.outside > TOLERATED_OUTSIDE).any())


def _direction(judgement: Judgement) -> float | None:
    verdicts = judgement.by("wrong_way")
    if verdicts is None:
        return None
    broken = [v for v in verdicts if v.outcome is Outcome.VIOLATED]
    if not broken:
        return 1.0
    return 0.0 if any(v.evidence["severe"] for v in broken) else 0.5


def _time_to_collision(ego: EgoView, at_fault: tuple[Verdict, ...] | None) -> float | None:
    """1 if the time to collision stays above its bound; it is 0 in a collision at fault."""
    if not ego.count or at_fault is None:
        return None
    return float(not at_fault and not contact_projected(ego))


def _speed_limit(ego: EgoView) -> float | None:
    limit = ego.value(EgoCol.SPEED_LIMIT)
    if ego.count < 2 or not (limit > 0.0).any():
        return None
    excess = float(np.trapezoid(overspeed(ego), ego.times))
    return max(0.0, 1.0 - excess / (TOLERATED_OVERSPEED * ego.duration))
