"""The ego drives over a stop line while its signal is red."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import EgoCol, Light
from drivora_service.oracles.verdict import Verdict, not_started, passed, violated

_SAME_PLACE = 0.1
"""Metres by which the place of a stop line on the route may differ from row to row."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RedLight:
    """Violated where the ego's tail crosses a stop line on red (CARLA Leaderboard).

    A vehicle whose front has passed on green or yellow and whose tail follows on red has violated
    the rule as well: that is how the Leaderboard counts.

    Attributes:
        seen_within: Metres before the stop line within which the front bumper must have been at
            some time; a signal that the ego never approached is not its signal.
    """

    seen_within: float = 15.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "red_light"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Gives a verdict for each signal that an ego ran."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if ego.count < 2:
            return [not_started(self.name, ego)]
        verdicts = []
        crossings = 0
        for start, last in _passages(ego):
            distance = ego.value(EgoCol.LIGHT_DISTANCE)[start : last + 1]
            approached = np.any((distance >= 0.0) & (distance <= self.seen_within))
            # The trace shows one signal at a time: one close behind another appears under the ego.
            concealed = start > 0 and ego.value(EgoCol.LIGHT_DISTANCE)[start - 1] < 0.0
            if not (approached or concealed):
                continue
            crossings += 1
            if ego.lights[last] != Light.RED:
                continue
            red_since = last
            while red_since > start and ego.lights[red_since - 1] == Light.RED:
                red_since -= 1
            red_for = float(ego.times[last] - ego.times[red_since])
            front = start + int(np.argmax(distance < 0.0))
            verdicts.append(
                violated(
                    self.name,
                    ego,
                    last,
                    f"The tail crossed the stop line at {ego.speed[last]:.1f} m/s, when the signal "
                    f"had been red for {red_for:.1f} s.",
                    at_fault=True,
                    speed=float(ego.speed[last]),
                    red_for=red_for,
                    front_crossed_on=Light(int(ego.lights[front])).name.lower(),
                )
            )
        return verdicts or [
            passed(self.name, ego, f"Crossed {crossings} stop lines, none on red.", lines=crossings)
        ]


def _passages(ego: EgoView) -> list[tuple[int, int]]:
    """Gives, for every stop line that the tail crossed, the rows that speak of its signal.

    The distance falls below zero as the front passes the line, and speaks of the next signal as
    soon as the tail has passed. The place of the line on the route, which is the distance ahead of
    the ego's own, tells one signal from the next.
    """
    distance = ego.value(EgoCol.LIGHT_DISTANCE)
    known = ~np.isnan(distance)
    place = distance + ego.value(EgoCol.ROUTE_S)
    same = np.abs(np.diff(place)) < _SAME_PLACE
    begins = np.flatnonzero(known & ~np.concatenate(([False], same)))
    ends = np.flatnonzero(known & ~np.concatenate((same, [False]))) + 1
    passages = []
    for start, stop in zip(begins, ends, strict=True):
        last = int(stop) - 1
        gone = np.flatnonzero(distance[start:stop] <= -ego.actor.length)
        if len(gone):
            passages.append((int(start), int(start + gone[0])))
        elif stop < ego.count and distance[last] < 0.0:
            came = ego.value(EgoCol.ROUTE_S)[stop] - ego.value(EgoCol.ROUTE_S)[last]
            if distance[last] - came <= -ego.actor.length + _SAME_PLACE:
                passages.append((int(start), last))
    return passages
