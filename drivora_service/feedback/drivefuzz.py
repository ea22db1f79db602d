"""The feedback of DriveFuzz: the quality of the driving.

Kim, Liu, Rhee, Jeon, Kwon, Kim: *DriveFuzz: Discovering Autonomous Driving Bugs through Driving
Quality-Guided Fuzzing* (CCS 2022).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from drivora_service.feedback.driving_frames import DrivingFrames, driving_frames
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

QUALITY = "driving_quality"
"""The objective: 0 for a drive without any deduction, less for a worse one."""

TERMS = "deductions"
"""The feature table: one row with the deductions of the worst ego, in the order of the sum."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivefuzzFeedback:
    """Measures the quality of the driving of the worst ego.

    It is the negated sum of the frames (a twentieth of a second each) in which the ego accelerated
    hard, braked hard, turned hard, oversteered, and understeered, and of the inverse of its least
    distance to another actor.

    Attributes:
        hard_change: m/s² from which on accelerating and braking are hard (paper: 21.2 km/h/s).
        hard_turn: m/s² across the heading from which on a turn is hard.
        steer_share: Share of the yaw rate of neutral steering by which the yaw rate differs from it
            in over- and understeer.
        steer_floor: rad/s by which it differs at least.
        steer_speed: m/s below which the steering is not judged.
        least_distance: Metres; a smaller distance counts as this one.
    """

    hard_change: Annotated[float, Field(gt=0.0)] = 21.2 / 3.6
    hard_turn: Annotated[float, Field(gt=0.0)] = 4.89
    steer_share: Annotated[float, Field(gt=0.0)] = 0.4
    steer_floor: Annotated[float, Field(gt=0.0)] = 0.05
    steer_speed: Annotated[float, Field(ge=0.0)] = 4.0
    least_distance: Annotated[float, Field(gt=0.0)] = 0.1

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (QUALITY,)

    def measure(self, run: RunView) -> Measurement:
        """Measures a run; not measurable if no ego began its part."""
        found = [self._deductions(ego) for ego in run.egos if ego.count]
        if not found:
            return Measurement(objectives={QUALITY: None}, features={TERMS: ()})
        worst = max(found, key=sum)
        # Adding 0 turns the -0 of a drive without deductions into 0.
        return Measurement(objectives={QUALITY: -sum(worst) + 0.0}, features={TERMS: (worst,)})

    def _deductions(self, ego: EgoView) -> tuple[float, ...]:
        frames = driving_frames(ego)
        over, under = self.find_over_and_understeer(frames)
        gap = ego.proximity.min_gap
        return (
            float(np.count_nonzero(frames.acceleration >= self.hard_change)),
            float(np.count_nonzero(frames.acceleration <= -self.hard_change)),
            float(np.count_nonzero(np.abs(frames.side) >= self.hard_turn)),
            float(np.count_nonzero(over)),
            float(np.count_nonzero(under)),
            0.0 if gap is None else 1.0 / max(gap, self.least_distance),
        )

    def find_over_and_understeer(self, frames: DrivingFrames) -> tuple[BoolArray, BoolArray]:
        """Returns the (n,) flags of frames with oversteer and with understeer."""
        # As if the wheels were turned to the left; straight wheels turn as the vehicle does.
        neutral = np.abs(frames.neutral)
        turn = np.where(frames.neutral < 0.0, -frames.yaw_rate, frames.yaw_rate)
        turn = np.where(frames.neutral == 0.0, np.abs(frames.yaw_rate), turn)
        judged = frames.speed >= self.steer_speed
        allowed = np.maximum(self.steer_share * neutral, self.steer_floor)
        against = judged & (turn < -self.steer_floor)
        over: BoolArray = against | (judged & (turn - neutral >= allowed))
        under: BoolArray = ~against & judged & (neutral - turn >= allowed)
        return over, under


def _create(parameters: Mapping[str, Any]) -> DrivefuzzFeedback:
    return read_parameters(DrivefuzzFeedback, parameters, of="feedback 'drivefuzz'")


DRIVEFUZZ = FeedbackPlugin(
    name="drivefuzz",
    description="the quality of the driving: hard manoeuvres, over- and understeer, closeness",
    create=_create,
)
