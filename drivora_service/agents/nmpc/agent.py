"""An ADS that plans by nonlinear model-predictive control.

Each step an optimal control problem over 2.8 s is solved (:mod:`problem`): a kinematic bicycle
tracks a reference along the lane run, behind halts and leaders, within its lane and outside the
predicted boxes of others. Lights, right of way and the lane changes that the route needs
are those of ``idm``, the forecast that of ``pdm-closed``.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from drivora_service.agents.idm.car_following import MAX_ACCELERATION
from drivora_service.agents.idm.corridor import SIDE_ROOM, TIGHT_ROOM, Actors, gap_on_line
from drivora_service.agents.idm.right_of_way import HARD_BRAKING, PATIENCE, find_halt, next_signal
from drivora_service.agents.idm.run_following import STANDING_SPEED, RunFollower, WayCol
from drivora_service.agents.interface import (
    AccelerationControl,
    AgentContext,
    ObjectKind,
    Observation,
)
from drivora_service.agents.nmpc.parameters import NmpcParameters
from drivora_service.agents.nmpc.plan import LastPlan
from drivora_service.agents.nmpc.problem import (
    BOX,
    BOXES,
    REFERENCE,
    SLACKS,
    STAGES,
    CarLimits,
    ReferenceCol,
    StateCol,
    problem_for,
)
from drivora_service.agents.nmpc.reference import (
    Bounds,
    PlaceCol,
    PlanningCar,
    PlanStart,
    lay_boxes,
    roll_out,
)
from drivora_service.agents.pdm_closed.forecast import (
    STEPS,
    FutureCol,
    SeenCol,
    forecast,
    see_from_way,
)
from drivora_service.agents.pdm_closed.margins import side_margins
from drivora_service.agents.pdm_closed.paths import LanePaths
from drivora_service.agents.pdm_closed.proposals import SeenActors
from drivora_service.agents.plugin import read_agent_parameters
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col

_LARGEST_OFFSET = 1.0
_EDGE_ROOM = 0.15
_WATCHED = 40.0
"""Radius within which all actors count, metres; beyond, those that can come near in time."""
_OVERSPEED = 5.0
"""m/s beyond the car's top speed that a plan may reach: a scenario may begin there."""
_HOLD = -1.0
"""Commanded acceleration at rest, m/s²."""


class _Logged(IntEnum):
    """Columns of the agent's log."""

    SOLVED = 0
    ITERATIONS = 1
    PLANNED_SPEED = 2
    SLACK = 3
    HALT_DISTANCE = 4


