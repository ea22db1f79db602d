"""Reaction time: what others do is noticed later.

Source: Treiber, Kesting, Helbing, *Delays, inaccuracies and anticipation in microscopic traffic
models* (2006): a driver acts on what was perceived a reaction time ago, and expects others to have
gone on since as they did then. So a steady leader is followed as without a reaction time, and what
is new (braking, turning, appearing, another light) is noticed by that time later.
"""

from __future__ import annotations

import math
from dataclasses import replace
from enum import IntEnum

import numpy as np

from drivora_service.agents.interface import ObjectKind, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.observations.trace import Col, Light, SizeCol

MOST_TURNING = 1.0
"""Rate of turning in rad/s beyond which vehicles are not expected to turn."""

SAME_LINE = 1.0
"""Metres along the route by which the place of one signal's line may differ between two steps."""

_ACTORS = 16
"""Actors for which there is room at first."""


class _Mark(IntEnum):
    """Rows of the numbers that are remembered of actors."""

    KIND = 0
    ID = 1


class ReactionDelay:
    """Observations of an ego whose other actors and signals are those of a reaction time ago.

    The state of the ego itself is the present one. Before the reaction time has passed for the
    first time, the first observation counts.
    """

    def __init__(self, reaction_time: float, step_length: float, half_length: float) -> None:
        """Makes room for the observations of a reaction time.

        Args:
            reaction_time: Seconds, rounded up to whole steps.
            step_length: Seconds.
            half_length: Metres from the ego's centre to its front.
        """
        self._rows = math.ceil(reaction_time / step_length - 1e-9) + 1
        self._half_length = half_length
        self._seen = 0
        self._counts = np.zeros(self._rows, dtype=np.int64)
        self._times = np.zeros(self._rows)
        self._signals: list[tuple[Light, bool, float]] = [(Light.NONE, False, math.inf)]
        self._signals *= self._rows
        self._states = np.zeros((self._rows, _ACTORS, len(Col)))
        self._sizes = np.zeros((self._rows, _ACTORS, len(SizeCol)))
        self._marks = np.zeros((self._rows, len(_Mark), _ACTORS), dtype=np.int64)
        self._expected = np.zeros((_ACTORS, len(Col)))
        self._delayed: Observation | None = None

    def _grow(self, actors: int) -> None:
        """Makes room for at least ``actors`` actors, and keeps what is remembered."""
        more = 2 * actors - self._states.shape[1]
        self._states = np.pad(self._states, ((0, 0), (0, more), (0, 0)))
        self._sizes = np.pad(self._sizes, ((0, 0), (0, more), (0, 0)))
        self._marks = np.pad(self._marks, ((0, 0), (0, 0), (0, more)))
        self._expected = np.pad(self._expected, ((0, more), (0, 0)))

    def __call__(self, observation: Observation) -> Observation:
        """Remembers an observation, and returns the delayed one, which the next call overwrites."""
        self._remember(observation)
        row = max(self._seen - self._rows, 0) % self._rows
        count = int(self._counts[row])
        elapsed = observation.time - float(self._times[row])
        states, sizes, marks = self._states[row], self._sizes[row], self._marks[row]
        foresee(states, marks[_Mark.KIND], count, elapsed, self._expected)
        light, protected, distance = self._signal(row, observation)
        delayed = self._delayed
        if delayed is None:
            delayed = self._delayed = replace(observation)
        delayed.time, delayed.step = observation.time, observation.step
        delayed.ego, delayed.speed = observation.ego, observation.speed
        delayed.acceleration, delayed.steer = observation.acceleration, observation.steer
        delayed.route_s, delayed.route_lateral = observation.route_s, observation.route_lateral
        delayed.speed_limit = observation.speed_limit
        delayed.light, delayed.light_protected = light, protected
        delayed.light_distance = distance
        delayed.objects, delayed.object_sizes = self._expected[:count], sizes[:count]
        delayed.object_kinds, delayed.object_ids = (
            marks[_Mark.KIND, :count],
            marks[_Mark.ID, :count],
        )
        return delayed

    def _remember(self, observation: Observation) -> None:
        count = len(observation.objects)
        if count > self._states.shape[1]:
            self._grow(count)
        row = self._seen % self._rows
        self._states[row, :count] = observation.objects
        self._sizes[row, :count] = observation.object_sizes
        self._marks[row, _Mark.KIND, :count] = observation.object_kinds
        self._marks[row, _Mark.ID, :count] = observation.object_ids
        self._counts[row] = count
        self._times[row] = observation.time
        self._signals[row] = (
            observation.light, observation.light_protected, self._line(observation),
        )  # fmt: skip
        self._seen += 1

    def _line(self, observation: Observation) -> float:
        """Returns the place of the next signal's line along the route, metres."""
        return observation.route_s + self._half_length + observation.light_distance

    def _signal(self, row: int, observation: Observation) -> tuple[Light, bool, float]:
        """Returns the next signal as it was seen then, at its present distance.

        A signal that was not the next one then has not been noticed yet.
        """
        light, protected, line = self._signals[row]
        if light is Light.NONE or abs(line - self._line(observation)) > SAME_LINE:
            return Light.NONE, False, math.inf
        return light, protected, observation.light_distance


@compiled
def foresee(
    states: FloatArray, kinds: IntArray, count: int, seconds: float, out: FloatArray
) -> None:
    """Moves actors on at their speed; vehicles keep their rate of turning, walkers go straight.

    Args:
        states: (n, 9) columns ``Col``.
        kinds: (n,) kinds, as in ``Observation``.
        count: Number of actors.
        seconds: Time to move on.
        out: (n, 9) filled with the states then.
    """
    for j in range(count):
        out[j] = states[j]
        vx, vy, rate = states[j, Col.VX], states[j, Col.VY], 0.0
        if kinds[j] == ObjectKind.VEHICLE:
            rate = min(max(states[j, Col.YAW_RATE], -MOST_TURNING), MOST_TURNING)
        turn = rate * seconds
        if abs(turn) < 1e-6:
            along, aside = seconds, 0.0
        else:
            along, aside = math.sin(turn) / rate, (1.0 - math.cos(turn)) / rate
        out[j, Col.X] += along * vx - aside * vy
        out[j, Col.Y] += aside * vx + along * vy
        cos, sin = math.cos(turn), math.sin(turn)
        out[j, Col.YAW] += turn
        out[j, Col.VX], out[j, Col.VY] = cos * vx - sin * vy, sin * vx + cos * vy
