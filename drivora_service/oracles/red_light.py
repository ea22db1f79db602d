"""The ego drives over a stop line while its signal is red."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import ByteArray
from drivora_service.observations.awaited_line import awaited_ways
from drivora_service.observations.line_crossings import Crossing
from drivora_service.observations.recorded_signals import BESIDE_ROUTE, signal_shown
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import EgoCol, Light
from drivora_service.oracles.verdict import (
    Verdict,
    not_applicable,
    not_measurable,
    not_started,
    passed,
    violated,
)

_SAME_PLACE = 0.1
"""Metres by which the place of a stop line on the route may differ between rows."""

_SAME_LINE = 5.0
"""Metres along the way within which a crossing on the route and one on the road are the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Passage:
    """A stop line that the tail has crossed.

    Attributes:
        front: Row in which the front is first beyond it.
        tail: Row in which the tail is first beyond it.
        shown: (n,) ``Light`` of the ego's movement, by row; ``None`` if it is unknown.
    """

    front: int
    tail: int
    shown: ByteArray | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RedLight:
    """Violated where the ego's tail crosses a stop line on red (CARLA Leaderboard).

    Every stop line of the network counts that the ego drives over along its lane, on the route or
    off it; where the ego leaves its lane to drive past the line of its route, that line counts as
    well. A vehicle whose front has passed on green or yellow and whose tail follows on red has
    violated the oracle, as in the Leaderboard.

    Attributes:
        seen_within: Metres before the stop line within which the front bumper must have been at
            some time; a signal that the ego never approached does not apply to it.
    """

    seen_within: float = 15.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "red_light"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for each signal that an ego ran."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if ego.count < 2:
            return [not_started(self.name, ego)]
        passages = self._passages(ego)
        unclear = sum(passage.shown is None for passage in passages)
        verdicts = [
            self._make_violation(ego, passage, passage.shown)
            for passage in passages
            if passage.shown is not None and passage.shown[passage.tail] == Light.RED
        ]
        if verdicts:
            return verdicts
        facts = {"lines": len(passages), "unclear": unclear}
        if unclear:
            message = (
                f"Crossed {unclear} of {len(passages)} stop lines whose signal is unknown: the ego "
                "followed no movement from them."
            )
            return [not_measurable(self.name, ego, message, **facts)]
        if passages:
            message = f"Crossed {len(passages)} stop lines, none on red."
        elif self._came_to_signal(ego):
            message = "Came to a signal and did not drive past its stop line."
        else:
            message = "No stop line with a signal on the way."
            return [not_applicable(self.name, ego, message, **facts)]
        return [passed(self.name, ego, message, **facts)]

    def _came_to_signal(self, ego: EgoView) -> bool:
        """Returns whether the ego was at a stop line with a signal when its part ended.

        Its front was near the line, or beyond it while its tail was not.
        """
        if any(one.tail is None and _find_signal_state(ego, one)[0] for one in ego.crossings):
            return True
        distance = float(ego.value(EgoCol.LIGHT_DISTANCE)[-1])
        lateral = abs(float(ego.value(EgoCol.ROUTE_LATERAL)[-1]))
        if -ego.actor.length <= distance <= self.seen_within and lateral <= BESIDE_ROUTE:
            return True
        ways = awaited_ways(ego, self.seen_within)
        return any(signal_shown(ego, way.connection) is not None for way in ways)

    def _make_violation(self, ego: EgoView, passage: _Passage, shown: ByteArray) -> Verdict:
        last = passage.tail
        red_since = last
        while red_since > 0 and shown[red_since - 1] == Light.RED:
            red_since -= 1
        red_for = float(ego.times[last] - ego.times[red_since])
        return violated(
            self.name,
            ego,
            last,
            f"The tail crossed the stop line at {ego.speed[last]:.1f} m/s, when the signal "
            f"had been red for {red_for:.1f} s.",
            at_fault=True,
            speed=float(ego.speed[last]),
            red_for=red_for,
            front_crossed_on=Light(int(shown[passage.front])).name.lower(),
        )

    def _passages(self, ego: EgoView) -> list[_Passage]:
        """Returns the signalised stop lines that the tail crossed, each once, in order of time."""
        way = np.cumsum(ego.moved)
        along = self._along_route(ego)
        passages = []
        for crossing in ego.crossings:
            if crossing.tail is None:
                continue
            signalised, shown = _find_signal_state(ego, crossing)
            if not signalised:
                continue
            same = [
                passage
                for passage in along
                if abs(way[passage.tail] - way[crossing.tail]) <= _SAME_LINE
            ]
            if same:
                nearest = min(same, key=lambda one: abs(way[one.tail] - way[crossing.tail or 0]))
                along.remove(nearest)
                if shown is None:
                    shown = nearest.shown
            passages.append(_Passage(front=crossing.front, tail=crossing.tail, shown=shown))
        return sorted([*passages, *along], key=lambda passage: passage.tail)

    def _along_route(self, ego: EgoView) -> list[_Passage]:
        """Returns the stop lines of the route that the ego passed, on its lane or beside it."""
        distance = ego.value(EgoCol.LIGHT_DISTANCE)
        lateral = np.abs(ego.value(EgoCol.ROUTE_LATERAL))
        passages = []
        for start, last, tail in _stretches(ego):
            seen = distance[start : last + 1]
            approached = np.any((seen >= 0.0) & (seen <= self.seen_within))
            # The trace records one signal at a time: one close behind another appears under the
            # ego.
            concealed = start > 0 and distance[start - 1] < 0.0
            if not (approached or concealed) or lateral[tail] > BESIDE_ROUTE:
                continue
            shown = ego.lights.copy()
            shown[:start] = Light.NONE
            shown[last:] = shown[last]
            front = start + int(np.argmax(seen < 0.0))
            passages.append(_Passage(front=front, tail=tail, shown=shown))
        return passages


