"""The ego exceeds the speed limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import EgoCol
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_measurable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Speeding:
    """Violated where the ego exceeds its lane's limit for longer than ``duration``.

    Attributes:
        excess: Share of the limit that may be exceeded.
        duration: Seconds for which a higher speed is tolerated.
    """

    excess: float = 0.05
    duration: float = 3.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "speeding"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every violation of the speed limit."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        limit = ego.value(EgoCol.SPEED_LIMIT)
        if not np.isfinite(limit).any():
            return [not_measurable(self.name, ego, "No speed limit was known.")]
        over = overspeed(ego)
        total = float(over.sum() * ego.step_length)
        verdicts = []
        for first, last in stretches(over > self.excess * np.nan_to_num(limit)):
            seconds = float(ego.times[last - 1] - ego.times[first])
            if seconds < self.duration - 1e-9:
                continue
            worst = first + int(np.argmax(over[first:last]))
            verdicts.append(
                violated(
                    self.name,
                    ego,
                    first,
                    f"Up to {ego.speed[worst]:.1f} m/s where {limit[worst]:.1f} m/s are allowed, "
                    f"for {seconds:.1f} s.",
                    severity=Severity.MINOR,
                    at_fault=True,
                    duration=seconds,
                    until=float(ego.times[last - 1]),
                    speed=float(ego.speed[worst]),
                    speed_limit=float(limit[worst]),
                    excess_integral=float(over[first:last].sum() * ego.step_length),
                    total_excess_integral=total,
                )
            )
        return verdicts or [
            passed(self.name, ego, "Kept the speed limits.", total_excess_integral=total)
        ]


def overspeed(ego: EgoView) -> FloatArray:
    """Returns the (n,) m/s by which the ego exceeded the limit, 0 where none is known."""
    excess: FloatArray = np.nan_to_num(ego.speed - ego.value(EgoCol.SPEED_LIMIT), nan=0.0)
    return np.maximum(excess, 0.0)
