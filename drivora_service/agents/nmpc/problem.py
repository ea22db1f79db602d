"""The optimal control problem of one step: a kinematic bicycle over the horizon, in CasADi.

Direct multiple shooting (Bock, Plitt 1984): the states of all stages are unknowns beside the
inputs. FATROP (Vanroye, Sathya, De Schutter, Decré 2023), an interior-point method that uses
this structure, solves it. Places are in metres from an origin near the car.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from drivora_service.agents.nmpc.casadi_files import load_casadi
from drivora_service.geometry.array_shapes import FloatArray

STAGES = 14
STAGE_TIME = 0.2
"""Seconds: the horizon is 2.8 s."""
BOXES = 4
MOST_JERK, HARDEST_JERK = 6.0, -30.0
STEER_RATE = 0.6
_FAR = 1e6
_ROLLING_BACK = 0.05
"""m/s by which a plan may be below zero; without it, a car at rest leaves no interior."""

_LATERAL, _HEADING, _SPEED, _ACCELERATION = 1.0, 2.0, 1.0, 0.1
_SIDE_ACCELERATION, _JERK, _SIDE_JERK, _WHEEL = 0.1, 0.01, 0.02, 2.0
_SLACK_LINEAR, _SLACK_SQUARE = (50.0, 5.0, 30.0), (100.0, 10.0, 100.0)
_HEADWAY = 0.5
"""Minimum headway of the plan in seconds; that of the reference is larger."""


class StateCol(IntEnum):
    """Columns of the states of a plan; the first of them are those of the reference."""

    X = 0
    Y = 1
    YAW = 2
    SPEED = 3
    ACCELERATION = 4
    STEER = 5
    """Angle of the front wheels."""


class InputCol(IntEnum):
    """Columns of the inputs of a plan: two controls, and what each kind of bound is exceeded by."""

    JERK = 0
    STEER_RATE = 1
    HALT_SLACK = 2
    """Of halts and leaders."""
    SIDE_SLACK = 3
    BOX_SLACK = 4


SLACKS = (InputCol.HALT_SLACK, InputCol.SIDE_SLACK, InputCol.BOX_SLACK)


class ReferenceCol(IntEnum):
    """Columns of the reference of a stage, which are parameters of the problem."""

    X = 0
    Y = 1
    YAW = 2
    SPEED = 3
    ACCELERATION = 4
    CURVATURE = 5
    TO_HALT = 6
    """Metres beyond the reference that the centre may go before a halt."""
    TO_LEADER = 7
    """The same behind a leader."""


class SideCol(IntEnum):
    """Columns of the offsets to the left of the reference that are allowed, metres."""

    LEAST = 0
    LARGEST = 1


class BoxCol(IntEnum):
    """Columns of a box that the car's centre must avoid."""

    X = 0
    Y = 1
    YAW = 2
    HALF_LENGTH = 3
    HALF_WIDTH = 4


STATES, INPUTS = len(StateCol), len(InputCol)
REFERENCE, SIDES, BOX = len(ReferenceCol), len(SideCol), len(BoxCol)


@dataclass(frozen=True, slots=True, kw_only=True)
class CarLimits:
    """The car's limits of the plan, SI units."""

    wheelbase: float
    max_braking: float
    max_acceleration: float
    max_steer: float
    max_speed: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """The solution of a problem.

    Attributes:
        states: (STAGES + 1, STATES).
        inputs: (STAGES, INPUTS).
        solved: Whether the solver converged.
        status: Status of the solver.
    """

    states: FloatArray
    inputs: FloatArray
    solved: bool
    iterations: int
    status: str


