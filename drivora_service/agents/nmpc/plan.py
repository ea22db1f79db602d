"""The last plan: where the next one begins its search, and what is driven when there is none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.nmpc.problem import INPUTS, STAGE_TIME, STAGES, STATES

FloatArray = NDArray[np.float64]

_TIMES = STAGE_TIME * np.arange(STAGES + 1)


class LastPlan:
    """What was planned last, and how old it is.

    Attributes:
        failures: Steps since that no plan has been found.
    """

    def __init__(self, step_length: float) -> None:
        """Args: step_length: Seconds between two plans."""
        self._step = step_length
        self._states: FloatArray | None = None
        self._inputs = np.zeros((STAGES, INPUTS))
        self.failures = 0

    def take(self, states: FloatArray, inputs: FloatArray, origin: tuple[float, float]) -> None:
        """Takes a new plan, whose positions are relative to ``origin``."""
        self._states = states.copy()
        self._states[:, :2] += origin
        self._inputs = inputs
        self.failures = 0

    def now(self) -> tuple[float, float]:
        """Gives acceleration and front-wheel angle at the end of the plan's first step."""
        return self._at(4, self._step), self._at(5, self._step)

    def go_on(self, steer: float) -> float:
        """Gives the front-wheel angle that goes on along the plan for another step.

        Args:
            steer: The angle now, kept where there is no plan yet.
        """
        self.failures += 1
        return self._at(5, (1 + self.failures) * self._step) if self._states is not None else steer

    def guess(
        self, start: FloatArray, reference: FloatArray, origin: tuple[float, float]
    ) -> tuple[FloatArray, FloatArray]:
        """Gives states and inputs for the solver to begin with, relative to ``origin``.

        The last plan, a step on; without one, or after a failure, the reference.
        """
        inputs = np.zeros((STAGES, INPUTS))
        inputs[:, 2:] = 0.1
        if self._states is None or self.failures:
            states = np.zeros((STAGES + 1, STATES))
            states[:, :5] = reference[:, :5]
        else:
            times = _TIMES + self._step
            states = np.column_stack(
                [np.interp(times, _TIMES, column) for column in self._states.T]
            )
            states[:, :2] -= origin
            # The simulation's headings jump at half a turn.
            turns = 2.0 * np.pi * np.round((start[2] - states[0, 2]) / (2.0 * np.pi))
            states[:, 2] += turns
            inputs[:, :2] = self._inputs[:, :2]
        states[0] = start
        return states, inputs

    def _at(self, column: int, time: float) -> float:
        assert self._states is not None
        return float(np.interp(time, _TIMES, self._states[:, column]))
