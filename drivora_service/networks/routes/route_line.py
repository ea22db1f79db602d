"""Lane runs, reference line, signals and stop signs of a route, from the edges that it passes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.line_controls import STOPPING_LETTERS
from drivora_service.networks.road_network import Connection, RoadNetwork, make_read_only
from drivora_service.networks.routes.lane_graph import lane_graph
from drivora_service.networks.routes.lane_route import LaneRoute, LaneRun, RouteSignal
from drivora_service.networks.routes.route_search import EdgePass

SPACING = 1.0
"""Maximum distance between the points of a line, metres."""

CHANGE_TIME = 4.0
"""Duration of a lane change of the reference line if there is room, seconds."""

CHANGE_LENGTHS = (20.0, 60.0)
"""Minimum and maximum length of such a lane change if there is room, metres."""

CHANGE_LEAD = 10.0
"""Metres for which the reference line stays in its lane at the beginning of a change window."""

MAX_OVERLAP = 1.0
"""Metres by which a lane may begin before the end of the preceding lane."""

SAME_PLACE = 1e-6
"""Metres; nearer points of a line are merged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QuickChange:
    """A lane change that a vehicle makes as fast as its lateral acceleration allows.

    Attributes:
        speed: m/s.
        lateral_acceleration: m/s², reached at the beginning, in the middle and at the end.
        least_radius: The least radius that the vehicle can turn, metres.
    """

    speed: float
    lateral_acceleration: float
    least_radius: float

    def length(self, aside: float) -> float:
        """Returns the length of a change by ``aside`` metres along half a cosine wave.

        Its greatest curvature over a length l is pi² aside / (2 l²).
        """
        radius = max(self.speed**2 / self.lateral_acceleration, self.least_radius)
        return math.pi * math.sqrt(0.5 * aside * radius)


@dataclass(slots=True, kw_only=True)
class _Draft:
    """A lane run under construction.

    A place on it is given by ``u``, the arc length along the exact line through its lanes.

    Attributes:
        lanes: Indices of its lanes.
        u: Position of the run's last known place.
        lane_u: For each lane the (n,) ``u`` of its shape's points.
        points: The exact line's points, lane by lane.
        window: ``u`` at which the change to the next run may begin and must be complete.
        joined: ``u`` at which the change from the preceding run may begin and must be complete.
    """

    network: RoadNetwork
    lanes: list[int] = field(default_factory=list)
    lane_u: list[FloatArray] = field(default_factory=list)
    points: list[FloatArray] = field(default_factory=list)
    joined: tuple[float, float] = (0.0, 0.0)
    window: tuple[float, float] = (0.0, 0.0)

    def append(self, lane_index: int) -> None:
        """Continues the line along a lane, without a start that overlaps the line's end."""
        lane = self.network.lanes[lane_index]
        self.lanes.append(lane_index)
        if not self.points:
            self.points.append(lane.shape)
            self.lane_u.append(lane.arc)
            return
        end = self.points[-1][-1]
        heading = end - _point_before(self.points)
        gap = lane.shape - end
        along = gap[:, 0] * heading[0] + gap[:, 1] * heading[1]
        overlapping = (along <= 0.0) & (np.hypot(gap[:, 0], gap[:, 1]) < MAX_OVERLAP)
        first = len(gap) if overlapping.all() else int(np.argmin(overlapping))
        kept = lane.shape[first:]
        start = float(self.lane_u[-1][-1])
        steps = arc_lengths(np.concatenate((end[None, :], kept)))[1:]
        self.lane_u.append(start + np.concatenate((np.zeros(first), steps)))
        if len(kept):
            self.points.append(kept)

    def u_of(self, s: float) -> float:
        """Returns the ``u`` of arc length ``s`` of the last lane."""
        lane = self.network.lanes[self.lanes[-1]]
        return float(np.interp(s, lane.arc, self.lane_u[-1]))


def _point_before(points: Sequence[FloatArray]) -> FloatArray:
    """Returns the second to last point of a line in parts."""
    before: FloatArray = points[-1][-2] if len(points[-1]) > 1 else points[-2][-1]
    return before


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Line:
    """The exact line of a lane run.

    Attributes:
        points: (n, 2) metres.
        u: (n,) arc length of each point.
        lanes: (m,) indices of its lanes.
        starts: (m,) ``u`` at which each lane begins.
    """

    points: FloatArray
    u: FloatArray
    lanes: IntArray
    starts: FloatArray

    def at(self, u: FloatArray) -> FloatArray:
        """Returns the (k, 2) points at places (k,)."""
        return np.column_stack(
            (np.interp(u, self.u, self.points[:, 0]), np.interp(u, self.u, self.points[:, 1]))
        )

    def lanes_at(self, u: FloatArray) -> IntArray:
        """Returns the (k,) lane indices at places (k,)."""
        nth = np.searchsorted(self.starts, u, side="right") - 1
        return self.lanes[np.maximum(nth, 0)]


