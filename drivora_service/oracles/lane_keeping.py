"""The ego drives outside the lanes of its direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.networks.drivable_area import outside_distance
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import Col, EgoCol
from drivora_service.oracles.verdict import Severity, Verdict, not_started, passed, violated


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneKeeping:
    """Violated where the ego's centre is outside all lanes, or in a lane of the other direction.

    After CARLA Leaderboard's test for driving outside the route's lanes; its share of the route is
    deducted by the driving score. Lanes inside junctions have no wrong direction. Stays shorter
    than the least time and distance are noise of the road's geometry and do not count.

    Attributes:
        margin: Metres beyond the edge of the nearest lane that count as within.
        least_distance: Metres that a stay outside must be long to count.
        least_time: Seconds that it must last to count.
    """

    margin: float = 0.5
    least_distance: float = 1.0
    least_time: float = 0.15

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "lane_keeping"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns one verdict an ego."""
        return tuple(self._judge(ego) for ego in run.egos)

    def _judge(self, ego: EgoView) -> Verdict:
        if not ego.count:
            return not_started(self.name, ego)
        outside, oncoming = self._flag_outside(ego), self._flag_oncoming(ego)
        wrong = self._drop_short_stays(ego, outside | oncoming)
        outside, oncoming = outside & wrong, oncoming & wrong
        distance = float(ego.moved[wrong].sum())
        share = min(distance / ego.route.length, 1.0) if ego.route.length > 0.0 else 0.0
        if distance <= 0.0:
            return passed(self.name, ego, "Kept to its lanes.", distance=0.0, share=0.0)
        return violated(
            self.name,
            ego,
            int(np.argmax(wrong & (ego.moved > 0.0))),
            f"Drove {distance:.1f} m outside its lanes, {100.0 * share:.1f} % of the route.",
            severity=Severity.MINOR,
            at_fault=True,
            distance=distance,
            share=share,
            outside_distance=float(ego.moved[outside].sum()),
            oncoming_distance=float(ego.moved[oncoming].sum()),
        )

    def _drop_short_stays(self, ego: EgoView, wrong: BoolArray) -> BoolArray:
        """Returns the flags of rows in the stays outside that are long enough to count."""
        lasting = np.zeros_like(wrong)
        for first, last in stretches(wrong):
            far = float(ego.moved[first:last].sum()) >= self.least_distance
            long = (last - first) * ego.step_length >= self.least_time - 1e-9
            lasting[first:last] = far and long
        return lasting

    def _flag_outside(self, ego: EgoView) -> BoolArray:
        lateral = np.abs(ego.value(EgoCol.LANE_LATERAL))
        outside = lateral > ego.lane_half_widths + self.margin
        off_lanes = np.flatnonzero(ego.lanes < 0)
        if len(off_lanes):
            centres = ego.states[off_lanes][:, [Col.X, Col.Y]]
            outside[off_lanes] = outside_distance(ego.network, centres) > self.margin
        return outside

    def _flag_oncoming(self, ego: EgoView) -> BoolArray:
        turn = ego.states[:, Col.YAW] - ego.value(EgoCol.LANE_HEADING)
        against = elementary.cos(turn) < 0.0
        oncoming: BoolArray = against & (ego.lanes >= 0) & ~ego.in_junction
        return oncoming