class Problem:
    """The problem for one kind of car; solving it has no side effects."""

    def __init__(self, casadi: ModuleType, limits: CarLimits, max_iterations: int) -> None:
        self._solver, self._lower, self._upper, self._low_g, self._up_g = _build(
            casadi, limits, max_iterations
        )

    def solve(
        self,
        start: FloatArray,
        reference: FloatArray,
        sides: FloatArray,
        boxes: FloatArray,
        states: FloatArray,
        inputs: FloatArray,
    ) -> Solution:
        """Solves the problem.

        Args:
            start: (STATES,) the present state.
            reference: (STAGES + 1, REFERENCE), columns ``ReferenceCol``.
            sides: (STAGES + 1, SIDES), columns ``SideCol``.
            boxes: (STAGES + 1, BOXES, BOX), columns ``BoxCol``.
            states: (STAGES + 1, STATES) guess.
            inputs: (STAGES, INPUTS) guess.
        """
        guess = np.concatenate(
            (np.column_stack((states[:-1], inputs)).ravel(), states[-1]), dtype=np.float64
        )
        stages = np.column_stack((reference, sides, boxes.reshape(STAGES + 1, -1)))
        found = self._solver(
            x0=guess,
            p=np.concatenate((start, stages.ravel())),
            lbx=self._lower,
            ubx=self._upper,
            lbg=self._low_g,
            ubg=self._up_g,
        )
        stats = self._solver.stats()
        values = np.asarray(found["x"]).ravel()
        rows = values[:-STATES].reshape(STAGES, STATES + INPUTS)
        finite = bool(np.isfinite(values).all())
        return Solution(
            states=np.vstack((rows[:, :STATES], values[-STATES:])),
            inputs=rows[:, STATES:],
            solved=bool(stats["success"]) and finite,
            iterations=int(stats["iter_count"]),
            status=str(stats["return_status"]),
        )


@lru_cache(maxsize=8)
def problem_for(folder: Path, limits: CarLimits, max_iterations: int) -> Problem:
    """Returns the problem of a kind of car, with CasADi from a folder."""
    return Problem(load_casadi(folder), limits, max_iterations)