def build_route(
    network: RoadNetwork, passes: Sequence[EdgePass], change: QuickChange | None = None
) -> LaneRoute:
    """Draws the route through the edges that :func:`route_search.search` found.

    The route must be longer than zero. Without ``change``, lane changes take ``CHANGE_TIME``.
    """
    drafts = _drafts(network, passes)
    lines = [_exact_line(draft) for draft in drafts]
    limits = _speed_limits(network)

    points: list[FloatArray] = []
    lanes: list[IntArray] = []
    runs: list[IntArray] = []
    places: list[FloatArray] = []

    def add(run: int, at: FloatArray, xy: FloatArray) -> None:
        points.append(xy)
        lanes.append(lines[run].lanes_at(at))
        runs.append(np.full(len(at), run, dtype=np.int64))
        places.append(at)

    begin = drafts[0].joined[0]
    for k, (draft, line) in enumerate(zip(drafts, lines, strict=True)):
        if k == len(drafts) - 1:
            at = _sample_places(begin, draft.window[1])
            add(k, at, line.at(at))
            break
        here, there = _blend_places(draft, drafts[k + 1], limits[draft.lanes[-1]], change)
        at = _sample_places(begin, here[0])
        add(k, at, line.at(at))
        weight, of_here, of_there = _blend(line, lines[k + 1], here, there)
        xy = (1.0 - weight[:, None]) * line.at(of_here)
        xy += weight[:, None] * lines[k + 1].at(of_there)
        half = int(np.searchsorted(weight, 0.5))
        add(k, of_here[:half], xy[:half])
        add(k + 1, of_there[half:], xy[half:])
        begin = there[1]

    line_points = np.concatenate(points)
    distinct = np.ones(len(line_points), dtype=bool)
    distinct[1:] = np.hypot(*np.diff(line_points, axis=0).T) > SAME_PLACE
    line_points = line_points[distinct]
    point_lanes = np.concatenate(lanes)[distinct]
    arc = arc_lengths(line_points)
    crossed = _lines_crossed(
        network, drafts, np.concatenate(runs)[distinct], np.concatenate(places)[distinct], arc
    )
    return LaneRoute(
        runs=tuple(
            _lane_run(draft, line, limits) for draft, line in zip(drafts, lines, strict=True)
        ),
        line=line_points,
        arc=arc,
        speed_limits=limits[point_lanes],
        point_lanes=point_lanes,
        edges=_edges(network, passes),
        signals=tuple(
            RouteSignal(
                s=line.s,
                run=line.run,
                traffic_light=line.link.traffic_light,
                link_index=line.link.link_index,
            )
            for line in crossed
            if line.link.traffic_light
        ),
        stop_signs=np.array(
            [
                line.s
                for line in crossed
                if not line.link.traffic_light and line.link.right_of_way in STOPPING_LETTERS
            ]
        ),
    )


@lru_cache(maxsize=128)
def _speed_limits(network: RoadNetwork) -> FloatArray:
    """Returns the speed limit of every lane, m/s."""
    limits = np.array([lane.speed_limit for lane in network.lanes])
    make_read_only(limits)
    return limits


def _drafts(network: RoadNetwork, passes: Sequence[EdgePass]) -> list[_Draft]:
    """Splits the passes into lane runs, with the windows between them."""
    graph = lane_graph(network)
    draft = _Draft(network=network)
    draft.append(passes[0].lane)
    start = draft.u_of(passes[0].s)
    draft.joined = (start, start)
    drafts = [draft]
    for index, current in enumerate(passes):
        if index > 0 and not current.continues:
            draft.append(current.lane)
        chain = _lanes_between(network, current.lane, current.exit_lane)
        for nth, (lane, following) in enumerate(pairwise(chain)):
            windows = []
            for one in (lane, following):
                length = graph.lengths[one]
                # The ratio is exactly 1 on the lane itself, which avoids rounding.
                enter = current.s * (length / graph.lengths[current.lane])
                leave = current.exit_s * (length / graph.lengths[current.exit_lane])
                width = (leave - enter) / (len(chain) - 1)
                windows.append((enter + nth * width, enter + (nth + 1) * width))
            # A waypoint in another lane than the start, at the same height as it, lies some
            # centimetres behind the start in a bend.
            begin = max(draft.u_of(windows[0][0]), draft.joined[0])
            draft.window = (begin, draft.u_of(windows[0][1]))
            draft = _Draft(network=network)
            draft.append(following)
            draft.joined = (draft.u_of(windows[1][0]), draft.u_of(windows[1][1]))
            drafts.append(draft)
    end = max(draft.u_of(passes[-1].exit_s), draft.joined[1])
    draft.window = (end, end)
    return drafts


