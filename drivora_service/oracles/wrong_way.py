"""The ego drives against the direction of its lane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import Col, EgoCol
from drivora_service.oracles.verdict import (
    Verdict,
    not_applicable,
    not_measurable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class WrongWay:
    """Violated where the ego moves against its lane's direction (nuPlan's driving direction).

    Rows inside junctions, where lanes of many directions overlap, and rows off every lane count as
    no movement.

    Attributes:
        window: Seconds over which the movement along the lane is summed.
        distance: Metres against the lane within the window that are allowed.
        severe_distance: Metres from which on ``severe`` is set in the evidence.
    """

    window: float = 1.0
    distance: float = 2.0
    severe_distance: float = 6.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "wrong_way"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every time that an ego drove against its lane."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        known = np.isfinite(ego.value(EgoCol.LANE_HEADING))
        if not known.any():
            return [not_measurable(self.name, ego, "The ego was never on a lane.")]
        against = backwards(ego, self.window)
        verdicts = []
        for first, last in stretches(against > self.distance):
            worst = float(against[first:last].max())
            severe = worst > self.severe_distance
            verdicts.append(
                violated(
                    self.name,
                    ego,
                    first,
                    f"Drove {worst:.1f} m against its lane within {self.window:g} s"
                    f"{' (severe)' if severe else ''}.",
                    at_fault=True,
                    distance=worst,
                    severe=severe,
                )
            )
        if verdicts:
            return verdicts
        distance = float(max(against.max(), 0.0))
        if not (known & ~ego.in_junction).any():
            message = "Was on no lane outside junctions."
            return [not_applicable(self.name, ego, message, distance=distance)]
        return [passed(self.name, ego, "Kept the direction of its lanes.", distance=distance)]


def backwards(ego: EgoView, window: float) -> FloatArray:
    """Returns the (n,) metres moved against the lane within the last ``window`` seconds.

    Negative where the ego moved along its lane.
    """
    heading = ego.value(EgoCol.LANE_HEADING)
    steps = np.diff(ego.states[:, [Col.X, Col.Y]], axis=0)
    along = steps[:, 0] * elementary.cos(heading[1:]) + steps[:, 1] * elementary.sin(heading[1:])
    along[~np.isfinite(along) | ego.in_junction[1:]] = 0.0
    total = np.concatenate(([0.0], np.cumsum(along)))
    rows = max(round(window / ego.step_length), 1)
    before = np.concatenate((np.zeros(min(rows, ego.count)), total[:-rows]))[: ego.count]
    against: FloatArray = before - total
    return against
