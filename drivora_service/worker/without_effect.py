"""The genes of a candidate that had no effect on the run of any ego, and could have had none.

A change of these genes alone, to whatever values, gives every ego the same run, step by step. What
is found is less than what is true: a gene counts only if that follows from

- its actor being absent; or
- the distances of the run. An ego perceives what is within the range of its perception, and a
  reactive vehicle what is within its look ahead. A changed gene first shows when its vehicle has
  come to a place on its path. It has no effect if, from then on, all places where the vehicle might
  be, the rest of its path, are out of reach of every ego and of every other reactive vehicle until
  the last ego ends; all the more if the vehicle does not come there before.

So chains of vehicles that react to one another are covered. Nothing but absence counts if an agent
perceives without limits or may read SUMO, or if SUMO drives anything: its vehicles depend on all
others (see ``simulation.traffic.holding``).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.observations.trace import Col, Trace
from drivora_service.search.candidate_space import CandidateSpace
from drivora_service.search.genes import GeneSpace
from drivora_service.search.space.vehicles.vehicle_ways import BESIDE, VehicleWay
from drivora_service.simulation.followers.followers import look_ahead
from drivora_service.simulation.plans.episode_plan import EpisodePlan, FollowerPlan
from drivora_service.simulation.plans.planning_npcs import COMFORTABLE_BRAKING_SHARE

_STRIDE_S = 0.5
"""Seconds between the sampled positions."""
_LINE_STEP = 5
"""Number of points of a path between two that are compared; points are at most 1 m apart."""
_LONGEST = 12.0
"""Metres, at least half the diagonal of any actor twice: distances are between centres, and an
actor hides others by its box."""
_SMOOTHED = 3.0
"""Metres before the place from which on a speed is planned that its change may already show."""


def genes_without_effect(
    space: CandidateSpace,
    values: FloatArray,
    plan: EpisodePlan,
    trace: Trace,
    *,
    is_bounded: bool,
) -> tuple[int, ...]:
    """Returns the indices of the genes without an effect, ascending.

    Args:
        space: Space of the candidate.
        values: (d,) its repaired genes.
        plan: Plan of its run.
        trace: Its run.
        is_bounded: Whether agents perceive only what is within range, and SUMO drives no actor.
    """
    found = set(genes_of_absent(values, space.genes))
    if is_bounded and trace.step_count > 1:
        found.update(_out_of_reach(space.vehicle_ways(values), plan, trace))
    return tuple(sorted(found))


def genes_of_absent(values: FloatArray, space: GeneSpace) -> Iterator[int]:
    """Yields the genes of absent actors, but for those of their presence."""
    for block in space.optional_blocks:
        if values[block.start] == 0.0:
            yield from range(block.start + 1, block.stop)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Watcher:
    """An actor whose run depends on others.

    Attributes:
        row: Its row in the trace.
        places: (t, 2) its positions, columns ``Col.X`` and ``Col.Y``; NaN while it is absent.
        reach: Metres, centre to centre, within which it depends on an actor.
    """

    row: int
    places: FloatArray
    reach: float


def _out_of_reach(ways: Sequence[VehicleWay], plan: EpisodePlan, trace: Trace) -> Iterator[int]:
    rows = _sample_rows(trace)
    followers = {follower.id: follower for follower in plan.followers}
    actors = {actor.id: actor.row for actor in trace.actors}
    watchers = [
        _Watcher(
            row=row,
            places=_places(trace, row, rows),
            reach=plan.weather.perception_range,
        )
        for row in range(trace.ego_count)
    ]
    watchers += [
        _Watcher(
            row=actors[one.id], places=_places(trace, actors[one.id], rows), reach=_view_range(one)
        )
        for one in plan.followers
        if one.reacts
    ]
    for way in ways:
        follower, row = followers.get(way.block.actor), actors.get(way.block.actor)
        if follower is None or row is None:
            continue
        margins = _margins(way, [one for one in watchers if one.row != row])
        came = _compute_travel(way, _places(trace, row, rows))
        if margins.size and margins.min() > 0.0:
            yield from way.places
        if plan.patches:
            # They move the places from which on a speed shows.
            continue
        braking = COMFORTABLE_BRAKING_SHARE * follower.model.max_deceleration
        arc = way.arc[_line_points(way)]
        for gene in way.speeds:
            begin = gene.after - gene.before**2 / (2.0 * braking) - _SMOOTHED
            # From the sample before the one at which it has come there.
            reached = np.flatnonzero(came >= begin)
            if not len(reached):
                yield gene.index
                continue
            first = max(int(reached[0]) - 1, 0)
            ahead = int(np.searchsorted(arc, begin, side="right")) - 1
            if margins[max(ahead, 0) :, first:].min() > 0.0:
                yield gene.index


def _sample_rows(trace: Trace) -> IntArray:
    """Returns rows of the trace up to the end of the last ego's part, that one included."""
    last = min(max(trace.ego_end_steps), trace.step_count - 1)
    stride = max(round(_STRIDE_S / trace.step_length), 1)
    return np.unique(np.append(np.arange(0, last + 1, stride), last))


def _places(trace: Trace, row: int, rows: IntArray) -> FloatArray:
    places = trace.states[rows, row][:, [Col.X, Col.Y]]
    return np.where(trace.present[rows, row][:, None], places, np.nan)


def _view_range(follower: FollowerPlan) -> float:
    """Returns the metres, centre to centre, within which a reactive vehicle sees others."""
    fastest = max(float(follower.path.wanted.max()), follower.first_speed)
    return look_ahead(fastest, follower.model.max_deceleration) + 0.5 * follower.model.length


def _line_points(way: VehicleWay) -> IntArray:
    """Returns the points of a path that are compared, the last one included."""
    count = len(way.line)
    return np.unique(np.append(np.arange(0, count, _LINE_STEP), count - 1))


def _margins(way: VehicleWay, watchers: Sequence[_Watcher]) -> FloatArray:
    """Returns by how many metres each point of a path is out of reach at each sample, (n, t).

    Positive: whatever is there then, no watcher depends on it.
    """
    points = way.line[_line_points(way)]
    margins = np.full((len(points), len(watchers[0].places)), np.inf)
    for one in watchers:
        away = np.hypot(
            points[:, None, Col.X] - one.places[None, :, Col.X],
            points[:, None, Col.Y] - one.places[None, :, Col.Y],
        )
        steps = np.hypot(*np.diff(one.places, axis=0).T)
        # It may have been nearer between two samples, or before the first one with it.
        between = float(np.max(steps, where=np.isfinite(steps), initial=0.0))
        near = away - one.reach - between - 0.5 * _LINE_STEP - BESIDE - _LONGEST
        margins = np.fmin(margins, near)
    return margins


def _compute_travel(way: VehicleWay, places: FloatArray) -> FloatArray:
    """Returns how far a vehicle had come at each sample, (t,) at least, metres of arc length.

    Of several stretches of its path at one place, the last counts. -inf before it appears.
    """
    chosen = _line_points(way)
    points, arc = way.line[chosen], way.arc[chosen]
    away = np.hypot(
        points[:, None, Col.X] - places[None, :, Col.X],
        points[:, None, Col.Y] - places[None, :, Col.Y],
    )
    is_there: BoolArray = np.isfinite(places[:, Col.X])
    beside = away <= BESIDE + _LINE_STEP
    came = np.where(beside, arc[:, None], -np.inf).max(axis=0) + _LINE_STEP
    # Off its path: as if it had come to the end.
    came[is_there & ~beside.any(axis=0)] = math.inf
    came[~is_there] = -math.inf
    return np.maximum.accumulate(came)
