"""The feedback of Decictor: how far a run's path and motion are from those of the reference.

Cheng, Zhou, Xie, Wang, Meng, Yang, *Decictor: Towards Evaluating the Robustness of Decision-Making
in Autonomous Driving Systems* (ICSE 2025).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.reference_path import (
    line_of,
    path_overlap,
    poses_at,
    recorded_path,
    reference_of,
)
from drivora_service.observations.trace import Col, PoseCol, TerminalEvent
from drivora_service.oracles.non_optimal_decision import replay_contact
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

CONSISTENCY = "consistency"
"""The objective: at most 0; the smaller it is, the more a run differs from its reference."""

REFERENCE = "reference_path"
"""The feature table of a run without references: rows (ego, time, x, y, heading, speed, height) of
the paths of its egos; empty unless all of them have arrived."""

Positive = Annotated[float, Field(gt=0.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class DecictorFeedback:
    """Measures the ego that differs most from its reference path.

    The objective is the negative sum of three differences: the greatest distance of the two paths
    (Hausdorff, in metres), the share of both paths that they do not have in common, and `weight`
    times the maximum mean discrepancy of heading, speed and acceleration. An ego that did not
    arrive, or whose reference path was not free, is not measurable.

    Attributes:
        piece: Metres of the pieces in which paths are compared.
        half_width: Metres from a path up to which a piece of the other is shared.
        sample: Seconds between the samples of the motion.
        speed: m/s that count as much as a turn by 1 rad.
        acceleration: m/s² that count as much as a turn by 1 rad.
        bandwidth: Standard deviation of the Gaussian kernel, in those units.
        weight: Metres of distance that a discrepancy of 1 counts as.
    """

    piece: Positive = 2.0
    half_width: Positive = 1.6
    sample: Positive = 0.25
    speed: Positive = 12.0
    acceleration: Positive = 10.0
    bandwidth: Positive = 0.25
    weight: Annotated[float, Field(ge=0.0)] = 10.0

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (CONSISTENCY,)

    def measure(self, run: RunView) -> Measurement:
        """Returns the least consistency of an ego; without references, the driven paths."""
        if not run.trace.references:
            return Measurement(objectives={CONSISTENCY: None}, features={REFERENCE: _paths(run)})
        values = [
            self._consistency(ego, reference)
            for ego in run.egos
            if (reference := reference_of(ego)) is not None and _is_comparable(ego, reference)
        ]
        least = min(values, default=None)
        return Measurement(objectives={CONSISTENCY: least}, features={REFERENCE: ()})

    def _consistency(self, ego: EgoView, reference: FloatArray) -> float:
        own = recorded_path(ego)
        overlap, distance = path_overlap(
            ego.states[:, [Col.X, Col.Y]],
            line_of(reference),
            piece=self.piece,
            half_width=self.half_width,
        )
        discrepancy = mean_discrepancy(self._motion(own), self._motion(reference), self.bandwidth)
        return -(distance + (1.0 - overlap) + self.weight * discrepancy)

    def _motion(self, path: FloatArray) -> FloatArray:
        """Returns (n, 4) samples: cosine and sine of the heading, scaled speed and acceleration."""
        begin, end = path[[0, -1], PoseCol.TIME]
        times = np.arange(begin, end + 1e-9, self.sample)
        poses = poses_at(path, times)
        speed = poses[:, PoseCol.SPEED]
        gained = np.gradient(speed, self.sample) if len(speed) > 1 else np.zeros(len(speed))
        yaw = poses[:, PoseCol.YAW]
        cos, sin = elementary.cos(yaw), elementary.sin(yaw)
        return np.stack((cos, sin, speed / self.speed, gained / self.acceleration), axis=1)


def mean_discrepancy(first: FloatArray, second: FloatArray, bandwidth: float) -> float:
    """Returns the maximum mean discrepancy of two samples, by a Gaussian kernel; 0 to sqrt(2).

    The root of the biased estimate of Gretton et al., "A kernel two-sample test" (2012).

    Args:
        first: (n, d), n >= 1.
        second: (m, d), m >= 1.
        bandwidth: Standard deviation of the kernel.
    """

    def mean_kernel(one: FloatArray, other: FloatArray) -> float:
        squares = ((one[:, None, :] - other[None, :, :]) ** 2).sum(axis=2)
        return float(elementary.exp(-squares / (2.0 * bandwidth**2)).mean())

    square = (
        mean_kernel(first, first) + mean_kernel(second, second) - 2.0 * mean_kernel(first, second)
    )
    return float(np.sqrt(max(square, 0.0)))


def _is_comparable(ego: EgoView, reference: FloatArray) -> bool:
    """Returns whether an ego arrived, and its reference path was free.

    Others differ most: they stand where they collided, or had to take another path.
    """
    if ego.count < 2 or ego.end is not TerminalEvent.ARRIVED:
        return False
    return replay_contact(ego, reference)[0] < 0


def _paths(run: RunView) -> tuple[tuple[float, ...], ...]:
    if not all(ego.count > 1 and ego.end is TerminalEvent.ARRIVED for ego in run.egos):
        return ()
    return tuple(
        (float(ego.row), *pose) for ego in run.egos for pose in recorded_path(ego).tolist()
    )


def _create(parameters: Mapping[str, Any]) -> DecictorFeedback:
    return read_parameters(DecictorFeedback, parameters, of="feedback 'decictor'")


DECICTOR = FeedbackPlugin(
    name="decictor",
    description="the difference of path and motion from those of a reference run",
    create=_create,
)
