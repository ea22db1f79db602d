"""A route through the lanes, with the lane changes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import make_read_only


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneRun:
    """Consecutive lanes without a lane change.

    Attributes:
        lanes: Indices of the lanes, internal ones included.
        line: (n, 2) centre line through them, metres; extends beyond the change windows at both
            ends as far as its lanes.
        arc: (n,) arc length of each point from the line's start, metres.
        speed_limits: (n,) m/s at each point.
        start_s: Arc length on this line where the route joins it (after a lane change: the first
            place where the change may happen).
        change_from: Arc length on this line where the change to the next run may begin; for the
            last run, equal to ``end_s``.
        end_s: Arc length on this line by which the change to the next run must be complete, or, for
            the last run, of the destination.
    """

    lanes: tuple[int, ...]
    line: FloatArray
    arc: FloatArray
    speed_limits: FloatArray
    start_s: float
    change_from: float
    end_s: float

    def __post_init__(self) -> None:
        """Makes the arrays read-only: since routes are shared."""
        make_read_only(self.line, self.arc, self.speed_limits)


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteSignal:
    """A signal on the route.

    Attributes:
        s: Arc length of the stop line on the route's reference line, metres.
        run: Index of the lane run whose lane it controls.
        traffic_light: Its id.
        link_index: Position of its state in the traffic light's state string.
    """

    s: float
    run: int
    traffic_light: str
    link_index: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneRoute:
    """A route from a start to a destination.

    Attributes:
        runs: Lane runs in order; between two of them the vehicle changes lanes.
        line: (n, 2) reference line from start to destination, metres, at most 1 m between points;
            lane changes are blended over their windows.
        arc: (n,) arc length of each point, metres; ``arc[-1]`` is the route's length.
        speed_limits: (n,) m/s at each point.
        point_lanes: (n,) index of the lane that each point belongs to.
        edges: SUMO edge ids in order, without internal ones.
        signals: Signals in order of ``s``.
        stop_signs: (k,) arc length of the stop lines at which the route's movement must stop first
            (a stop sign, an all-way stop), metres, ascending.
    """

    runs: tuple[LaneRun, ...]
    line: FloatArray
    arc: FloatArray
    speed_limits: FloatArray
    point_lanes: NDArray[np.int64]
    edges: tuple[str, ...]
    signals: tuple[RouteSignal, ...]
    stop_signs: FloatArray

    def __post_init__(self) -> None:
        """Makes the arrays read-only: since routes are shared."""
        make_read_only(self.line, self.arc, self.speed_limits, self.point_lanes, self.stop_signs)

    @property
    def length(self) -> float:
        """Length from start to destination, metres."""
        return float(self.arc[-1])