def _find_signal_state(ego: EgoView, crossing: Crossing) -> tuple[bool, ByteArray | None]:
    """Returns whether a line has a signal, and its state by row; ``None`` if that is unknown.

    It is unknown, too, while the tail has not crossed the line.
    """
    all_shown = [signal_shown(ego, way.connection) for way in crossing.ways]
    known = [shown for shown in all_shown if shown is not None]
    if not known:
        return False, None
    if len(known) < len(all_shown) or crossing.tail is None:
        return True, None
    red = {bool(shown[crossing.tail] == Light.RED) for shown in known}
    return True, known[0] if len(red) == 1 else None


def _stretches(ego: EgoView) -> list[tuple[int, int, int]]:
    """Returns, for every stop line of the route that the tail crossed, its rows.

    The distance falls below zero as the front passes the line, and refers to the next signal as
    soon as the tail has passed. The position of the line on the route, which is the distance plus
    the ego's own, distinguishes the signals.

    Returns:
        First and last row that refer to the signal, and the first with the tail beyond the line.
    """
    distance = ego.value(EgoCol.LIGHT_DISTANCE)
    known = ~np.isnan(distance)
    place = distance + ego.value(EgoCol.ROUTE_S)
    same = np.abs(np.diff(place)) < _SAME_PLACE
    begins = np.flatnonzero(known & ~np.concatenate(([False], same)))
    ends = np.flatnonzero(known & ~np.concatenate((same, [False]))) + 1
    passages = []
    for start, stop in zip(begins.tolist(), ends.tolist(), strict=True):
        last = stop - 1
        gone = np.flatnonzero(distance[start:stop] <= -ego.actor.length)
        if len(gone):
            row = start + int(gone[0])
            passages.append((start, row, row))
        elif stop < ego.count and distance[last] < 0.0:
            came = ego.value(EgoCol.ROUTE_S)[stop] - ego.value(EgoCol.ROUTE_S)[last]
            if distance[last] - came <= -ego.actor.length + _SAME_PLACE:
                passages.append((start, last, stop))
    return passages