def _build(
    ca: ModuleType, limits: CarLimits, max_iterations: int
) -> tuple[Any, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Returns the solver, the bounds of its unknowns and those of its constraints."""
    step = _step_function(ca, limits.wheelbase)
    start = ca.SX.sym("start", STATES)
    width = REFERENCE + SIDES + BOXES * BOX
    parameters = ca.SX.sym("parameters", width, STAGES + 1)
    least = (-_FAR, -_FAR, -_FAR, -_ROLLING_BACK, -limits.max_braking, -limits.max_steer)
    most = (_FAR, _FAR, _FAR, limits.max_speed, limits.max_acceleration, limits.max_steer)
    unknowns: list[Any] = []
    constraints: list[Any] = []
    lower: list[float] = []
    upper: list[float] = []
    low_g: list[float] = []
    up_g: list[float] = []
    equal: list[bool] = []
    cost: Any = 0
    states = [ca.SX.sym(f"x{k}", STATES) for k in range(STAGES + 1)]
    for k, x in enumerate(states):
        p = parameters[:, k]
        unknowns.append(x)
        # The present state may be outside: a plan only has to lead back inside.
        lower += [-_FAR] * STATES if k == 0 else least
        upper += [_FAR] * STATES if k == 0 else most
        along, aside = _place(ca, x, p)
        if k:
            cost += _tracking_cost(x, aside, p, limits.wheelbase)
        if k == STAGES:
            break
        u = ca.SX.sym(f"u{k}", INPUTS)
        unknowns.append(u)
        lower += [HARDEST_JERK, -STEER_RATE, 0.0, 0.0, 0.0]
        upper += [MOST_JERK, STEER_RATE, _FAR, _FAR, _FAR]
        gap = states[k + 1] - step(x, u)
        bounded = [
            along - p[ReferenceCol.TO_HALT] - u[InputCol.HALT_SLACK],
            along
            + _HEADWAY * x[StateCol.SPEED]
            - p[ReferenceCol.TO_LEADER]
            - u[InputCol.HALT_SLACK],
            p[REFERENCE + SideCol.LEAST] - aside - u[InputCol.SIDE_SLACK],
            aside - p[REFERENCE + SideCol.LARGEST] - u[InputCol.SIDE_SLACK],
            *(1.0 - distance - u[InputCol.BOX_SLACK] for distance in _distances(ca, x, p)),
        ]
        first = [x - start] if k == 0 else []
        fixed = STATES * (1 + len(first))
        constraints += [gap, *first, *bounded]
        low_g += [0.0] * fixed + [-np.inf] * len(bounded)
        up_g += [0.0] * (fixed + len(bounded))
        equal += [True] * fixed + [False] * len(bounded)
        jerk, steer_rate = u[InputCol.JERK], u[InputCol.STEER_RATE]
        side_jerk = p[ReferenceCol.SPEED] ** 2 / limits.wheelbase * steer_rate
        cost += _JERK * jerk**2 + _SIDE_JERK * side_jerk**2 + _WHEEL * steer_rate**2
        for slack, linear, square in zip(SLACKS, _SLACK_LINEAR, _SLACK_SQUARE, strict=True):
            cost += linear * u[slack] + square * u[slack] ** 2
    solver = ca.nlpsol(
        "nmpc",
        "fatrop",
        {
            "x": ca.vertcat(*unknowns),
            "f": cost,
            "g": ca.vertcat(*constraints),
            "p": ca.vertcat(start, ca.vec(parameters)),
        },
        {
            "print_time": False,
            "error_on_fail": False,
            "structure_detection": "auto",
            "equality": equal,
            "fatrop": {
                "print_level": 0,
                "max_iter": max_iterations,
                "tol": 1e-3,
                "mu_init": 1e-1,
            },
        },
    )
    return solver, *(np.array(bound) for bound in (lower, upper, low_g, up_g))


def _step_function(ca: ModuleType, wheelbase: float) -> Any:
    """Returns the states after a stage: kinematic bicycle about the centre, midpoint rule."""
    x, u = ca.SX.sym("x", STATES), ca.SX.sym("u", INPUTS)
    yaw, speed = x[StateCol.YAW], x[StateCol.SPEED]
    slip = ca.atan(0.5 * ca.tan(x[StateCol.STEER]))
    rate = ca.vertcat(
        speed * ca.cos(yaw + slip),
        speed * ca.sin(yaw + slip),
        speed * ca.sin(slip) / (0.5 * wheelbase),
        x[StateCol.ACCELERATION],
        u[InputCol.JERK],
        u[InputCol.STEER_RATE],
    )
    derivative = ca.Function("derivative", [x, u], [rate])
    middle = x + 0.5 * STAGE_TIME * derivative(x, u)
    return ca.Function("step", [x, u], [x + STAGE_TIME * derivative(middle, u)])


def _place(ca: ModuleType, x: Any, p: Any) -> Sequence[Any]:
    """Returns metres along and to the left of a stage's reference point."""
    dx, dy = x[StateCol.X] - p[ReferenceCol.X], x[StateCol.Y] - p[ReferenceCol.Y]
    cos, sin = ca.cos(p[ReferenceCol.YAW]), ca.sin(p[ReferenceCol.YAW])
    return cos * dx + sin * dy, cos * dy - sin * dx


def _tracking_cost(x: Any, aside: Any, p: Any, wheelbase: float) -> Any:
    """Returns the cost of deviating from the reference, and of side acceleration beyond it."""
    bend = x[StateCol.STEER] / wheelbase
    side = p[ReferenceCol.SPEED] ** 2 * (bend - p[ReferenceCol.CURVATURE])
    return (
        _LATERAL * aside**2
        + _HEADING * (x[StateCol.YAW] - p[ReferenceCol.YAW]) ** 2
        + _SPEED * (x[StateCol.SPEED] - p[ReferenceCol.SPEED]) ** 2
        + _ACCELERATION * (x[StateCol.ACCELERATION] - p[ReferenceCol.ACCELERATION]) ** 2
        + _SIDE_ACCELERATION * side**2
    )


def _distances(ca: ModuleType, x: Any, p: Any) -> list[Any]:
    """Returns the distance of the car from each box: 1 on the superellipse through its sides."""
    found = []
    for number in range(BOXES):
        first = REFERENCE + SIDES + BOX * number
        box = p[first : first + BOX]
        dx, dy = x[StateCol.X] - box[BoxCol.X], x[StateCol.Y] - box[BoxCol.Y]
        cos, sin = ca.cos(box[BoxCol.YAW]), ca.sin(box[BoxCol.YAW])
        along = (cos * dx + sin * dy) / box[BoxCol.HALF_LENGTH]
        across = (cos * dy - sin * dx) / box[BoxCol.HALF_WIDTH]
        found.append((along**4 + across**4 + 1e-4) ** 0.25)
    return found
