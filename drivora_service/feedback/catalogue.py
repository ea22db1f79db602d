"""The built-in objectives."""

from __future__ import annotations

from drivora_service.feedback.goal_distance import GoalDistance
from drivora_service.feedback.min_gap import MinGap
from drivora_service.feedback.objective import Objective
from drivora_service.feedback.progress import Progress
from drivora_service.feedback.stuck_time import StuckTime
from drivora_service.feedback.time_to_collision import TimeToCollision
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace


def default_objectives() -> tuple[Objective, ...]:
    """Gives the built-in objectives with their default scales."""
    return (MinGap(), TimeToCollision(), Progress(), StuckTime(), GoalDistance())


def score(
    trace: Trace, network: RoadNetwork, *, view: RunView | None = None
) -> dict[str, float | None]:
    """Scores a run by every objective, to be minimised.

    Args:
        trace: The run.
        network: The road network it took place on.
        view: A view of that run, if there is one already: what it has computed is used again.

    Returns:
        Scores by name: that of the ego which was nearest to a failure; ``None`` if no ego has one.
        Where there are several egos, ``name[ego id]`` is the score of one of them.
    """
    return score_run(view or RunView(trace, network))


def score_run(run: RunView) -> dict[str, float | None]:
    """Scores a run by every objective; see :func:`score`."""
    scores: dict[str, float | None] = {}
    for objective in default_objectives():
        values = [objective.score(ego) if ego.count else None for ego in run.egos]
        known = [value for value in values if value is not None]
        scores[objective.name] = min(known) if known else None
        if len(run.egos) > 1:
            for ego, value in zip(run.egos, values, strict=True):
                scores[f"{objective.name}[{ego.id}]"] = value
    return scores
