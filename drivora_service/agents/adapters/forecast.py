"""Forecast of other actors: vehicles along their lane, walkers and obstacles straight on.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.adapters.path_lines import arc_of
from drivora_service.agents.interface import Observation
from drivora_service.agents.remote.views import LaneView
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col

_VEHICLE = 0
_WAY_AHEAD = 120.0
"""Maximum length of lanes that are followed, metres."""

_ODD_HEADING = 0.8
"""Maximum angle between a vehicle and the lane that it follows, radians."""

_BRAKING = -0.5
"""m/s²; actors that brake harder are predicted to continue braking."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Forecast:
    """Predicted poses of other actors.

    Attributes:
        ids: (n,) as in the observation.
        kinds: (n,) as in the observation.
        sizes: (n, 2) length and width, metres.
        speeds: (n,) present speeds, m/s.
        poses: (n, t, 3) x, y and yaw at each requested time.
    """

    ids: NDArray[np.int64]
    kinds: NDArray[np.int64]
    sizes: FloatArray
    speeds: FloatArray
    poses: FloatArray


class LaneForecaster:
    """Predicts other actors from the lanes around a route."""

    def __init__(self, lanes: Mapping[int, LaneView]) -> None:
        """Args: lanes: Lanes by id."""
        self._lanes = lanes
        self._ways: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._ids = np.array([lane.id for lane in lanes.values() for _ in lane.line[1:]])
        if len(self._ids):
            self._starts = np.concatenate([lane.line[:-1] for lane in lanes.values()])
            self._steps = np.concatenate([np.diff(lane.line, axis=0) for lane in lanes.values()])
            self._headings = np.arctan2(self._steps[:, 1], self._steps[:, 0])
            self._squares = np.maximum((self._steps**2).sum(axis=1), 1e-9)
            self._half_widths = np.array(
                [0.5 * lane.width for lane in lanes.values() for _ in lane.line[1:]]
            )

    def foresee(self, observation: Observation, times: FloatArray, most: int) -> Forecast:
        """Predicts the nearest actors.

        Args:
            observation: The observation.
            times: (t,) seconds from now, ascending.
            most: Maximum number of actors.
        """
        objects = observation.objects
        away = np.hypot(*(objects[:, :2] - observation.ego[:2]).T)
        near = np.argsort(away, kind="stable")[:most]
        poses = np.empty((len(near), len(times), 3))
        speeds = np.hypot(objects[near, Col.VX], objects[near, Col.VY])
        for row, k in enumerate(near.tolist()):
            travelled = _compute_distances(objects[k], float(speeds[row]), times)
            way = None
            if observation.object_kinds[k] == _VEHICLE and speeds[row] > 0.5:
                way = self._way_of(objects[k])
            poses[row] = (
                _straight_on(objects[k], travelled)
                if way is None
                else _along(*way, objects[k], travelled)
            )
        return Forecast(
            ids=observation.object_ids[near],
            kinds=observation.object_kinds[near],
            sizes=observation.object_sizes[near],
            speeds=speeds,
            poses=poses,
        )

    def _way_of(self, state: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Returns the lanes that a vehicle follows, as a line and its arc lengths."""
        if not len(self._ids):
            return None
        place = state[[Col.X, Col.Y]]
        share = ((place - self._starts) * self._steps).sum(axis=1) / self._squares
        feet = self._starts + np.clip(share, 0.0, 1.0)[:, None] * self._steps
        gaps = np.hypot(*(feet - place).T)
        turns = np.abs(np.mod(self._headings - state[Col.YAW] + math.pi, math.tau) - math.pi)
        fits = (gaps < self._half_widths) & (turns < _ODD_HEADING)
        if not fits.any():
            return None
        # A junction's lanes overlap: the heading distinguishes them.
        best = int(np.argmin(np.where(fits, gaps + 3.0 * turns, np.inf)))
        lane = int(self._ids[best])
        if lane not in self._ways:
            line = self._lines_ahead(lane)
            self._ways[lane] = line, arc_of(line)
        return self._ways[lane]

    def _lines_ahead(self, lane: int) -> FloatArray:
        """Returns the line of a lane and those that follow, always the straightest."""
        pieces, length = [], 0.0
        current: int | None = lane
        while current is not None and length < _WAY_AHEAD:
            view = self._lanes[current]
            pieces.append(view.line)
            length += float(arc_of(view.line)[-1])
            following = [self._lanes[k] for k in view.successors if k in self._lanes]
            current = min(following, key=_turn_of).id if following else None
        joined = np.concatenate(pieces)
        apart = np.hypot(*np.diff(joined, axis=0, prepend=joined[:1] - 1.0).T) > 1e-6
        whole: FloatArray = joined[apart]
        return whole


def leave_out_followers(others: Forecast, observation: Observation) -> Forecast:
    """Omits actors that drive behind the vehicle, which must keep their distance."""
    x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
    away = others.poses[:, 0, :2] - (x, y)
    along = away[:, 0] * math.cos(yaw) + away[:, 1] * math.sin(yaw)
    across = away[:, 1] * math.cos(yaw) - away[:, 0] * math.sin(yaw)
    turn = np.abs(np.mod(others.poses[:, 0, 2] - yaw + math.pi, math.tau) - math.pi)
    behind = (along < -3.0) & (np.abs(across) < 1.8) & (turn < 1.0)
    return Forecast(
        ids=others.ids[~behind],
        kinds=others.kinds[~behind],
        sizes=others.sizes[~behind],
        speeds=others.speeds[~behind],
        poses=others.poses[~behind],
    )


def _turn_of(lane: LaneView) -> float:
    (ax, ay), (bx, by) = lane.line[1] - lane.line[0], lane.line[-1] - lane.line[-2]
    return abs(math.remainder(math.atan2(by, bx) - math.atan2(ay, ax), math.tau))


def _compute_distances(state: FloatArray, speed: float, times: FloatArray) -> FloatArray:
    """Returns (t,) metres: at constant speed, or with continued braking until standstill."""
    forward = state[Col.AX] * math.cos(state[Col.YAW]) + state[Col.AY] * math.sin(state[Col.YAW])
    if forward > _BRAKING or speed < 1e-3:
        return speed * times
    until = np.minimum(times, -speed / forward)
    metres: FloatArray = speed * until + 0.5 * forward * until**2
    return metres


def _straight_on(state: FloatArray, travelled: FloatArray) -> FloatArray:
    x, y, yaw = state[[Col.X, Col.Y, Col.YAW]].tolist()
    course = math.atan2(state[Col.VY], state[Col.VX])
    return np.column_stack(
        (
            x + travelled * math.cos(course),
            y + travelled * math.sin(course),
            np.full(len(travelled), yaw),
        )
    )


def _along(
    line: FloatArray, arc: FloatArray, state: FloatArray, travelled: FloatArray
) -> FloatArray:
    """Returns (t, 3) poses along a line, at the present lateral distance."""
    place = state[[Col.X, Col.Y]]
    steps = np.diff(line, axis=0)
    share = ((place - line[:-1]) * steps).sum(axis=1) / (steps**2).sum(axis=1)
    share = np.clip(share, 0.0, 1.0)
    away = place - (line[:-1] + share[:, None] * steps)
    k = int(np.argmin((away**2).sum(axis=1)))
    headings = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    beside = away[k, 1] * math.cos(headings[k]) - away[k, 0] * math.sin(headings[k])
    s = arc[k] + share[k] * (arc[k + 1] - arc[k]) + travelled
    yaw = headings[np.clip(np.searchsorted(arc, s, side="right") - 1, 0, len(headings) - 1)]
    beyond = np.maximum(s - arc[-1], 0.0)
    x = np.interp(s, arc, line[:, 0]) + beyond * np.cos(yaw) - beside * np.sin(yaw)
    y = np.interp(s, arc, line[:, 1]) + beyond * np.sin(yaw) + beside * np.cos(yaw)
    return np.column_stack((x, y, yaw))
