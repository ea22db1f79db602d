"""The ego leaves the drivable area."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.oracles.verdict import Verdict, not_started, passed, violated


@dataclass(frozen=True, slots=True, kw_only=True)
class OffRoad:
    """Violated where a corner of the ego is outside the drivable area (nuPlan).

    Attributes:
        tolerance: Metres that a corner may be outside.
    """

    tolerance: float = 0.3

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "off_road"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every time that an ego left the road."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        verdicts = []
        for first, last in stretches(ego.outside > self.tolerance):
            furthest = float(ego.outside[first:last].max())
            seconds = float(ego.times[last - 1] - ego.times[first])
            verdicts.append(
                violated(
                    self.name,
                    ego,
                    first,
                    f"Up to {furthest:.2f} m off the road for {seconds:.1f} s.",
                    at_fault=True,
                    distance=furthest,
                    duration=seconds,
                    until=float(ego.times[last - 1]),
                )
            )
        if verdicts:
            return verdicts
        furthest = float(ego.outside.max())
        return [passed(self.name, ego, "Stayed on the road.", distance=furthest)]
