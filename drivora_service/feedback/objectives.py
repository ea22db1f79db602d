"""The general objectives, which every search can minimise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.proximity import HORIZON
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col, EgoCol, Trace
from drivora_service.oracles.blocked import Blocked, standing_clock


class Objective(Protocol):
    """A score of one ego's part of a run. Frozen dataclasses implement it.

    A smaller score is nearer to a failure; scores lie in 0..1. ``None`` is "not measurable": a
    missing value is never scored as 0, which would be the best of all.
    """

    @property
    def name(self) -> str:
        """Name in the catalogue, in snake case."""
        ...

    def score(self, ego: EgoView) -> float | None:
        """Returns the score of an ego that has at least one row."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class MinGap:
    """Least distance between the ego's box and another; ``None`` without another actor.

    Attributes:
        scale: Metres from which on the score is 1.
    """

    scale: float = 10.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "min_gap"

    def score(self, ego: EgoView) -> float | None:
        """Returns the least gap over the scale, at most 1; None without another actor."""
        gap = ego.proximity.min_gap
        return None if gap is None else min(gap / self.scale, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeToCollision:
    """Least time to a collision at constant velocities; ``None`` without another actor.

    Attributes:
        scale: Seconds from which on the score is 1, as without an actor on a collision course; at
            most the horizon of the measurement.
    """

    scale: float = HORIZON

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "time_to_collision"

    def score(self, ego: EgoView) -> float | None:
        """Returns the least time over the scale, at most 1; None without another actor."""
        if ego.proximity.min_gap is None:
            return None
        return min(float(ego.proximity.time_to_collision.min()) / self.scale, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Share of the route that was driven: 0 for an ego that never left its start."""

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "progress"

    def score(self, ego: EgoView) -> float | None:
        """Returns the share of the route, 0 to 1; None if its place on the route is unknown."""
        done = ego.value(EgoCol.ROUTE_S) / ego.route.length
        if not np.isfinite(done).any():
            return None
        return float(np.clip(np.nanmax(done), 0.0, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class StuckTime:
    """1 minus the longest standstill over the time after which an ego counts as blocked.

    The longer the ego stood without a signal to wait for, the smaller the score.

    Attributes:
        scale: Seconds at which the score is 0.
    """

    scale: float = Blocked().duration

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "stuck_time"

    def score(self, ego: EgoView) -> float | None:
        """Returns 1 for an ego that never stood, 0 for one that stood for the scale or longer."""
        return 1.0 - min(float(standing_clock(ego).max()) / self.scale, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalDistance:
    """1 minus the distance between the ego's end and its goal, over the length of its route.

    As all objectives it is smaller nearer to a failure, which here is not to arrive: an ego that
    ends at its goal scores 1, one that ends a route's length away 0. The scale is the route, so
    that the score distinguishes all ends.
    """

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "goal_distance"

    def score(self, ego: EgoView) -> float | None:
        """Returns 1 at its goal, 0 a route's length away from it; None without a route."""
        if not ego.route.length > 0.0:
            return None
        goal_x, goal_y = ego.route.goal
        away = np.hypot(ego.states[-1, Col.X] - goal_x, ego.states[-1, Col.Y] - goal_y)
        return 1.0 - min(float(away) / ego.route.length, 1.0)


def default_objectives() -> tuple[Objective, ...]:
    """Returns the built-in objectives with their default scales."""
    return (MinGap(), TimeToCollision(), Progress(), StuckTime(), GoalDistance())


def score(
    trace: Trace, network: RoadNetwork, *, view: RunView | None = None
) -> dict[str, float | None]:
    """Scores a run by every objective, to be minimised.

    Args:
        trace: The run.
        network: The road network of the run.
        view: An existing view of that run, with its cached values.

    Returns:
        Scores by name: that of the ego nearest to a failure; ``None`` if no ego has one. With
        several egos, ``name[ego id]`` is the score of one of them.
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