def _lanes_between(network: RoadNetwork, first: int, last: int) -> list[int]:
    """Returns the lanes of one edge from ``first`` to ``last``, both included."""
    leftwards = network.lanes[last].lane_number > network.lanes[first].lane_number
    chain = [first]
    while chain[-1] != last:
        lane = network.lanes[chain[-1]]
        chain.append(lane.left if leftwards else lane.right)
    return chain


def _exact_line(draft: _Draft) -> _Line:
    points = np.concatenate(draft.points)
    return _Line(
        points=points,
        u=arc_lengths(points),
        lanes=np.array(draft.lanes, dtype=np.int64),
        starts=np.array([float(u[0]) for u in draft.lane_u]),
    )


def _sample_places(begin: float, end: float) -> FloatArray:
    """Returns places from ``begin`` to ``end``, both included, at most the spacing apart."""
    count = max(math.ceil((end - begin) / SPACING - 1e-9), 1)
    return np.linspace(begin, end, count + 1)


_Range = tuple[float, float]


def _blend_places(
    draft: _Draft, following: _Draft, speed_limit: float, change: QuickChange | None
) -> tuple[_Range, _Range]:
    """Returns the ranges of the reference line's lane change on both runs."""
    room = draft.window[1] - draft.window[0]
    shortest, longest = CHANGE_LENGTHS
    length = min(max(CHANGE_TIME * speed_limit, shortest), longest, room)
    if change is not None:
        lanes = draft.network.lanes[draft.lanes[-1]], draft.network.lanes[following.lanes[0]]
        length = min(change.length(0.5 * (lanes[0].width + lanes[1].width)), room)
    lead = min(CHANGE_LEAD, 0.5 * (room - length))
    low, high = lead / room, (lead + length) / room
    joined = following.joined[1] - following.joined[0]
    return (
        (draft.window[0] + low * room, draft.window[0] + high * room),
        (following.joined[0] + low * joined, following.joined[0] + high * joined),
    )


def _blend(
    line: _Line, following: _Line, here: _Range, there: _Range
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Returns the (n,) weight of the following run along a change, and the places on both runs.

    The weight is half a cosine wave. The points are so near to each other that neither the forward
    nor the lateral motion, at most pi / 2 times faster than on average, exceeds the spacing.
    """
    ends = np.array([here, there])
    aside = np.hypot(*(line.at(ends[0]) - following.at(ends[1])).T).max()
    longest = max(here[1] - here[0], there[1] - there[0])
    count = max(math.ceil((longest + 0.5 * math.pi * aside) / SPACING), 2)
    t = np.linspace(0.0, 1.0, count + 1)
    return (
        0.5 - 0.5 * elementary.cos(math.pi * t),
        here[0] + t * (here[1] - here[0]),
        there[0] + t * (there[1] - there[0]),
    )


def _lane_run(draft: _Draft, line: _Line, limits: FloatArray) -> LaneRun:
    at = _sample_places(0.0, float(line.u[-1]))
    points = line.at(at)
    arc = arc_lengths(points)
    start, begin, end = np.interp([draft.joined[0], *draft.window], at, arc)
    return LaneRun(
        lanes=tuple(draft.lanes),
        line=points,
        arc=arc,
        speed_limits=limits[line.lanes_at(at)],
        start_s=float(start),
        change_from=float(begin),
        end_s=float(end),
    )


def _edges(network: RoadNetwork, passes: Sequence[EdgePass]) -> tuple[str, ...]:
    return tuple(
        network.lanes[one.lane].edge_id
        for index, one in enumerate(passes)
        if (index == 0 or not one.continues) and not network.lanes[one.lane].is_internal
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _LineCrossed:
    """The end of a lane that the route crosses between its start and destination.

    Attributes:
        s: Arc length on the reference line, metres.
        run: Index of the lane run.
        link: The movement of the route from there.
    """

    s: float
    run: int
    link: Connection


def _lines_crossed(
    network: RoadNetwork,
    drafts: Sequence[_Draft],
    runs: IntArray,
    places: NDArray[np.float64],
    arc: FloatArray,
) -> tuple[_LineCrossed, ...]:
    """Returns the ends of lanes between the start and the destination, in order of ``s``."""
    crossed = []
    for k, draft in enumerate(drafts):
        own = runs == k
        if not own.any():
            continue
        on_run, on_route = places[own], arc[own]
        for lane, following, u in zip(draft.lanes, draft.lanes[1:], draft.lane_u, strict=False):
            end = float(u[-1])
            if not draft.joined[0] < end <= draft.window[1]:
                continue
            for link in network.lanes[lane].connections:
                if link.to_lane == following:
                    s = float(np.interp(end, on_run, on_route))
                    crossed.append(_LineCrossed(s=s, run=k, link=link))
                    break
    return tuple(sorted(crossed, key=lambda line: line.s))
