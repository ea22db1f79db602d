"""The feedback of SAMOTA: the distance of a run to violating each of six requirements.

Ul Haq, Shin, Briand, *Efficient Online Testing for DNN-Enabled Systems using Surrogate-Assisted and
Many-Objective Optimization* (ICSE 2022), computed from a trace. Distances and times x are mapped to
x / (x + scale), which never saturates (Arcuri, "It really does matter how you normalize the branch
distance in search-based software testing", 2013): the surrogates learn also from distant runs.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.drivable_area import outside_distance
from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.trace import LEVEL_GAP, Col, EgoCol, Light, Role, TerminalEvent
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.destination import Destination
from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.responsibility.finding import Fault
from drivora_service.oracles.verdict import Outcome
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from drivora_service.observations.run_view import EgoView, RunView

LANE_CENTRE = "lane_centre"
VEHICLE = "vehicle_distance"
WALKER = "walker_distance"
STATIC = "static_distance"
PROGRESS = "progress"
RED_LIGHT = "red_light"

_VEHICLES = (Role.EGO, Role.NPC_VEHICLE, Role.BACKGROUND)
_NOT_ARRIVED = (TerminalEvent.STUCK, TerminalEvent.TIME_LIMIT, TerminalEvent.ROUTE_DEVIATION)
_HALF_LANE = 1.75
"""Metres, for an ego that was never on a lane."""

_TOUCH = 0.01
"""Metres that count as the gap to an actor that the ego touched without being known to be at fault:
nearer than any other, but no violation."""

Positive = Annotated[float, Field(gt=0.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class SamotaFeedback:
    """Measures six objectives in 0..1, 0 where the ego violated the requirement; of the worst ego.

    Without an actor of a role, or without a signal, an objective is not measurable. An actor that
    collided with the ego by its own fault is left out of the distances of that ego: it tells
    nothing of what the ego did, and would be the nearest of all. An actor that the ego touched
    with undetermined fault counts as nearly touched.

    Attributes:
        gap: Metres between two boxes that score one half.
        time: Seconds before running a red light that score one half.
        yellow: Assumed duration of a yellow, seconds.
    """

    gap: Positive = 10.0
    time: Positive = 3.0
    yellow: Positive = 3.0

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return (LANE_CENTRE, VEHICLE, WALKER, STATIC, PROGRESS, RED_LIGHT)

    def measure(self, run: RunView) -> Measurement:
        """Returns each objective of the ego that is nearest to violating it."""
        ran_red = {
            verdict.ego for verdict in RedLight().judge(run) if verdict.outcome is Outcome.VIOLATED
        }
        measures: dict[str, Callable[[EgoView], float | None]] = {
            LANE_CENTRE: _lane_centre,
            VEHICLE: lambda ego: self._distance(ego, _VEHICLES),
            WALKER: lambda ego: self._distance(ego, (Role.NPC_WALKER,)),
            STATIC: lambda ego: self._distance(ego, (Role.NPC_OBSTACLE,)),
            PROGRESS: _progress,
            RED_LIGHT: lambda ego: 0.0 if ego.id in ran_red else self._red_light(ego),
        }
        egos = [ego for ego in run.egos if ego.count]
        return Measurement(
            objectives={name: _least(measures[name], egos) for name in self.objectives}
        )

    def _distance(self, ego: EgoView, roles: tuple[Role, ...]) -> float | None:
        """Scores the least gap to any actor of these roles; 0 if the ego hit one by its fault."""
        faults = {one.other.row: one.finding.fault for one in Collision().find_collisions(ego)}
        hit_by = frozenset(row for row, fault in faults.items() if fault is Fault.OTHER)
        gap = least_gap(ego, roles, without=hit_by)
        if gap is None:
            return None
        hit = {row for row, fault in faults.items() if fault is Fault.EGO}
        if any(ego.trace.actors[row].role in roles for row in hit):
            return 0.0
        gap = max(gap, _TOUCH)
        return gap / (gap + self.gap)

    def _red_light(self, ego: EgoView) -> float | None:
        """Scores the least time before running a red light, for an ego that ran none.

        While the signal is red, it is the time in which the tail would cross the line at the
        present speed: short for a fast and late-braking ego, infinite for a standing one. For an
        ego on the line at yellow, it is the rest of the yellow after its tail has crossed.
        """
        distance = ego.value(EgoCol.LIGHT_DISTANCE)
        facing = np.isfinite(distance) & (ego.lights != Light.NONE)
        if not facing.any():
            return None
        with np.errstate(divide="ignore"):
            crossing = (distance + ego.actor.length) / ego.speed
        margin = np.full(ego.count, np.inf)
        red = facing & (ego.lights == Light.RED) & (distance > -ego.actor.length)
        margin[red] = crossing[red]
        late = facing & (ego.lights == Light.YELLOW) & (distance < 0.0)
        left = self.yellow - _seconds_of(ego, Light.YELLOW) - crossing
        margin[late] = left[late]
        # At least a step: only an ego that violates the oracle scores 0.
        least = max(float(margin.min()), ego.step_length)
        return 1.0 if np.isinf(least) else least / (least + self.time)


def least_gap(
    ego: EgoView, roles: tuple[Role, ...], *, without: Collection[int] = ()
) -> float | None:
    """Returns the least distance in metres between an ego's box and any of these roles.

    Actors on another level of a bridge are left out, and those in the rows ``without``.

    Returns:
        ``None`` if there was none while the ego drove.
    """
    trace = ego.trace
    rows = np.array(
        [
            actor.row
            for actor in trace.actors
            if actor.role in roles and actor.row != ego.row and actor.row not in without
        ],
        dtype=np.int64,
    )
    part = slice(ego.first, ego.first + ego.count)
    states = trace.states[part, rows]
    away = np.hypot(
        states[:, :, Col.X] - ego.states[:, None, Col.X],
        states[:, :, Col.Y] - ego.states[:, None, Col.Y],
    )
    climb = np.abs(states[:, :, Col.Z] - ego.states[:, None, Col.Z])
    met = trace.present[part, rows] & (climb <= LEVEL_GAP)
    reach = [0.5 * np.hypot(trace.actors[row].length, trace.actors[row].width) for row in rows]
    own = 0.5 * np.hypot(ego.actor.length, ego.actor.width)
    at_least = np.where(met, away, np.inf).min(axis=0) - np.array(reach) - own
    least: float | None = None
    for index in np.argsort(at_least, kind="stable"):
        if np.isinf(at_least[index]) or (least is not None and at_least[index] >= least):
            break
        gaps = gaps_between(trace, ego.row, int(rows[index]))[part]
        gap = float(gaps[met[:, index]].min())
        least = gap if least is None else min(least, gap)
    return least


def _lane_centre(ego: EgoView) -> float | None:
    """Scores the largest distance from the lane's centre; 0 if `lane_keeping` is violated.

    That is half a metre beyond the lane's edge, or in a lane of the other direction. The distance
    is a share of that limit.
    """
    margin = LaneKeeping().margin
    half = ego.lane_half_widths
    known = half[np.isfinite(half)]
    usual = float(known.mean()) if len(known) else _HALF_LANE
    share = np.abs(ego.value(EgoCol.LANE_LATERAL)) / (half + margin)
    off = np.flatnonzero(ego.lanes < 0)
    if len(off):
        out = outside_distance(ego.network, ego.states[off][:, [Col.X, Col.Y]])
        share[off] = (usual + out) / (usual + margin)
    turn = ego.states[:, Col.YAW] - ego.value(EgoCol.LANE_HEADING)
    against = elementary.cos(turn) < 0.0
    share[against & (ego.lanes >= 0) & ~ego.in_junction & (ego.moved > 0.0)] = 1.0
    share = share[np.isfinite(share)]
    return max(1.0 - float(share.max()), 0.0) if len(share) else None


def _progress(ego: EgoView) -> float | None:
    """Scores the spare time at the ego's average pace, as a share of its time limit.

    The limit is that of `destination`. 0 for an ego that did not arrive in time: too slow, stuck,
    or on its way at the end. For an ego that collided, it is the pace until the collision.
    """
    if ego.end in _NOT_ARRIVED:
        return 0.0
    limit = Destination().time_limit(ego)
    done = ego.value(EgoCol.ROUTE_S) / ego.route.length
    if not np.isfinite(done).any() or not limit > 0.0:
        return None
    share = 1.0 if ego.end is TerminalEvent.ARRIVED else float(np.clip(np.nanmax(done), 0.0, 1.0))
    if not share > 0.0:
        return 0.0
    return max(1.0 - ego.duration / (share * limit), 0.0)


def _seconds_of(ego: EgoView, light: Light) -> FloatArray:
    """Returns for how many seconds (n,) the signal has shown this light; 0 while it does not."""
    shows = ego.lights == light
    row = np.arange(ego.count)
    since = np.maximum.accumulate(np.where(shows, -1, row))
    seconds: FloatArray = np.where(shows, (row - since) * ego.step_length, 0.0)
    return seconds


def _least(measure: Callable[[EgoView], float | None], egos: list[EgoView]) -> float | None:
    return min((value for ego in egos if (value := measure(ego)) is not None), default=None)


def _create(parameters: Mapping[str, Any]) -> SamotaFeedback:
    return read_parameters(SamotaFeedback, parameters, of="feedback 'samota'")


SAMOTA = FeedbackPlugin(
    name="samota",
    description="lane centre, vehicle, walker and static distance, progress, red light; 0 violates",
    create=_create,
)
