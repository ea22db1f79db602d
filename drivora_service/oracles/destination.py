"""The ego reaches its destination, and in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col, EgoCol, TerminalEvent
from drivora_service.oracles.blocked import STANDING_SPEED, waiting_at_signal
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_measurable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Destination:
    """Violated if the ego does not reach the end of its route within the time limit.

    Not measurable if an artefact of the simulator ended its part before that.

    Arrival and the time limit, counted from the ego's start time, are those of CARLA Leaderboard.
    Its clock pauses while the ego waits at a signal that is not green, as that of ``Blocked``.

    Attributes:
        progress: Share of the route's length that must be driven.
        distance: Metres from the goal below which the ego must be.
        time_per_metre: Seconds for each metre of route.
        time_to_start: Seconds in addition.
    """

    progress: float = 0.99
    distance: float = 10.0
    time_per_metre: float = 0.8
    time_to_start: float = 5.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "destination"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns one verdict an ego."""
        return tuple(self._judge(ego) for ego in run.egos)

    def time_limit(self, ego: EgoView) -> float:
        """Returns the seconds from its start time within which an ego had to arrive.

        They include the time that it waited at signals.
        """
        return float(self._limits(ego)[-1]) if ego.count else self._allowed_seconds(ego)

    def _allowed_seconds(self, ego: EgoView) -> float:
        return self.time_per_metre * ego.route.length + self.time_to_start

    def _limits(self, ego: EgoView) -> FloatArray:
        """Returns the (n,) limits in every row, extended by the time waited at signals."""
        waiting = (ego.speed < STANDING_SPEED) & waiting_at_signal(ego)
        limits = self._allowed_seconds(ego) + np.cumsum(waiting) * ego.step_length
        left = ego.trace.max_sim_time - ego.trace.ego_start_times[ego.row]
        allowed: FloatArray = np.minimum(limits, max(left, 0.0))
        return allowed

    def _judge(self, ego: EgoView) -> Verdict:
        if not ego.count:
            return not_started(self.name, ego)
        goal_x, goal_y = ego.route.goal
        away = np.hypot(ego.states[:, Col.X] - goal_x, ego.states[:, Col.Y] - goal_y)
        done = ego.value(EgoCol.ROUTE_S) / ego.route.length
        arrived = np.flatnonzero((done > self.progress) & (away < self.distance))
        limits = self._limits(ego)
        limit = float(limits[-1])
        elapsed = ego.times - ego.times[0]
        facts: dict[str, Any] = {
            "time_limit": limit,
            "progress": float(np.nanmax(done)) if np.any(np.isfinite(done)) else None,
            "goal_distance": float(away[-1]),
        }
        if len(arrived):
            took = float(elapsed[arrived[0]])
            if took <= limits[arrived[0]] + 1e-9:
                return passed(self.name, ego, f"Arrived after {took:.1f} s.", time=took, **facts)
            return violated(
                self.name,
                ego,
                int(np.argmax(elapsed > limits)),
                f"Arrived after {took:.1f} s; the limit is {limit:.1f} s.",
                severity=Severity.MINOR,
                reason="late",
                **facts,
            )
        if ego.end is TerminalEvent.ARRIVED:
            # Egos driven by SUMO leave the road at the end of their last edge, beyond the goal.
            return passed(self.name, ego, "Left the road at the end of its route.", **facts)
        ended = f"{away[-1]:.1f} m from the goal after {elapsed[-1]:.1f} s"
        late = np.flatnonzero(elapsed > limits - 1e-9)
        if ego.artefact is not None and not len(late):
            return not_measurable(
                self.name,
                ego,
                f"Not arrived: an artefact of the simulation ended its part {ended}.",
                **facts,
            )
        if ego.end is TerminalEvent.TIME_LIMIT or len(late):
            k = int(late[0]) if len(late) else ego.count - 1
            message = f"Not arrived within the time limit: {ended}; the limit is {limit:.1f} s."
            return violated(
                self.name, ego, k, message, severity=Severity.MINOR, reason="timeout", **facts
            )
        how = ego.end.value.replace("_", " ")
        message = f"Not arrived: its part ended ({how}) {ended}."
        return violated(
            self.name,
            ego,
            ego.count - 1,
            message,
            severity=Severity.MINOR,
            reason=ego.end.value,
            **facts,
        )
