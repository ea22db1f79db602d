"""The feedback of AVFuzzer: the margin to a collision.

Li et al., *AV-FUZZER: Finding Safety Violations in Autonomous Driving Systems* (ISSRE 2020).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.trace import LEVEL_GAP, Col, EgoCol, Role
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

SAFETY_MARGIN = "safety_margin"
"""The objective, metres: the negative of the paper's fitness."""

_VEHICLES = (Role.EGO, Role.NPC_VEHICLE, Role.BACKGROUND)


@dataclass(frozen=True, slots=True, kw_only=True)
class AvfuzzerFeedback:
    """Measures the mean of the least gap and the least safety potential, of the worst ego.

    The safety potential of a follower is the gap to the actor ahead minus its stopping distance. It
    counts while the ego follows an actor in its lane, and while the ego pulls in ahead of an actor.

    Attributes:
        reach: Metres between two centres along the lane up to which one follows the other.
        half_width: Metres to each side of a centre, across the lane, that count as its lane.
        slant: Radians between the ego's heading and its lane from which on it changes lanes.
        far: Metres for the potential without following, and upper bound of both terms.
    """

    reach: Annotated[float, Field(gt=0.0)] = 20.0
    half_width: Annotated[float, Field(gt=0.0)] = 2.0
    slant: Annotated[float, Field(ge=0.0)] = math.radians(1.0)
    far: Annotated[float, Field(gt=0.0)] = 130.0

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (SAFETY_MARGIN,)

    def measure(self, run: RunView) -> Measurement:
        """Measures a run; not measurable if there was no other actor around any ego."""
        margins = [margin for ego in run.egos if (margin := self._margin(ego)) is not None]
        return Measurement(objectives={SAFETY_MARGIN: min(margins, default=None)})

    def _margin(self, ego: EgoView) -> float | None:
        gap = ego.proximity.min_gap
        if gap is None:
            return None
        potential = min(self._least_potential(ego), self.far)
        return 0.5 * min(gap, self.far) + 0.5 * potential

    def _least_potential(self, ego: EgoView) -> float:
        leads, follows = self._followings(ego)
        rows = slice(ego.first, ego.first + ego.count)
        own = braking_distance(ego.speed)
        least = math.inf
        for row in np.flatnonzero((leads | follows).any(axis=0)):
            gaps = gaps_between(ego.trace, ego.row, int(row))[rows]
            others = braking_distance(ego.trace.speeds(int(row))[rows])
            for when, needed in ((leads[:, row], own), (follows[:, row], others)):
                least = min(least, float(np.min((gaps - needed)[when], initial=math.inf)))
        return least

    def _followings(self, ego: EgoView) -> tuple[BoolArray, BoolArray]:
        """Returns when (n, N) the ego follows an actor, and when it pulls in ahead of one."""
        trace = ego.trace
        others = trace.states[ego.first : ego.first + ego.count]
        lane = ego.value(EgoCol.LANE_HEADING)
        heading = np.where(np.isnan(lane), ego.states[:, Col.YAW], lane)
        cos, sin = elementary.cos(heading)[:, None], elementary.sin(heading)[:, None]
        away = others - ego.states[:, None]
        east, north = away[..., Col.X], away[..., Col.Y]
        ahead = east * cos + north * sin
        near = (np.abs(ahead) <= self.reach) & (np.abs(north * cos - east * sin) <= self.half_width)
        near &= np.abs(away[..., Col.Z]) <= LEVEL_GAP
        # Off every lane, where no direction is known, the sine is NaN and no actor pulls in.
        slanted = np.abs(elementary.sin(ego.states[:, Col.YAW] - lane)) > math.sin(self.slant)
        same_way = elementary.cos(others[..., Col.YAW] - heading[:, None]) > 0.0
        drives = np.array([actor.role in _VEHICLES for actor in trace.actors])
        return near & (ahead > 0.0), near & (ahead < 0.0) & slanted[:, None] & same_way & drives


def braking_distance(speed: FloatArray) -> FloatArray:
    """Returns the stopping distance in metres from a speed in m/s, by the paper's polynomial."""
    needed: FloatArray = np.maximum(0.0467 * speed**2 + 0.4116 * speed - 1.4913, 0.0)
    return needed


def _create(parameters: Mapping[str, Any]) -> AvfuzzerFeedback:
    return read_parameters(AvfuzzerFeedback, parameters, of="feedback 'avfuzzer'")


AVFUZZER = FeedbackPlugin(
    name="avfuzzer",
    description="the margin to a collision: gap and braking distance",
    create=_create,
)
