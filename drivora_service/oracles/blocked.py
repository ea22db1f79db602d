"""The ego is stuck: it stands for a long time without a signal to wait for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.observations.recorded_signals import off_route, waiting_off_route
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import EgoCol, Light, TerminalEvent
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_measurable,
    not_started,
    passed,
    violated,
)

STANDING_SPEED = 0.1
"""m/s below which a vehicle stands (Leaderboard, Bench2Drive)."""

QUEUE_REACH = 100.0
"""Metres before a stop line within which a vehicle that stands may be waiting for its signal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Blocked:
    """Violated where the ego stands for a minute (Bench2Drive).

    The clock pauses while the ego waits at a signal that is not green, also in the queue before it,
    and starts anew when the ego moves. So a queue that dissolves is not a block, and an ego that
    misses every green phase is blocked.

    Attributes:
        standing_speed: m/s below which the ego stands.
        duration: Seconds.
        queue_reach: Metres before a stop line within which it may be waiting for the signal.
    """

    standing_speed: float = STANDING_SPEED
    duration: float = 60.0
    queue_reach: float = QUEUE_REACH

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "blocked"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every time that an ego was stuck."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        standing = ego.speed < self.standing_speed
        clock = standing_clock(ego, self.standing_speed, self.queue_reach)
        verdicts = []
        for first, last in stretches(standing):
            if clock[last - 1] >= self.duration - 1e-9:
                seconds = float(clock[last - 1])
                verdicts.append(
                    violated(
                        self.name,
                        ego,
                        first + int(np.argmax(clock[first:last] >= self.duration - 1e-9)),
                        f"Stood for {seconds:.1f} s without a signal to wait for.",
                        duration=seconds,
                        until=float(ego.times[last - 1]),
                        since=float(ego.times[first]),
                        severity=Severity.MINOR,
                    )
                )
        if verdicts:
            return verdicts
        longest = float(clock.max())
        cut_short = ego.end is TerminalEvent.TIME_LIMIT and ego.duration < self.duration
        if (cut_short and standing[-1]) or ego.end is TerminalEvent.STUCK:
            return [
                not_measurable(
                    self.name,
                    ego,
                    f"Stood for {clock[-1]:.1f} s when its part ended; {self.duration:g} s needed: "
                    "extend max_sim_time and stuck_after.",
                    duration=longest,
                )
            ]
        return [passed(self.name, ego, f"Stood for {longest:.1f} s at most.", duration=longest)]


def waiting_at_signal(ego: EgoView, queue_reach: float = QUEUE_REACH) -> BoolArray:
    """Returns the (n,) flags of rows in which the next signal is near and not green.

    For an ego on its route that is the route's next signal, off it the next on the ego's lane.
    """
    off = off_route(ego)
    near = ego.value(EgoCol.LIGHT_DISTANCE) < queue_reach
    waiting: BoolArray = near & (ego.lights >= Light.YELLOW) & ~off
    standing = ego.speed < STANDING_SPEED
    if np.any(off & standing):
        waiting |= waiting_off_route(ego, off & standing, queue_reach)
    return waiting


def standing_clock(
    ego: EgoView,
    standing_speed: float = STANDING_SPEED,
    queue_reach: float = QUEUE_REACH,
) -> FloatArray:
    """Returns the (n,) seconds of standing without a signal to wait for, 0 in motion."""
    standing = ego.speed < standing_speed
    counted = standing & ~waiting_at_signal(ego, queue_reach)
    total = np.cumsum(counted) * ego.step_length
    clock = np.zeros(ego.count)
    for first, last in stretches(standing):
        before = total[first - 1] if first else 0.0
        clock[first:last] = total[first:last] - before
    return clock