class NmpcAgent:
    """The agent. One object drives one ego through one run."""

    def __init__(self, parameters: NmpcParameters, folder: Path) -> None:
        """Args: folder: Folder with CasADi."""
        self._parameters, self._folder = parameters, folder

    def setup_env(self, context: AgentContext) -> None:
        """Finds the lane runs of the route and the room beside them, and makes the solver."""
        model = context.model
        self._runs = RunFollower(context, self._parameters.speed_factor)
        self._half_length, self._half_width = 0.5 * model.length, 0.5 * model.width
        self._sides = [
            _sides(side_margins(context.network, way.run), self._half_width)
            for way in self._runs.ways
        ]
        self._paths = LanePaths(context.network)
        self._max_braking = min(model.max_deceleration, 9.81 * context.friction)
        self._car = PlanningCar(
            self._half_length, self._half_width, self._max_braking, model.max_speed
        )
        self._problem = problem_for(
            self._folder,
            CarLimits(
                wheelbase=model.wheelbase,
                max_braking=self._max_braking,
                max_acceleration=MAX_ACCELERATION,
                max_steer=model.max_steer,
                max_speed=model.max_speed + _OVERSPEED,
            ),
            self._parameters.max_iterations,
        )
        self._reference = np.zeros((STAGES + 1, REFERENCE))
        self._places = np.zeros((STAGES + 1, len(PlaceCol)))
        self._boxes = np.zeros((STAGES + 1, BOXES, BOX))
        self._plan = LastPlan(context.step_length)
        self._asked = 0.0
        self._log = context.log
        self._log.declare(*(column.name.lower() for column in _Logged))

    def run_step(self, observation: Observation) -> AccelerationControl:
        """Returns the first control of the plan; without a solution, brakes along the last plan."""
        halt_distance = self._fill_reference(observation)
        reference, boxes = self._reference.copy(), self._boxes.copy()
        x, y, yaw = observation.ego[[Col.X, Col.Y, Col.YAW]].tolist()
        # Coordinates relative to the car, since large ones reduce the solver's precision.
        reference[:, :2] -= (x, y)
        boxes[:, :, :2] -= (x, y)
        v = observation.speed
        start = np.array([0.0, 0.0, yaw, v, _limit_acceleration(self._asked, v), observation.steer])
        guess = self._plan.guess(start, reference, (x, y))
        sides = self._places[:, PlaceCol.LEAST :]
        found = self._problem.solve(start, reference, sides, boxes, *guess)
        row = self._log.row
        row[_Logged.SOLVED], row[_Logged.ITERATIONS] = float(found.solved), found.iterations
        row[_Logged.SLACK], row[_Logged.HALT_DISTANCE] = 0.0, halt_distance
        if found.solved:
            asked, steer = self._plan.take(found.states, found.inputs, (x, y))
            row[_Logged.PLANNED_SPEED] = found.states[-1, StateCol.SPEED]
            row[_Logged.SLACK] = found.inputs[:, SLACKS].max()
            self._log.plan(found.states[:, :2] + (x, y))
        else:
            if not self._plan.failures:
                self._log.event(f"no plan ({found.status}): brakes along the last one")
            steer = self._plan.go_on(v, observation.steer)
            asked, row[_Logged.PLANNED_SPEED] = -min(HARD_BRAKING, self._max_braking), 0.0
        if v < STANDING_SPEED and self._reference[:, ReferenceCol.SPEED].max() < STANDING_SPEED:
            asked = _HOLD
        self._asked = asked
        return AccelerationControl(asked, steer)

    def _fill_reference(self, observation: Observation) -> float:
        """Fills in reference and boxes; returns the distance that the front bumper may advance."""
        runs, v, ego = self._runs, observation.speed, observation.ego
        runs.wait(v)
        runs.change_when_possible(observation)
        way = runs.way
        line, arc = way.points[:, : WayCol.ARC], way.points[:, WayCol.ARC]
        runs.cursor, s, lateral = track_line(line, arc, runs.cursor, 5, 30, *ego[:2].tolist())
        watched = _find_watched(observation)
        objects, sizes = observation.objects[watched], observation.object_sizes[watched]
        kinds, ids = observation.object_kinds[watched], observation.object_ids[watched]
        future = np.empty((STEPS + 1, len(objects), len(FutureCol)))
        seen = np.empty((STEPS + 1, len(objects), len(SeenCol)))
        spans = self._paths.spans(observation.step, objects, kinds, ids)
        forecast(objects, spans, self._paths.points, future)
        see_from_way(way.points, runs.cursor, sizes, future, seen)
        room = SIDE_ROOM if runs.waited < PATIENCE else TIGHT_ROOM
        find_ahead = partial(
            gap_on_line, line, arc, runs.cursor, s, min(90.0, 25.0 + 4.0 * v), self._half_length,
            self._half_width, room, v,
        )  # fmt: skip
        actors = Actors(objects, sizes, kinds)
        halt_distance = find_halt(
            v, s, float(way.points[runs.cursor, WayCol.WANTED]), runs.waited,
            next_signal(observation), actors, self._half_length, way.wall, way.conflicts,
            find_ahead(actors),
        )  # fmt: skip
        walkers = kinds == ObjectKind.WALKER
        step_in, pace, _ = find_ahead(Actors(objects[walkers], sizes[walkers], kinds[walkers]))
        roll_out(
            PlanStart(v, self._asked, float(ego[Col.YAW]), runs.cursor, s, lateral),
            self._car,
            way.points,
            Bounds(
                stop=s + self._half_length + halt_distance,
                walker_rear=s + step_in,
                walker_speed=max(pace, 0.0),
                sides=self._sides[runs.current],
            ),
            SeenActors(seen, kinds, room),
            self._reference,
            self._places,
        )
        lay_boxes(self._reference, self._half_length, self._half_width, future, sizes, self._boxes)
        return halt_distance


def create(parameters: Mapping[str, Any], folder: Path) -> NmpcAgent:
    """Makes the agent with the CasADi in ``folder``.

    Raises:
        AgentError: If it rejects these parameters.
    """
    return NmpcAgent(read_agent_parameters("nmpc", NmpcParameters, parameters), folder)


def _sides(margins: FloatArray, half_width: float) -> FloatArray:
    """Returns the (n, 2) least and largest offset of the centre that the road allows."""
    left, right = np.clip(margins[:, :2] - half_width - _EDGE_ROOM, 0.0, _LARGEST_OFFSET).T
    return np.column_stack((-right, left))


def _find_watched(observation: Observation) -> IntArray:
    """Returns the rows of the actors that can come near within the forecast."""
    objects, ego = observation.objects, observation.ego
    away = np.hypot(objects[:, Col.X] - ego[Col.X], objects[:, Col.Y] - ego[Col.Y])
    speeds = np.hypot(objects[:, Col.VX], objects[:, Col.VY])
    rows: IntArray = np.flatnonzero(away < _WATCHED + 4.0 * (observation.speed + speeds))
    return rows


def _limit_acceleration(acceleration: float, v: float) -> float:
    """Returns the initial acceleration of a plan, which does not lead below standstill."""
    return max(acceleration, -max(v, 0.0) / 0.25)
