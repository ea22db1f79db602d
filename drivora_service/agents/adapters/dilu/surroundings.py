"""The actors around the vehicle, relative to its route.

Frame: that of the route; gaps are between bumpers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.adapters.dilu.road import RouteFrame
from drivora_service.agents.adapters.dilu.situation import Beside, Neighbour
from drivora_service.agents.adapters.forecast import LaneForecaster, leave_out_followers
from drivora_service.agents.interface import Observation
from drivora_service.agents.remote.views import VehicleView
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col

_OTHERS = 20
_TIMES = np.arange(0.5, 4.01, 0.5)
"""Times at which other actors are predicted, seconds."""

_SIDE, _LONG = 0.3, 2.0
"""Margins in metres, beside, and before and behind crossing actors."""

_START = 1.5
"""Acceleration of driving off for the check of crossing actors, m/s²."""

_SIGHT = 100.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Surroundings:
    """The vehicle and the other actors at one step.

    Attributes:
        s: s of the vehicle's centre.
        d: d of the vehicle's centre.
        turn: Radians from the route's direction to the vehicle's.
        places: (n, 2) s and d of the others.
        extents: (n, 2) half extents along and across.
        speeds: (n,) along the route, m/s.
        foreseen: (n, t, 2) s and d of the others in the next seconds.
        half_length: Half length of the vehicle.
        half_width: Half width of the vehicle.
        speed: Speed of the vehicle, m/s.
    """

    s: float
    d: float
    turn: float
    places: FloatArray
    extents: FloatArray
    speeds: FloatArray
    foreseen: FloatArray
    half_length: float
    half_width: float
    speed: float

    def ahead(self, low: float, high: float) -> Neighbour | None:
        """Returns the next actor ahead between two offsets from the vehicle's centre."""
        inside = self._within(self.places[:, 1], low, high)
        gaps = self.places[:, 0] - self.s - self.extents[:, 0] - self.half_length
        ahead = inside & (self.places[:, 0] > self.s)
        return self._nearest(ahead, gaps)

    def behind(self, low: float, high: float) -> Neighbour | None:
        """Returns the next actor behind, likewise."""
        inside = self._within(self.places[:, 1], low, high)
        gaps = self.s - self.places[:, 0] - self.extents[:, 0] - self.half_length
        return self._nearest(inside & (self.places[:, 0] <= self.s), gaps)

    def beside(self, offset: float) -> Beside:
        """Returns the actors in the lane whose centre is at an offset."""
        return Beside(ahead=self.ahead(offset, offset), behind=self.behind(offset, offset))

    def crossing_distance(self, low: float, high: float) -> float | None:
        """Returns the metres to a place that a crossing actor and the vehicle reach together."""
        if not len(self.places):
            return None
        s, d = self.foreseen[:, :, 0], self.foreseen[:, :, 1]
        side = self.half_width + self.extents[:, 1:] + _SIDE
        comes = (d > low - side) & (d < high + side)
        comes &= ~self._within(self.places[:, 1], low, high)[:, None]
        # At standstill, assume that it drives off.
        ours = self.s + np.maximum(self.speed * _TIMES, 0.5 * _START * _TIMES**2)
        along = self.half_length + self.extents[:, :1] + _LONG
        comes &= (np.abs(s - ours) < along) & (s > self.s)
        if not comes.any():
            return None
        gaps = s - self.extents[:, :1] - self.half_length - self.s
        return max(float(gaps[comes].min()) - _LONG, 0.0)

    def _within(self, d: FloatArray, low: float, high: float) -> NDArray[np.bool_]:
        side = self.half_width + self.extents[:, 1] + _SIDE
        inside: NDArray[np.bool_] = (d > low - side) & (d < high + side)
        return inside

    def _nearest(self, which: NDArray[np.bool_], gaps: FloatArray) -> Neighbour | None:
        rows = np.flatnonzero(which & (gaps < _SIGHT))
        if not len(rows):
            return None
        k = int(rows[np.argmin(gaps[rows])])
        return Neighbour(gap=max(float(gaps[k]), 0.0), speed=float(self.speeds[k]))


def look_around(
    observation: Observation,
    frame: RouteFrame,
    forecaster: LaneForecaster,
    vehicle: VehicleView,
    near: float,
) -> Surroundings:
    """Returns the perceived actors in the frame of the route.

    Args:
        observation: The observation.
        frame: Frame of the route.
        forecaster: Forecaster of the others.
        vehicle: The driven vehicle.
        near: Approximate place along the route, metres.
    """
    x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
    (s,), (d,), (heading,) = frame.project(np.array([[x, y]]), near)
    now = forecaster.foresee(observation, np.array([0.0, *_TIMES]), _OTHERS)
    others = leave_out_followers(now, observation)
    # Followers do not count as crossing but as actors behind, so they are needed too.
    count = len(now.ids)
    placed_s, placed_d, headings = frame.project(now.poses[:, :, :2].reshape(-1, 2), near)
    shape = count, len(_TIMES) + 1
    grid = np.stack((placed_s, placed_d), axis=-1).reshape(*shape, 2)
    turns = now.poses[:, 0, 2] - headings.reshape(shape)[:, 0]
    cos, sin = np.abs(np.cos(turns)), np.abs(np.sin(turns))
    long, wide = 0.5 * now.sizes[:, 0], 0.5 * now.sizes[:, 1]
    foreseen = grid[:, 1:].copy()
    foreseen[~np.isin(now.ids, others.ids)] = np.nan
    return Surroundings(
        s=float(s),
        d=float(d),
        turn=math.remainder(yaw - float(heading), math.tau),
        places=grid[:, 0],
        extents=np.column_stack((cos * long + sin * wide, cos * wide + sin * long)),
        speeds=now.speeds * np.cos(turns),
        foreseen=foreseen,
        half_length=0.5 * vehicle.length,
        half_width=0.5 * vehicle.width,
        speed=max(observation.speed, 0.0),
    )
