"""Who is where around the vehicle, seen along its route.

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
from drivora_service.geometry.arrays import FloatArray
from drivora_service.observations.trace import Col

_OTHERS = 20
_TIMES = np.arange(0.5, 4.01, 0.5)
"""Seconds at which others are foreseen."""

_SIDE, _LONG = 0.3, 2.0
"""Metres that are kept free beside, and before and behind whoever crosses."""

_START = 1.5
"""m/s² with which the vehicle would drive off where somebody crosses."""

_SIGHT = 100.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Surroundings:
    """The vehicle and the others at one step.

    Attributes:
        s: Of the vehicle's centre.
        d: Of the vehicle's centre.
        turn: Radians from the route's direction to the vehicle's.
        places: (n, 2) s and d of the others.
        extents: (n, 2) half of what they take up along and across.
        speeds: (n,) along the route, m/s.
        foreseen: (n, t, 2) s and d of the others in the seconds to come.
        half_length: Of the vehicle.
        half_width: Of the vehicle.
        speed: Of the vehicle, m/s.
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
        """Returns who is next ahead between two offsets of the vehicle's centre."""
        inside = self._within(self.places[:, 1], low, high)
        gaps = self.places[:, 0] - self.s - self.extents[:, 0] - self.half_length
        ahead = inside & (self.places[:, 0] > self.s)
        return self._nearest(ahead, gaps)

    def behind(self, low: float, high: float) -> Neighbour | None:
        """The same behind."""
        inside = self._within(self.places[:, 1], low, high)
        gaps = self.s - self.places[:, 0] - self.extents[:, 0] - self.half_length
        return self._nearest(inside & (self.places[:, 0] <= self.s), gaps)

    def beside(self, offset: float) -> Beside:
        """Returns who is in the lane whose centre lies at an offset."""
        return Beside(ahead=self.ahead(offset, offset), behind=self.behind(offset, offset))

    def crossing(self, low: float, high: float) -> float | None:
        """Returns the metres to where somebody, not there yet, will be when the vehicle is."""
        if not len(self.places):
            return None
        s, d = self.foreseen[:, :, 0], self.foreseen[:, :, 1]
        side = self.half_width + self.extents[:, 1:] + _SIDE
        comes = (d > low - side) & (d < high + side)
        comes &= ~self._within(self.places[:, 1], low, high)[:, None]
        # Standing, it asks where it would be if it drove off.
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
    """Brings what is perceived into the frame of the route.

    Args:
        observation: What is perceived.
        frame: Of the route.
        forecaster: Foresees the others.
        vehicle: The one that is driven.
        near: About where it is along the route, metres.
    """
    x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
    (s,), (d,), (heading,) = frame.project(np.array([[x, y]]), near)
    now = forecaster.foresee(observation, np.array([0.0, *_TIMES]), _OTHERS)
    others = leave_out_followers(now, observation)
    # Followers are left out of what will cross, not of who is behind: they are looked up as well.
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
