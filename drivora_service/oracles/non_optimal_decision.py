"""The ego takes another path than the reference path, although that is free."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.observations.reference_path import (
    distances_to_line,
    line_of,
    path_overlap,
    poses_at,
    reference_of,
)
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import LEVEL_GAP, Col, PoseCol, SizeCol, TerminalEvent
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
class NonOptimalDecision:
    """Violated if an ego arrives on another path than its reference path, which was free.

    The reference path is that of an ADS in another scenario, and part of this one. It was free if
    the ego on it, at its places and times, would not have touched any recorded actor.

    Source: Cheng, Zhou, Xie, Wang, Meng, Yang, "Decictor: Towards Evaluating the Robustness of
    Decision-Making in Autonomous Driving Systems" (ICSE 2025).

    Attributes:
        overlap: Share of the pieces of both paths that are shared, from which down it is another
            path.
        piece: Metres of a piece.
        half_width: Metres from a path up to which a piece of the other is shared.
        ends: Metres up to which both paths begin and end at the same places; beyond that, the
            reference path is of another task.
    """

    overlap: float = 0.6
    piece: float = 2.0
    half_width: float = 1.6
    ends: float = 15.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "non_optimal_decision"

    def applies(self, run: RunView) -> bool:
        """Returns whether any ego of the scenario has a reference path."""
        return bool(run.trace.references)

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns one verdict an ego."""
        return tuple(self._judge(ego) for ego in run.egos)

    def _judge(self, ego: EgoView) -> Verdict:
        if not ego.count:
            return not_started(self.name, ego)
        reference = reference_of(ego)
        if reference is None:
            return not_applicable(self.name, ego, "The scenario gives it no reference path.")
        if ego.end is not TerminalEvent.ARRIVED:
            how = ego.end.value.replace("_", " ")
            return not_measurable(
                self.name, ego, f"It did not arrive ({how}), which other oracles judge.", end=how
            )
        own, line = ego.states[:, [Col.X, Col.Y]], line_of(reference)
        apart = np.hypot(*(own[[0, -1]] - line[[0, -1]]).T)
        if (apart > self.ends).any():
            where = "begins" if apart[0] > self.ends else "ends"
            return not_measurable(
                self.name,
                ego,
                f"The reference path is of another task: it {where} {apart.max():.1f} m from the "
                "ego's.",
            )
        overlap, difference = path_overlap(own, line, piece=self.piece, half_width=self.half_width)
        facts: dict[str, Any] = {
            "overlap": overlap,
            "path_difference": difference,
            "added_time": float(ego.times[-1] - reference[-1, PoseCol.TIME]),
        }
        shared = f"Its path and the reference path share {100.0 * overlap:.0f} %"
        if overlap > self.overlap:
            return passed(self.name, ego, f"{shared}.", **facts)
        row, other = replay_contact(ego, reference)
        if row >= 0:
            actor = ego.trace.actors[other].id
            time = float(ego.times[row])
            return not_measurable(
                self.name,
                ego,
                f"{shared}, but on the reference path it would have touched {actor!r} at "
                f"{time:.2f} s.",
                blocked_by=actor,
                blocked_at=time,
                **facts,
            )
        aside = distances_to_line(own, line)
        left = np.flatnonzero(aside > self.half_width)
        k = int(left[0]) if len(left) else ego.count - 1
        return violated(
            self.name,
            ego,
            k,
            f"{shared}, which was free; it was up to {difference:.1f} m beside it.",
            severity=Severity.MINOR,
            at_fault=True,
            **facts,
        )


def replay_contact(ego: EgoView, reference: FloatArray) -> tuple[int, int]:
    """Moves an ego along a reference path through the recorded actors, to its recorded end.

    Args:
        ego: The ego, for its size and its part of the trace.
        reference: (p, 6) its reference path.

    Returns:
        The first row of the ego's part in which it touches an actor, and the row of that actor in
        the trace; -1 and -1 if it touches none.
    """
    last = reference[-1, PoseCol.TIME]
    times = ego.times[ego.times <= last + 1e-9]
    trace = ego.trace
    sizes = np.array([(actor.length, actor.width) for actor in trace.actors], dtype=np.float64)
    part = slice(ego.first, ego.first + len(times))
    return _first_contact(
        poses_at(reference, times), ego.row, trace.states[part], trace.present[part], sizes
    )


@compiled
def _first_contact(
    poses: FloatArray, row: int, states: FloatArray, present: BoolArray, sizes: FloatArray
) -> tuple[int, int]:
    for t in range(poses.shape[0]):
        pose = poses[t]
        for j in range(states.shape[1]):
            other = states[t, j]
            if j == row or not present[t, j]:
                continue
            if abs(other[Col.Z] - pose[PoseCol.Z]) > LEVEL_GAP:
                continue
            if boxes_overlap(
                pose[PoseCol.X], pose[PoseCol.Y], pose[PoseCol.YAW],
                sizes[row, SizeCol.LENGTH], sizes[row, SizeCol.WIDTH],
                other[Col.X], other[Col.Y], other[Col.YAW],
                sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH],
            ):  # fmt: skip
                return t, j
    return -1, -1
