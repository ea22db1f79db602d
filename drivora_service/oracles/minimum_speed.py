"""The ego drives slowly without a reason."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.stop_lines import stop_lines
from drivora_service.observations.leaders import leaders
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import Col, EgoCol
from drivora_service.oracles.blocked import waiting_at_signal
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_applicable,
    not_measurable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimumSpeed:
    """Violated where the ego is much slower than permitted for a long time without a reason.

    After the minimum-speed test of CARLA Leaderboard 2.0, which requires the pace of the
    surrounding traffic; here an ego without traffic is compared with its speed limit, and the
    accepted reasons are: an actor in its way, a signal that is not green, a junction that it
    approaches or is in, a bend, the start and the end of its route.

    Attributes:
        share: Of the speed limit below which the ego is slow.
        duration: Seconds for which it must be slow.
        ahead: Metres within which an actor in its way is a reason.
        junction: Metres to a stop line, or to its route's end, within which that is a reason.
        start: Seconds after its start that are not judged.
        lateral_acceleration: Lateral acceleration that is expected in bends, m/s².
    """

    share: float = 0.5
    duration: float = 5.0
    ahead: float = 40.0
    junction: float = 30.0
    start: float = 5.0
    lateral_acceleration: float = 2.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "minimum_speed"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every time that an ego was slow for too long."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        limit = ego.value(EgoCol.SPEED_LIMIT)
        if not np.isfinite(limit).any():
            return [not_measurable(self.name, ego, "No speed limit was known at any time.")]
        wanted = self.share * np.minimum(np.nan_to_num(limit), self._bend_speed(ego))
        free = ~self._has_reason(ego)
        slow = (ego.speed < wanted) & free
        verdicts = []
        for first, last in stretches(slow):
            seconds = float((last - first) * ego.step_length)
            if seconds < self.duration - 1e-9:
                continue
            mean = float(ego.speed[first:last].mean())
            verdicts.append(
                violated(
                    self.name,
                    ego,
                    first,
                    f"{mean:.1f} m/s on average for {seconds:.1f} s where {limit[first]:.1f} m/s "
                    "are allowed and nothing was in the way.",
                    severity=Severity.OBSERVATION,
                    duration=seconds,
                    until=float(ego.times[last - 1]),
                    speed=mean,
                    speed_limit=float(limit[first]),
                )
            )
        if verdicts:
            return verdicts
        longest = max((last - first for first, last in stretches(free)), default=0)
        if longest * ego.step_length < self.duration - 1e-9:
            message = f"Never without a reason to be slow for {self.duration:g} s."
            return [not_applicable(self.name, ego, message)]
        return [passed(self.name, ego, "Never slow without a reason.")]

    def _has_reason(self, ego: EgoView) -> BoolArray:
        reason: BoolArray = leaders(ego, margin=0.5).room < self.ahead
        reason |= waiting_at_signal(ego)
        reason |= ego.in_junction | self._near_line(ego)
        reason |= ego.times - ego.times[0] < self.start
        goal_x, goal_y = ego.route.goal
        away = np.hypot(ego.states[:, Col.X] - goal_x, ego.states[:, Col.Y] - goal_y)
        reason |= away < self.junction
        return reason

    def _near_line(self, ego: EgoView) -> BoolArray:
        """Returns the (n,) flags of rows in which the ego nears its lane's end at a junction."""
        lines = stop_lines(ego.network)
        near = np.zeros(ego.count, dtype=np.bool_)
        for row in np.flatnonzero(np.isin(lines.lanes, ego.lanes)).tolist():
            here = np.flatnonzero(ego.lanes == lines.lanes[row])
            away = ego.states[here][:, [Col.X, Col.Y]] - lines.points[row]
            near[here] = np.hypot(away[:, 0], away[:, 1]) < self.junction
        return near

    def _bend_speed(self, ego: EgoView) -> FloatArray:
        """Returns the (n,) m/s at which bends ahead need ``lateral_acceleration``."""
        line, arc = ego.route.line, ego.route.arc
        if len(line) < 3:
            return np.full(ego.count, np.inf)
        heading = np.unwrap(elementary.arctan2(*np.diff(line, axis=0).T[::-1]))
        middle = 0.5 * (arc[1:] + arc[:-1])
        places = np.arange(0.0, arc[-1] + 5.0, 5.0)
        at = np.interp(places, middle, heading)
        bend = np.abs(np.gradient(at, 5.0)) if len(places) > 1 else np.zeros(len(places))
        # A bend limits the speed from 30 m before it to 15 m behind it.
        around = np.pad(bend, (3, 6), constant_values=-np.inf)
        widest = np.lib.stride_tricks.sliding_window_view(around, 10).max(axis=1)
        s = np.nan_to_num(ego.value(EgoCol.ROUTE_S))
        sharp = np.interp(s, places, widest)
        speed: FloatArray = np.sqrt(self.lateral_acceleration / np.maximum(sharp, 1e-6))
        return speed
