"""The ego leaves its route."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.observations.run_view import EgoView, RunView
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
class RouteDeviation:
    """Violated once the ego is far off its route, or has driven long beside it (Leaderboard).

    Attributes:
        far: Metres from the reference line that violate the oracle immediately.
        beside: Metres from the reference line from which on the ego is beside its route.
        share: Of the route's length that may be driven beside it.
    """

    far: float = 30.0
    beside: float = 15.0
    share: float = 0.3

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "route_deviation"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns one verdict an ego."""
        return tuple(self._judge(ego) for ego in run.egos)

    def _judge(self, ego: EgoView) -> Verdict:
        if not ego.count:
            return not_started(self.name, ego)
        lateral = np.abs(ego.value(EgoCol.ROUTE_LATERAL))
        if not np.isfinite(lateral).any():
            return not_measurable(self.name, ego, "The distance from the route was not recorded.")
        beside = np.cumsum(np.where(lateral > self.beside, ego.moved, 0.0))
        allowed = self.share * ego.route.length
        worst = float(np.nanmax(lateral))
        wrong = (lateral > self.far) | (beside > allowed)
        if not wrong.any():
            return passed(
                self.name,
                ego,
                f"At most {worst:.1f} m from its route.",
                distance=worst,
                beside=float(beside[-1]),
            )
        k = int(np.argmax(wrong))
        return violated(
            self.name,
            ego,
            k,
            f"{lateral[k]:.1f} m from its route, after {beside[k]:.1f} m beside it.",
            severity=Severity.MINOR,
            at_fault=True,
            distance=worst,
            beside=float(beside[-1]),
        )
