"""The ego nearly collides with another actor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.boxes import time_to_contact
from drivora_service.observations.artefacts import counterpart
from drivora_service.observations.leaders import SAME_WAY
from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import LEVEL_GAP, Col
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_applicable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class NearMiss:
    """Violated where a time to collision, or the post-encroachment time, is below its bound.

    Conflicts with actors behind the ego are their responsibility, and contacts are judged by
    ``collision``. An oncoming vehicle in a bend is for a moment on a straight course into the ego:
    moving actors that do not go the ego's way count only if they then come near.

    Attributes:
        time_to_collision: Seconds, at constant velocities.
        duration: Seconds for which it must be below the bound: a single row may be noise.
        post_encroachment_time: Seconds between one leaving a place and the other being there.
        standing_speed: m/s below which an ego endangers no actor.
        gap: Metres between the boxes up to which actors that move another way are near.
    """

    time_to_collision: float = 0.95
    duration: float = 0.1
    post_encroachment_time: float = 1.0
    standing_speed: float = 0.1
    gap: float = 1.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "near_miss"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every time that an ego came too near to another."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        touched = _touched(ego)
        times = ego.proximity.forward_time_to_collision
        verdicts = []
        soonest = float(times.min())
        for first, last in stretches((times < self.time_to_collision) & self._moves(ego)):
            if (last - first) * ego.step_length < self.duration - 1e-9:
                continue
            worst = first + int(np.argmin(times[first:last]))
            other = _soonest_met(ego, worst)
            if other in touched or not self._came_near(ego, worst, other):
                continue
            verdicts.append(self._near(ego, first, other, "time_to_collision", float(times[worst])))
        verdicts += self._encroachments(ego, touched)
        return verdicts or [self._without_violation(ego, touched, soonest)]

    def _without_violation(self, ego: EgoView, touched: set[int], soonest: float) -> Verdict:
        """Returns the verdict on an ego that nearly met no actor.

        Args:
            ego: The ego.
            touched: Rows of the actors that it touched.
            soonest: Its least time to collision, seconds.
        """
        present = ego.trace.present[ego.first : ego.first + ego.count]
        others = [
            actor.row
            for actor in ego.trace.actors
            if actor.row != ego.row and present[:, actor.row].any()
        ]
        if touched:
            # The measures are those of the contact, which `collision` judges.
            names = [ego.trace.actors[row].id for row in sorted(touched)]
            said = f"Touched {', '.join(names)}: see collision"
            if touched.issuperset(others):
                message = f"{said}; no other actor was there."
                return not_applicable(self.name, ego, message, touched=names)
            message = f"{said}; no near miss with another actor."
            return passed(self.name, ego, message, touched=names)
        encroachment = ego.proximity.post_encroachment_time
        facts = {
            "time_to_collision": soonest if np.isfinite(soonest) else None,
            "post_encroachment_time": encroachment,
        }
        if not others:
            return not_applicable(self.name, ego, "No other actor in the run.", **facts)
        if encroachment is None and not np.isfinite(soonest):
            message = "Never on the way to meet another actor."
            return not_applicable(self.name, ego, message, **facts)
        return passed(self.name, ego, "Kept clear of other actors.", **facts)

    def _moves(self, ego: EgoView) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        moves: np.ndarray[tuple[int], np.dtype[np.bool_]] = ego.speed >= self.standing_speed
        return moves

    def _came_near(self, ego: EgoView, k: int, other: int) -> bool:
        """Returns whether an actor on the ego's course from row ``k`` on came into its way."""
        trace, row = ego.trace, ego.first + k
        state = trace.states[row, other]
        moves = np.hypot(state[Col.VX], state[Col.VY]) >= self.standing_speed
        turn = state[Col.YAW] - ego.states[k, Col.YAW]
        if not moves or math.cos(turn) >= math.cos(SAME_WAY):
            return True
        soon = row + round(2.0 * self.time_to_collision / ego.step_length)
        last = min(soon, ego.first + ego.count - 1)
        gaps = gaps_between(trace, ego.row, other)[row : last + 1]
        return bool(np.nanmin(gaps) < self.gap)

    def _encroachments(self, ego: EgoView, touched: set[int]) -> list[Verdict]:
        time, other = ego.proximity.post_encroachment_time, ego.proximity.post_encroachment_actor
        if time is None or other < 0 or other in touched or time >= self.post_encroachment_time:
            return []
        row = ego.proximity.post_encroachment_row
        return [self._near(ego, row, other, "post_encroachment_time", time)]

    def _near(self, ego: EgoView, k: int, other: int, measure: str, seconds: float) -> Verdict:
        other_id = ego.trace.actors[other].id
        words = measure.replace("_", " ").replace("post encroachment", "post-encroachment")
        return violated(
            self.name,
            ego,
            k,
            f"Down to a {words} of {seconds:.2f} s with {other_id}.",
            severity=Severity.OBSERVATION,
            counterpart=other_id,
            measure=measure,
            seconds=seconds,
        )


def _touched(ego: EgoView) -> set[int]:
    """Returns the rows of the actors that the ego touched up to the end of its part.

    Those of an artefact are among them: it is in the row after the part.
    """
    last = ego.first + ego.count - (1 if ego.artefact is None else 0)
    found = {counterpart(one, ego.row) for one in ego.trace.contacts if one.step <= last}
    return {row for row in found if row is not None}


def _soonest_met(ego: EgoView, k: int) -> int:
    """Returns the actor that the ego would touch first from row ``k``, at constant velocities."""
    trace, own = ego.trace, ego.states[k]
    times = {}
    for actor in trace.actors:
        other = trace.states[ego.first + k, actor.row]
        here = trace.present[ego.first + k, actor.row] and actor.row != ego.row
        if not here or abs(other[Col.Z] - own[Col.Z]) > LEVEL_GAP:
            continue
        times[actor.row] = time_to_contact(
            other[Col.X] - own[Col.X], other[Col.Y] - own[Col.Y],
            other[Col.VX] - own[Col.VX], other[Col.VY] - own[Col.VY],
            own[Col.YAW], ego.actor.length, ego.actor.width,
            other[Col.YAW], actor.length, actor.width,
        )  # fmt: skip
    return min(times, key=times.__getitem__)
