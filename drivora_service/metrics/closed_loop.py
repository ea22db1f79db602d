"""nuPlan's closed-loop scores, as far as they are measurable without an expert's log.

Progress needs the log of an expert or a free-flow run of the same route; without it there is no
overall score.
"""

from __future__ import annotations

from drivora_service.metrics.judgement import Judgement
from drivora_service.metrics.measured import Combine, Measured
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import EgoCol, Role
from drivora_service.oracles.speeding import overspeed
from drivora_service.oracles.verdict import Outcome

LEAST_TIME_TO_COLLISION = 0.95
"""Seconds."""

TOLERATED_OVERSPEED = 2.23
"""Mean overspeed at which the speed score is 0, m/s."""

STANDING_SPEED = 0.005
"""m/s up to which the ego stands and endangers no actor."""


def closed_loop(run: RunView, judgements: tuple[Judgement, ...]) -> tuple[Measured, ...]:
    """Measures the parts of nuPlan's closed-loop score, each 0..1."""
    pairs = list(zip(run.egos, judgements, strict=True))
    parts = {
        "nuplan_no_at_fault_collision": [_no_collision(j) for _, j in pairs],
        "nuplan_drivable_area": [_kept(j, "off_road") for _, j in pairs],
        "nuplan_driving_direction": [_direction(j) for _, j in pairs],
        "nuplan_time_to_collision": [_time_to_collision(ego) for ego, _ in pairs],
        "nuplan_speed_limit": [_speed_limit(ego) for ego, _ in pairs],
        "nuplan_comfort": [_kept(j, "discomfort") for _, j in pairs],
    }
    return tuple(
        Measured(name=name, values=tuple(values), combine=Combine.MEAN)
        for name, values in parts.items()
    )


def _no_collision(judgement: Judgement) -> float | None:
    """1 without collisions at fault, 0.5 for one with an object, else 0."""
    collisions = judgement.violations("collision")
    if collisions is None:
        return None
    at_fault = [c for c in collisions if c.evidence["nuplan_at_fault"]]
    objects = [c for c in at_fault if c.evidence["counterpart_role"] == Role.NPC_OBSTACLE]
    if not at_fault:
        return 1.0
    return 0.5 if len(at_fault) == len(objects) == 1 else 0.0


def _kept(judgement: Judgement, oracle: str) -> float | None:
    found = judgement.violations(oracle)
    return None if found is None else float(not found)


def _direction(judgement: Judgement) -> float | None:
    verdicts = judgement.by("wrong_way")
    if verdicts is None:
        return None
    broken = [v for v in verdicts if v.outcome is Outcome.VIOLATED]
    if not broken:
        return 1.0
    return 0.0 if any(v.evidence["severe"] for v in broken) else 0.5


def _time_to_collision(ego: EgoView) -> float | None:
    """1 if the time to collision with actors that are not behind stays above the limit."""
    if not ego.count:
        return None
    soon = ego.proximity.forward_time_to_collision < LEAST_TIME_TO_COLLISION
    return float(not (soon & (ego.speed > STANDING_SPEED)).any())


def _speed_limit(ego: EgoView) -> float | None:
    limit = ego.value(EgoCol.SPEED_LIMIT)
    if not (limit > 0.0).any():
        return None
    return max(0.0, 1.0 - float(overspeed(ego).mean()) / TOLERATED_OVERSPEED)
