"""Progress of an ego compared with a free drive along its route.

nuPlan compares with the expert of its log. Runs here have no log: a computed drive of the same
route without other actors stands in. It begins where and as fast as the ego, drives at the speed
limits, in bends as fast as ``idm``, and accelerates and brakes as that does on a free road. It ends
at the destination, and nuPlan's run is as long as the log: so the ego's progress counts up to that
moment. Where the ego stood at a signal that was not green, the free drive stops as well; the time
of standing there counts for neither, as for the oracle ``destination``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.agents.idm.car_following import MAX_ACCELERATION
from drivora_service.agents.speed_profile import (
    PLANNED_BRAKING,
    free_speeds,
    slow_down_in_time,
)
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.projection import project_points
from drivora_service.observations.recorded_conditions import road_frictions
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import EgoCol
from drivora_service.oracles.blocked import STANDING_SPEED, waiting_at_signal

SPACING = 1.0
"""Greatest distance between the places of the free drive, metres."""

LEAST_ADVANCE = 3.0
"""Metres between two stops of the free drive."""

NEGLIGIBLE = 2.0
"""Metres up to which progress counts as this much; further backwards it is none (nuPlan)."""

_DRY = 1.0
"""Friction that is assumed for runs recorded without it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeFlow:
    """An ego's progress and that of the free drive, in the same time.

    Attributes:
        seconds: That time: up to the end of the ego's part, or of the free drive if it is earlier.
        own: Metres along the route that the ego advanced.
        free: Metres that the free drive advanced.
    """

    seconds: float
    own: float
    free: float

    @property
    def ratio(self) -> float:
        """The ego's share of the free drive's progress, 0..1, by nuPlan's rule."""
        if self.own < -NEGLIGIBLE:
            return 0.0
        return min(max(self.own, NEGLIGIBLE) / max(self.free, NEGLIGIBLE), 1.0)


def free_flow(ego: EgoView) -> FreeFlow | None:
    """Compares an ego with a free drive.

    Returns:
        ``None`` if the ego's place on its route is never known, or no speed limit along it is.
    """
    place = ego.value(EgoCol.ROUTE_S)
    known = np.flatnonzero(np.isfinite(place))
    if not len(known):
        return None
    start = min(max(float(place[known[0]]), 0.0), ego.route.length)
    waits = (ego.speed < STANDING_SPEED) & waiting_at_signal(ego)
    stops = [float(place[first]) for first, _ in stretches(waits)]
    free = _free_drive(ego, start, stops)
    if free is None:
        return None
    places, times = free
    waits[0] = True
    clock = np.cumsum(~waits, dtype=np.float64) * ego.step_length
    seconds = min(float(clock[-1]), float(times[-1]))
    return FreeFlow(
        seconds=seconds,
        own=float(np.interp(seconds, clock[known], place[known])) - start,
        free=float(np.interp(seconds, times, places)) - start,
    )


def _free_drive(
    ego: EgoView, start: float, stops: list[float]
) -> tuple[FloatArray, FloatArray] | None:
    """Returns places (m,) along the route, and the seconds to each.

    Args:
        ego: The ego.
        start: First place, metres along the route.
        stops: Places at which to stop, in the order of time.
    """
    route = ego.route
    count = max(math.ceil((route.length - start) / SPACING), 1) + 1
    places = np.linspace(start, route.length, count)
    line = np.column_stack([np.interp(places, route.arc, route.line[:, axis]) for axis in (0, 1)])
    limits = _limits(ego, line)
    if limits is None:
        return None
    # In weather that changes, the least.
    friction = float(np.nan_to_num(road_frictions(ego.trace, ego.first, ego.count), nan=_DRY).min())
    speeds = free_speeds(line, places, limits, friction)
    speeds[0] = min(speeds[0], max(float(ego.forward_speed[0]), 0.0))
    last = start
    for stop in stops:
        # In a queue that moves up by less, the first stop stands for all.
        if stop >= last + LEAST_ADVANCE:
            speeds[int(np.argmin(np.abs(places - stop)))] = 0.0
            last = stop
    slow_down_in_time(speeds, places, PLANNED_BRAKING * friction)
    # Accelerating forwards in time is braking backwards.
    backwards = speeds[::-1].copy()
    slow_down_in_time(backwards, places[-1] - places[::-1], MAX_ACCELERATION)
    speeds = backwards[::-1]
    # Exact at a constant acceleration; both are 0 only where a route has no length.
    pieces = np.diff(places) * 2.0 / np.maximum(speeds[1:] + speeds[:-1], 1e-9)
    return places, np.concatenate(([0.0], np.cumsum(pieces)))


def _limits(ego: EgoView, line: FloatArray) -> FloatArray | None:
    """Returns the (m,) speed limits at the points of a line; ``None`` if it is off all lanes."""
    along = np.diff(line, axis=0)
    headings = elementary.arctan2(along[:, 1], along[:, 0])
    lanes = project_points(ego.network, line, np.append(headings, headings[-1])).lane
    on = np.flatnonzero(lanes >= 0)
    if not len(on):
        return None
    limits: FloatArray = np.array(
        [ego.network.lanes[lane].speed_limit for lane in lanes[on].tolist()]
    )
    # Between lanes, where a route changes over, the limit of the lane before holds on.
    before = np.maximum(np.searchsorted(on, np.arange(len(line)), side="right") - 1, 0)
    held: FloatArray = limits[before]
    return held
