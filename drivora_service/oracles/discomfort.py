"""The ego's motion exceeds the bounds of passenger comfort."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_measurable,
    not_started,
    passed,
    violated,
)

if TYPE_CHECKING:
    from drivora_service.observations.motion import FilteredMotion


@dataclass(frozen=True, slots=True, kw_only=True)
class Discomfort:
    """Violated where a filtered signal leaves its bounds (nuPlan; Bench2Drive has the same).

    Attributes:
        min_longitudinal_acceleration: m/s².
        max_longitudinal_acceleration: m/s².
        max_lateral_acceleration: m/s², to either side.
        max_yaw_rate: rad/s, to either side.
        max_yaw_acceleration: rad/s², to either side.
        max_longitudinal_jerk: m/s³, in either direction.
        max_jerk: m/s³, in either direction.
    """

    min_longitudinal_acceleration: float = -4.05
    max_longitudinal_acceleration: float = 2.40
    max_lateral_acceleration: float = 4.89
    max_yaw_rate: float = 0.95
    max_yaw_acceleration: float = 1.93
    max_longitudinal_jerk: float = 4.13
    max_jerk: float = 8.37

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "discomfort"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns one verdict an ego."""
        return tuple(self._judge(ego) for ego in run.egos)

    def _judge(self, ego: EgoView) -> Verdict:
        if not ego.count:
            return not_started(self.name, ego)
        if ego.motion is None:
            return not_measurable(self.name, ego, "The run is too short for the filters.")
        broken = self.find_exceeded_bounds(ego.motion)
        rough = np.any(list(broken.values()), axis=0)
        share = float(rough.mean())
        worst = {
            "min_longitudinal_acceleration": float(ego.motion.longitudinal_acceleration.min()),
            "max_longitudinal_acceleration": float(ego.motion.longitudinal_acceleration.max()),
            "max_lateral_acceleration": _peak(ego.motion.lateral_acceleration),
            "max_yaw_rate": _peak(ego.motion.yaw_rate),
            "max_yaw_acceleration": _peak(ego.motion.yaw_acceleration),
            "max_longitudinal_jerk": _peak(ego.motion.longitudinal_jerk),
            "max_jerk": _peak(ego.motion.jerk),
        }
        if not rough.any():
            return passed(self.name, ego, "Comfortable throughout.", share=0.0, worst=worst)
        names = [name for name, flags in broken.items() if flags.any()]
        return violated(
            self.name,
            ego,
            int(np.argmax(rough)),
            f"Rough for {100.0 * share:.1f} % of the time: {', '.join(names)}.",
            share=share,
            bounds=names,
            worst=worst,
            severity=Severity.OBSERVATION,
        )

    def find_exceeded_bounds(self, motion: FilteredMotion) -> dict[str, BoolArray]:
        """Returns for each signal the (n,) flags of rows in which it is out of its bounds."""
        ahead = motion.longitudinal_acceleration
        return {
            "longitudinal acceleration": (ahead < self.min_longitudinal_acceleration)
            | (ahead > self.max_longitudinal_acceleration),
            "lateral acceleration": np.abs(motion.lateral_acceleration)
            > self.max_lateral_acceleration,
            "yaw rate": np.abs(motion.yaw_rate) > self.max_yaw_rate,
            "yaw acceleration": np.abs(motion.yaw_acceleration) > self.max_yaw_acceleration,
            "longitudinal jerk": np.abs(motion.longitudinal_jerk) > self.max_longitudinal_jerk,
            "jerk": np.abs(motion.jerk) > self.max_jerk,
        }


def _peak(signal: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    return float(np.abs(signal).max())
