"""The ego leaves the drivable area."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.oracles.verdict import Verdict, not_started, passed, violated


@dataclass(frozen=True, slots=True, kw_only=True)
class OffRoad:
    """Violated where a corner of the ego is outside the drivable area (nuPlan), and not by noise.

    An excess of the tolerance counts if it lasts, or if it is deep: a row or two at the tolerance
    are noise of the road's geometry, such as the corner that two lanes make in a bend.

    Attributes:
        tolerance: Metres that a corner may be outside.
        duration: Seconds for which it must be further outside to count.
        severe_distance: Metres from which on it counts however short.
    """

    tolerance: float = 0.3
    duration: float = 0.3
    severe_distance: float = 0.5

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
        longest = 0.0
        for first, last in stretches(ego.outside > self.tolerance):
            furthest = float(ego.outside[first:last].max())
            # Each row stands for a step: a single one is no excess of 0 s.
            seconds = float((last - first) * ego.step_length)
            longest = max(longest, seconds)
            if seconds < self.duration - 1e-9 and furthest < self.severe_distance:
                continue
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
        message = "Stayed on the road."
        if longest > 0.0:
            message = (
                f"Up to {furthest:.2f} m off the road, more than {self.tolerance:g} m for "
                f"{longest:.2f} s at most, which is tolerated."
            )
        return [passed(self.name, ego, message, distance=furthest, duration=longest)]
