"""The feedback of DoppelTest: interactions of egos driven by the same ADS.

Source: Huai, Chen, Almanee, Ngo, Liao, Wan, Chen, Garcia, "Doppelgänger test generation for
revealing bugs in autonomous driving software" (ICSE 2023). Its fourth objective, new violations,
depends on the campaign's earlier violations: the tester counts them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivora_service.feedback.ego_decisions import DecisionThresholds, find_decisions
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.networks.routes.route_meetings import find_meetings
from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import LEVEL_GAP, Col, EgoRoute
from drivora_service.parameters import read_parameters

EGO_DISTANCE = "ego_distance"
DECISIONS = "decisions"
CONFLICTS = "conflicts"

_SAME_PLACE = 1.5
"""Metres up to which places on two routes are the same."""


def least_ego_distance(run: RunView) -> float | None:
    """Returns the least gap between the boxes of any two egos in metres, 0 if they touch.

    Counts while at least one of the two is driving: an ego that waits for its start, or stands at
    its end, is an obstacle for the other. Egos on different levels of a bridge are not near.

    Returns:
        ``None`` if no two egos were on the road together.
    """
    trace, count = run.trace, run.trace.ego_count
    one, other = np.triu_indices(count, k=1)
    driving = np.zeros((trace.step_count, count), dtype=np.bool_)
    for ego in run.egos:
        driving[ego.first : ego.first + ego.count, ego.row] = True
    states, present = trace.states[:, :count], trace.present[:, :count]
    climb = np.abs(states[:, one, Col.Z] - states[:, other, Col.Z])
    together = present[:, one] & present[:, other] & (driving[:, one] | driving[:, other])
    together &= climb <= LEVEL_GAP
    offsets = states[:, one, : Col.YAW] - states[:, other, : Col.YAW]
    between = np.where(together, np.hypot(offsets[..., 0], offsets[..., 1]), np.inf)
    half = np.array([0.5 * math.hypot(ego.actor.length, ego.actor.width) for ego in run.egos])
    at_least = between.min(axis=0, initial=np.inf) - half[one] - half[other]
    least = math.inf
    for pair in np.argsort(at_least, kind="stable"):
        if at_least[pair] >= least:
            break
        gaps = gaps_between(trace, int(one[pair]), int(other[pair]))
        least = min(least, float(gaps[together[:, pair]].min()))
    return None if math.isinf(least) else least


@dataclass(frozen=True, slots=True, kw_only=True)
class DoppelTestFeedback:
    """Measures distance, decisions and conflicts of the egos.

    Objectives, to be minimised:

    - ``ego_distance``: least gap between two egos, metres; ``None`` if there was one ego.
    - ``decisions``: negated count of distinct decisions of all egos.
    - ``conflicts``: negated count of pairs of different routes that meet in a junction.

    Tables: ``decisions`` with (row of the ego, ``Decision``), ``conflicts`` with the rows of two
    egos on conflicting routes.

    Attributes:
        thresholds: Thresholds for finding decisions in the trace.
    """

    thresholds: DecisionThresholds

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (EGO_DISTANCE, DECISIONS, CONFLICTS)

    def measure(self, run: RunView) -> Measurement:
        """Returns the objectives, and the decisions and conflicts of the egos as features."""
        routes = run.trace.ego_routes
        meetings = find_meetings(run.network, [route.line for route in routes])
        decisions = find_decisions(run, meetings, self.thresholds)
        pairs = sorted({(meeting.first, meeting.second) for meeting in meetings})
        return Measurement(
            objectives={
                EGO_DISTANCE: least_ego_distance(run),
                DECISIONS: 0.0 - len({decision for _, decision in decisions}),
                CONFLICTS: 0.0 - _distinct(pairs, routes),
            },
            features={
                DECISIONS: tuple((float(row), float(decision)) for row, decision in decisions),
                CONFLICTS: tuple((float(first), float(second)) for first, second in pairs),
            },
        )


def _distinct(pairs: Sequence[tuple[int, int]], routes: Sequence[EgoRoute]) -> int:
    """Returns the number of different pairs of routes, regardless of the egos on each."""
    number = [next(j for j, other in enumerate(routes) if _same(other, route)) for route in routes]
    return len({frozenset((number[first], number[second])) for first, second in pairs})


def _same(one: EgoRoute, other: EgoRoute) -> bool:
    """Returns whether two routes are the same apart from their starts."""
    longer, shorter = (one, other) if one.length >= other.length else (other, one)
    skipped = longer.length - shorter.length
    x, y = (np.interp(skipped, longer.arc, longer.line[:, axis]) for axis in (0, 1))
    return (
        math.dist(longer.goal, shorter.goal) <= _SAME_PLACE
        and math.dist((x, y), shorter.line[0]) <= _SAME_PLACE
    )


def _create(parameters: Mapping[str, Any]) -> DoppelTestFeedback:
    thresholds = read_parameters(DecisionThresholds, parameters, of="feedback 'doppeltest'")
    return DoppelTestFeedback(thresholds=thresholds)


DOPPELTEST = FeedbackPlugin(
    name="doppeltest",
    description="distance between egos, their distinct decisions, conflicts of their routes",
    create=_create,
)
