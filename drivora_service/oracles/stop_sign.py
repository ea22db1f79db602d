"""The ego drives past a stop sign without having stood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.networks.line_controls import STOPPING_LETTERS
from drivora_service.networks.road_network import Connection
from drivora_service.observations.awaited_line import awaited_ways
from drivora_service.observations.line_crossings import Crossing
from drivora_service.observations.recorded_signals import stop_shown
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import Col
from drivora_service.oracles.verdict import (
    Verdict,
    not_applicable,
    not_measurable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class StopLinePassage:
    """A passage of a line at which the ego must stop, by one of the ways that it may have taken.

    Attributes:
        row: The ego's row in which its front passed the line.
        slowest: Its least mean speed over a window before the line, m/s.
        before: Metres before the line at which it was that slow.
        ran: Whether it passed without having stood; None if not all ways require a stop.
    """

    row: int
    slowest: float
    before: float
    ran: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class StopSign:
    """Violated where the ego's front crosses a line at which its movement must stop first.

    Such movements have a stop sign or an all-way stop in the network, or a signal that shows SUMO's
    "stop, then go" (``s``) as the front crosses. The ego has stood if within ``window`` it advanced
    less than ``standing_speed`` allows, with its front at most ``reach`` before the line: the
    positions count, not the recorded speed.

    Attributes:
        standing_speed: m/s below which it stands.
        window: Seconds over which it must have stood.
        reach: Metres before the line within which it must have stood.
    """

    standing_speed: float = 0.1
    window: float = 0.5
    reach: float = 4.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "stop_sign"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every stop sign that an ego ran."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if ego.count < 2:
            return [not_started(self.name, ego)]
        passages = [
            passage for crossing in ego.crossings if (passage := self.judge_passage(ego, crossing))
        ]
        verdicts = [
            violated(
                self.name,
                ego,
                passage.row,
                f"Drove past a stop sign at {ego.speed[passage.row]:.1f} m/s; its slowest "
                f"approach was {passage.slowest:.1f} m/s, {passage.before:.1f} m before the line.",
                at_fault=True,
                speed=float(ego.speed[passage.row]),
                slowest=passage.slowest,
                slowest_before=passage.before,
            )
            for passage in passages
            if passage.ran
        ]
        lines = len(passages)
        unclear = sum(passage.ran is None for passage in passages)
        if verdicts:
            return verdicts
        if unclear:
            message = f"Crossed {unclear} lines; whether it had to stop there is unknown."
            return [not_measurable(self.name, ego, message, lines=lines, unclear=unclear)]
        if lines:
            message = f"Stood at all of {lines} stop signs."
        elif any(
            _must_stop(ego, way.connection, ego.count - 1) for way in awaited_ways(ego, self.reach)
        ):
            message = "Came to a stop sign and did not drive past it."
        else:
            return [not_applicable(self.name, ego, "No stop sign on the way.", lines=0)]
        return [passed(self.name, ego, message, lines=lines)]

    def judge_passage(self, ego: EgoView, crossing: Crossing) -> StopLinePassage | None:
        """Returns how an ego passed a line; None if it need not stop there."""
        stops = {_must_stop(ego, way.connection, crossing.front) for way in crossing.ways}
        if stops == {False}:
            return None
        slowest, before = self._slowest(ego, crossing)
        stood = slowest < self.standing_speed
        ran = None if not stood and False in stops else not stood
        return StopLinePassage(row=crossing.front, slowest=slowest, before=before, ran=ran)

    def _slowest(self, ego: EgoView, crossing: Crossing) -> tuple[float, float]:
        """Returns the least mean speed over a window before a line, m/s, and the distance left.

        An ego that started within reach of the line counts as having stood.
        """
        front = crossing.front
        way = np.cumsum(ego.moved)
        # In the preceding row, the front was not yet beyond the line.
        near = np.flatnonzero(way[front - 1] - way[: front + 1] <= self.reach)
        first = int(near[0])
        if first == 0 and ego.speed[0] < self.standing_speed:
            return 0.0, float(way[front])
        rows = min(max(round(self.window / ego.step_length), 1), front - first)
        place = ego.states[first : front + 1][:, [Col.X, Col.Y]]
        came = np.hypot(*(place[rows:] - place[:-rows]).T) / (rows * ego.step_length)
        k = int(np.argmin(came))
        return float(came[k]), float(way[front] - way[first + k + rows])


def _must_stop(ego: EgoView, connection: Connection, row: int) -> bool:
    """Returns whether a movement must stop first at its line in a row of the ego."""
    shown = stop_shown(ego, connection)
    if shown is not None:
        return bool(shown[row])
    return connection.right_of_way in STOPPING_LETTERS
