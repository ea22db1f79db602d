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
from drivora_service.feedback.ego_distance import least_ego_distance
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.networks.routes.route_meetings import find_meetings
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import EgoRoute
from drivora_service.parameters import read_parameters

EGO_DISTANCE = "ego_distance"
DECISIONS = "decisions"
CONFLICTS = "conflicts"

_SAME_PLACE = 1.5
"""Metres up to which places on two routes are the same."""


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
        """Measures a run."""
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
