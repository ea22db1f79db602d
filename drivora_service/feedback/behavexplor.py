"""The feedback of BehAVExplor: the ego's distance to a failure, and its behaviour.

Cheng, Zhou, Xie, *BehAVExplor: Behavior Diversity Guided Testing for Autonomous Driving Systems*
(ISSTA 2023); scales as in its public code.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.feedback.windows import motion_signals, window_statistics
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col, TerminalEvent
from drivora_service.oracles.off_road import OffRoad
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

DEGREE = "violation_degree"
"""The objective: 0 is nearest to a failure, 1 farthest."""

WINDOWS = "windows"
"""The feature table: a row of 64 statistics a window."""

_FEWEST_SAMPLES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class BehavexplorFeedback:
    """Measures the ego that came nearest to a failure, and describes its motion.

    The objective is the mean of four terms, each 0 at a failure and 1 at its scale and beyond:
    the distance to the destination at the end (inverted: an ego that ended far from it is nearer to
    a failure), and the least distances of its box to another actor, to the lane line on its left
    and to the edge of the road on its right. A missing actor, line or edge scores 1.

    Attributes:
        sample: Seconds between the samples that trajectories are interpolated at.
        window: Seconds of a window; at least three samples.
        stride: Seconds from the start of a window to that of the next; at most a window.
        destination_scale: Metres from the destination at which the term is 0.
        gap_scale: Metres to other actors at which the term is 1.
        line_scale: Metres to the lane line at which the term is 1.
        edge_scale: Metres to the edge of the road at which the term is 1.
    """

    sample: Annotated[float, Field(ge=0.05)] = 0.1
    window: Annotated[float, Field(gt=0.0, le=30.0)] = 1.0
    stride: Annotated[float, Field(ge=0.05)] = 1.0
    destination_scale: Annotated[float, Field(gt=0.0)] = 10.0
    gap_scale: Annotated[float, Field(gt=0.0)] = 1.0
    line_scale: Annotated[float, Field(gt=0.0)] = 1.0
    edge_scale: Annotated[float, Field(gt=0.0)] = 1.0

    def __post_init__(self) -> None:
        if round(self.window / self.sample) < _FEWEST_SAMPLES:
            raise SearchError(
                f"feedback 'behavexplor': a window of {self.window} s has fewer than "
                f"{_FEWEST_SAMPLES} samples {self.sample} s apart; make the window longer or the "
                "samples closer"
            )
        if self.stride > self.window:
            raise SearchError(
                f"feedback 'behavexplor': a stride of {self.stride} s leaves gaps between windows "
                f"of {self.window} s; it must not be longer"
            )

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (DEGREE,)

    def measure(self, run: RunView) -> Measurement:
        """Measures a run; of several egos the one nearest to a failure, the first among equals."""
        degree, nearest = None, None
        for ego in run.egos:
            if ego.count:
                found = self._degree(ego)
                if degree is None or found < degree:
                    degree, nearest = found, ego
        if nearest is None:
            return Measurement(objectives={DEGREE: None}, features={WINDOWS: ()})
        table = window_statistics(
            motion_signals(nearest, self.sample),
            round(self.window / self.sample),
            max(round(self.stride / self.sample), 1),
        )
        rows = tuple(tuple(row) for row in table.tolist())
        return Measurement(objectives={DEGREE: degree}, features={WINDOWS: rows})

    def _degree(self, ego: EgoView) -> float:
        gap = ego.proximity.min_gap
        line, edge = _border_distances(ego)
        terms = (
            1.0 - min(_goal_distance(ego) / self.destination_scale, 1.0),
            1.0 if gap is None else min(gap / self.gap_scale, 1.0),
            min(line / self.line_scale, 1.0),
            min(edge / self.edge_scale, 1.0),
        )
        return sum(terms) / len(terms)


def _goal_distance(ego: EgoView) -> float:
    """Returns the metres from the ego's box to its destination at the end; 0 if it arrived."""
    if ego.end is TerminalEvent.ARRIVED:
        return 0.0
    x, y, yaw = ego.states[-1, [Col.X, Col.Y, Col.YAW]]
    east, north = ego.route.goal[0] - x, ego.route.goal[1] - y
    ahead = abs(east * math.cos(yaw) + north * math.sin(yaw)) - 0.5 * ego.actor.length
    aside = abs(north * math.cos(yaw) - east * math.sin(yaw)) - 0.5 * ego.actor.width
    return float(np.hypot(max(ahead, 0.0), max(aside, 0.0)))


def _border_distances(ego: EgoView) -> tuple[float, float]:
    """Returns the least metres to the line on the left and to the edge of the road on the right.

    On the left of a carriageway is the line to the oncoming traffic; lines between lanes of one
    direction may be crossed and do not count. Inside junctions there are no lines; there and off
    all lanes, being off the road counts as reaching the edge. The tolerance is the oracle's: in
    turns, corners pass over the kerbs of many networks by a few centimetres.

    Returns:
        0 if crossed, inf if there is none.
    """
    borders: FloatArray = np.maximum(ego.room_beside[~ego.in_junction], 0.0)
    left, right = np.fmin.reduce(borders, axis=0, initial=np.inf)
    if ego.outside.max() > OffRoad().tolerance:
        right = 0.0
    return float(left), float(right)


def _create(parameters: Mapping[str, Any]) -> BehavexplorFeedback:
    return read_parameters(BehavexplorFeedback, parameters, of="feedback 'behavexplor'")


BEHAVEXPLOR = FeedbackPlugin(
    name="behavexplor",
    description="the degree of violation and the windowed motion of the ego nearest to a failure",
    create=_create,
)
