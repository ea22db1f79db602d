"""The ego stands in a junction, in the way of others, without a reason to wait there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import TerminalEvent
from drivora_service.oracles.blocked import STANDING_SPEED
from drivora_service.oracles.junction_stands.reasons import entered_without_room, excused_rows
from drivora_service.oracles.junction_stands.stands import JunctionStand, find_junction_stands
from drivora_service.oracles.junction_stands.waiting_vehicles import waiting_vehicles
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
class JunctionBlocking:
    """Violated where the ego stands in a junction, on a way of others, without a reason.

    Reasons are what it gives way to (a vehicle with the right of way that is about to cross its
    way, a walker on it), an actor in its way out of the junction, a signal behind the junction, and
    an accident. The clock pauses while there is one. An actor in the way is none if the ego
    entered although there was no room for it behind the junction.

    Attributes:
        standing_speed: m/s below which the ego stands.
        duration: Seconds without a reason.
        headway: Seconds within which a vehicle that goes first is a reason to wait.
        waiting: Seconds from which on another vehicle waits for the ego.
    """

    standing_speed: float = STANDING_SPEED
    duration: float = 10.0
    headway: float = 7.5
    waiting: float = 3.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "junction_blocking"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every place in a junction that an ego blocked."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        if not ego.network.path.is_file() and ego.in_junction.any():
            message = "The file of the network, which has the ways through junctions, is missing."
            return [not_measurable(self.name, ego, message)]
        verdicts = []
        longest, unfinished = 0.0, 0.0
        for stand in find_junction_stands(ego, standing_speed=self.standing_speed):
            clock = self._clock(ego, stand)
            longest = max(longest, float(clock[-1]))
            if clock[-1] >= self.duration - 1e-9:
                verdicts.append(self._make_violation(ego, stand, clock))
            elif clock[-1] > 0.0 and _is_cut_short(ego, stand, clock):
                unfinished = float(clock[-1])
        if verdicts:
            return verdicts
        if unfinished > 0.0:
            message = (
                f"Stood in a junction for {unfinished:.1f} s when its part ended; "
                f"{self.duration:g} s needed: extend max_sim_time."
            )
            return [not_measurable(self.name, ego, message, duration=unfinished)]
        if not ego.in_junction.any() and not ego.crossings:
            return [not_applicable(self.name, ego, "Drove into no junction.", duration=0.0)]
        message = f"Stood in junctions without a reason for {longest:.1f} s at most."
        return [passed(self.name, ego, message, duration=longest)]

    def _clock(self, ego: EgoView, stand: JunctionStand) -> FloatArray:
        """Returns the (k,) seconds without a reason up to each row of a stand."""
        excused = excused_rows(ego, stand, headway=self.headway)
        clock: FloatArray = np.cumsum(~excused).astype(np.float64) * ego.step_length
        return clock

    def _make_violation(self, ego: EgoView, stand: JunctionStand, clock: FloatArray) -> Verdict:
        counted = np.diff(clock, prepend=0.0) > 0.0
        rows = tuple(np.array(stand.rows)[counted].tolist())
        others = [
            one for one in waiting_vehicles(ego, stand, rows) if one.seconds >= self.waiting - 1e-9
        ]
        seconds = float(clock[-1])
        why = "having entered it without room behind it" if entered_without_room(ego, stand) else ""
        held = ", ".join(f"{one.id} for {one.seconds:.1f} s" for one in others)
        return violated(
            self.name,
            ego,
            stand.rows[int(np.argmax(clock >= self.duration - 1e-9))],
            f"Stood in junction {stand.junction} for {seconds:.1f} s without a reason"
            + (f", {why}" if why else "")
            + (f"; waiting for it: {held}." if held else "."),
            severity=Severity.MAJOR if others else Severity.MINOR,
            at_fault=True,
            counterpart=others[0].id if others else "",
            junction=stand.junction,
            duration=seconds,
            since=float(ego.times[rows[0]]),
            until=float(ego.times[rows[-1]]),
            entered_without_room=bool(why),
            waiting=[one.id for one in others],
            longest_wait=others[0].seconds if others else 0.0,
        )


def _is_cut_short(ego: EgoView, stand: JunctionStand, clock: FloatArray) -> bool:
    """Returns whether the clock still ran when the run ended."""
    running = len(clock) < 2 or clock[-1] > clock[-2]
    last = stand.rows[-1] == ego.count - 1
    return last and running and ego.end is TerminalEvent.TIME_LIMIT
