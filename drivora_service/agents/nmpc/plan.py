"""The last plan: the initial guess of the next one, and the fallback without one."""

from __future__ import annotations

import numpy as np

from drivora_service.agents.nmpc.problem import (
    INPUTS,
    SLACKS,
    STAGE_TIME,
    STAGES,
    STATES,
    InputCol,
    StateCol,
)
from drivora_service.geometry.array_shapes import FloatArray

_TIMES = STAGE_TIME * np.arange(STAGES + 1)


class LastPlan:
    """The last plan, and the progress on it.

    Attributes:
        failures: Number of steps without a plan since then.
    """

    def __init__(self, step_length: float) -> None:
        """Args: step_length: Seconds between two plans."""
        self._step = step_length
        self._states: FloatArray | None = None
        self._inputs = np.zeros((STAGES, INPUTS))
        self._driven = 0.0
        self.failures = 0

    def take(
        self, states: FloatArray, inputs: FloatArray, origin: tuple[float, float]
    ) -> tuple[float, float]:
        """Stores a new plan, whose positions are relative to ``origin``.

        Returns:
            Acceleration and front-wheel angle at the end of its first step.
        """
        self._states = states.copy()
        self._states[:, :2] += origin
        self._inputs = inputs
        self._driven = 0.0
        self.failures = 0
        acceleration, steer = (
            float(np.interp(self._step, _TIMES, states[:, column]))
            for column in (StateCol.ACCELERATION, StateCol.STEER)
        )
        return acceleration, steer

    def go_on(self, speed: float, steer: float) -> float:
        """Returns the front-wheel angle that continues the path of the plan for another step.

        Args:
            speed: m/s; below the plan's speed it reaches the plan's angles later.
            steer: The present angle, kept without a plan.
        """
        self.failures += 1
        if self._states is None:
            return steer
        self._driven += max(speed, 0.0) * self._step
        steps = np.hypot(*np.diff(self._states[:, :2], axis=0).T)
        arc = np.concatenate(([0.0], np.cumsum(steps)))
        ahead = self._driven + max(speed, 0.0) * self._step
        return float(np.interp(ahead, arc, self._states[:, StateCol.STEER]))

    def guess(
        self, start: FloatArray, reference: FloatArray, origin: tuple[float, float]
    ) -> tuple[FloatArray, FloatArray]:
        """Returns states and inputs as the solver's initial guess, relative to ``origin``.

        The last plan, shifted by a step; without one, or after a failure, the reference.
        """
        inputs = np.zeros((STAGES, INPUTS))
        inputs[:, SLACKS] = 0.1
        if self._states is None or self.failures:
            states = np.zeros((STAGES + 1, STATES))
            # Their columns are the same, up to the angle of the wheels.
            states[:, : StateCol.STEER] = reference[:, : StateCol.STEER]
        else:
            times = _TIMES + self._step
            states = np.column_stack(
                [np.interp(times, _TIMES, column) for column in self._states.T]
            )
            states[:, :2] -= origin
            # The simulation's headings jump at half a turn.
            turns = (
                2.0
                * np.pi
                * np.round((start[StateCol.YAW] - states[0, StateCol.YAW]) / (2.0 * np.pi))
            )
            states[:, StateCol.YAW] += turns
            controls = (InputCol.JERK, InputCol.STEER_RATE)
            inputs[:, controls] = self._inputs[:, controls]
        states[0] = start
        return states, inputs
