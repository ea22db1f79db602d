"""The intelligent-driver agent with discretionary lane changes by MOBIL.

It drives like ``idm``, and also changes lanes for an advantage: to overtake, and back to the
lanes from which its route can be followed. Source of the lane-change model: Kesting, Treiber,
Helbing, *General lane-changing model MOBIL for car-following models* (2007).
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.idm.car_following import follow
from drivora_service.agents.idm.conflicts import LineCol
from drivora_service.agents.idm.corridor import lane_is_free, perceived_actors
from drivora_service.agents.idm.driver import IdmDriver
from drivora_service.agents.idm.run_following import RunFollower, WayCol
from drivora_service.agents.idm_mobil.incentive import Neighbours, find_neighbours, incentive
from drivora_service.agents.idm_mobil.lane_ways import LaneWays, Place, Places
from drivora_service.agents.idm_mobil.parameters import MobilParameters
from drivora_service.agents.interface import AccelerationControl, AgentContext, Observation
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.line_tracking import track_line

_PERIOD = 0.5
"""Seconds between checks of the adjacent lanes."""
_PAUSE = 4.0
"""Seconds after a lane change before the next discretionary one."""
_CHANGE_TIME = 10.0
"""Seconds before its completion is due at which a lane change of the route begins."""
_CHANGE_ROOM = 80.0
"""Metres before its completion is due at which it begins at least."""
_ROUTE_PULL = 2.0
"""Incentive of the route's lanes if they must be reached immediately, m/s²."""
_PULL_TIME = 25.0
"""Seconds before a lane must be left from which on the route adds an incentive."""
_BETWEEN_LANES = 1.3
"""Metres beside the new lane's centre up to which actors in the old lane are in the way."""
_CHANGED = 0.3
"""Metres beside the new lane's centre at which a change is complete."""
_SIDE_ACCELERATION = 3.0
"""Maximum lateral acceleration of a lane change, m/s²."""


class MobilAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, parameters: MobilParameters) -> None:
        self._parameters = parameters

    def setup_env(self, context: AgentContext) -> None:
        """Finds the ways to the destination from all lanes along the route."""
        model = context.model
        self._context = context
        self._half_length, self._half_width = 0.5 * model.length, 0.5 * model.width
        self._wheelbase = model.wheelbase
        self._max_braking = min(model.max_deceleration, 9.81 * context.friction)
        self._runs = RunFollower(context, self._parameters.speed_factor)
        self._driver = IdmDriver(context)
        self._ways = LaneWays(context.network, context.route)
        self._places = Places(context.network, context.route, 0)
        self._lines: dict[tuple[int, int], FloatArray] = {}
        self._here, self._there = np.zeros(len(Neighbours)), np.zeros(len(Neighbours))
        self._left_lane: FloatArray | None = None
        self._next_look = 0.0

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Returns the control of a step, after a lane change that is due or that pays."""
        runs, time = self._runs, observation.time
        runs.wait(observation.speed)
        if self._must_change(observation.speed):
            before = self._place()
            if runs.change_when_possible(observation) and before is not None:
                self._leave(before, time)
        elif time >= self._next_look:
            self._next_look = time + _PERIOD
            self._change_if_it_pays(observation)
        control = self._driver.drive(observation, runs)
        return control if self._left_lane is None else self._between_lanes(observation, control)

    def _place(self) -> Place | None:
        place = self._places.at(
            self._runs.current, float(self._runs.way.run.arc[self._runs.cursor])
        )
        return place if place is not None and self._ways.knows(place) else None

    def _must_change(self, speed: float) -> bool:
        """Returns whether the next lane change of the route is due."""
        if self._runs.onward is None:
            return False
        run = self._runs.way.run
        left = run.end_s - float(run.arc[self._runs.cursor])
        return left < max(_CHANGE_ROOM, _CHANGE_TIME * speed)

    def _line(self, place: Place) -> FloatArray:
        key = (place.stage, place.lane)
        if key not in self._lines:
            self._lines[key] = self._ways.line(place)
        return self._lines[key]

    def _change_if_it_pays(self, observation: Observation) -> None:
        place, v = self._place(), observation.speed
        if place is None or self._ways.to_lane_end(place) < max(20.0, 2.0 * v):
            return
        self._look(self._line(place), observation, self._here)
        # Nearer than this, the next actor of the old lane would be hit during the change.
        if self._here[Neighbours.GAP_AHEAD] < 4.0 + 0.8 * v:
            return
        wanted = float(self._runs.way.points[self._runs.cursor, WayCol.WANTED])
        best, chosen = self._parameters.threshold, None
        for left in (True, False):
            beside = self._ways.beside(place, left=left)
            if beside is None:
                continue
            gain = self._gain(place, beside, observation, wanted)
            gain += -self._parameters.bias if left else self._parameters.bias
            if gain > best:
                best, chosen = gain, beside
        if chosen is not None and self._take(chosen, observation):
            self._leave(place, observation.time)

    def _gain(self, place: Place, beside: Place, observation: Observation, wanted: float) -> float:
        """Returns the gain of a lane change, m/s²: MOBIL's incentive and that of the route."""
        v = observation.speed
        stays, _ = self._ways.room(place)
        room, changes = self._ways.room(beside)
        if room < changes * 2.0 * max(_CHANGE_ROOM, _CHANGE_TIME * v):
            return -np.inf
        self._look(self._line(beside), observation, self._there)
        parameters = self._parameters
        gain = float(
            incentive(
                v, wanted, 2.0 * self._half_length, self._here, self._there,
                parameters.politeness, parameters.safe_braking,
            )
        )  # fmt: skip
        horizon = 2.0 * _CHANGE_ROOM + _PULL_TIME * v
        return gain + _ROUTE_PULL * (_nearness(stays, horizon) - _nearness(room, horizon))

    def _look(self, line: FloatArray, observation: Observation, out: FloatArray) -> None:
        x, y = observation.ego[:2].tolist()
        find_neighbours(
            line, x, y, self._half_length, self._half_width, observation.objects,
            observation.object_sizes, out,
        )  # fmt: skip

    def _take(self, place: Place, observation: Observation) -> bool:
        """Changes to the way from an adjacent place, if there is room."""
        line = self._line(place)
        x, y = observation.ego[:2].tolist()
        nearest = int(np.argmin(np.hypot(line[:, LineCol.X] - x, line[:, LineCol.Y] - y)))
        points, arc = (
            np.ascontiguousarray(line[:, : LineCol.ARC]),
            np.ascontiguousarray(line[:, LineCol.ARC]),
        )
        cursor, s, _ = track_line(points, arc, nearest, 5, 5, x, y)
        if not lane_is_free(
            points, arc, cursor, s, observation.speed, self._half_length,
            perceived_actors(observation),
        ):  # fmt: skip
            return False
        route = self._ways.route(place)
        run = route.runs[0]
        near = np.hypot(run.line[:, 0] - x, run.line[:, 1] - y)
        near[np.abs(run.arc - run.start_s) > 30.0] = np.inf
        self._runs.follow(route, min(int(np.argmin(near)), len(run.line) - 2))
        self._places = Places(self._context.network, route, place.stage)
        self._context.log.event(f"moves over to lane {place.lane}")
        return True

    def _leave(self, place: Place, time: float) -> None:
        self._left_lane = self._line(place)
        self._next_look = time + _PAUSE

    def _between_lanes(
        self, observation: Observation, control: AccelerationControl
    ) -> AccelerationControl:
        """Keeps a lane change smooth, and avoids actors in the old lane until it has left it."""
        way, cursor, v = self._runs.way, self._runs.cursor, observation.speed
        x, y = observation.ego[:2].tolist()
        _, _, lateral = track_line(way.run.line, way.run.arc, cursor, 5, 5, x, y)
        if abs(lateral) < _CHANGED or self._left_lane is None:
            self._left_lane = None
            return control
        most = math.atan(self._wheelbase * _SIDE_ACCELERATION / max(v * v, 1.0))
        steer = min(max(control.steer, -most), most)
        acceleration = control.acceleration
        if abs(lateral) > _BETWEEN_LANES:
            self._look(self._left_lane, observation, self._here)
            wanted = float(way.points[cursor, WayCol.WANTED])
            gap = float(self._here[Neighbours.GAP_AHEAD])
            other = float(self._here[Neighbours.SPEED_AHEAD])
            kept = follow(v, wanted, max(gap, 0.1), other, self._max_braking)
            acceleration = min(acceleration, kept)
        return AccelerationControl(acceleration, steer)


def _nearness(room: float, horizon: float) -> float:
    """Returns the nearness of the end of a lane's use: 0 beyond the horizon, 1 at the end."""
    return max(0.0, 1.0 - room / horizon)
