"""The robustness of formulas at every row of a run, in discrete time.

Quantitative semantics of signal temporal logic (Donzé and Maler, FORMATS 2010): the robustness of
a conjunction is the least of its parts', of a disjunction the greatest; comparisons are divided by
a scale and bounded to [-1, 1], so that no signal outweighs the others, and a flag is -1 or 1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.laws.formula import (
    And,
    Comparison,
    Flag,
    Formula,
    Implies,
    Interval,
    Not,
    Or,
    Temporal,
    Until,
)

_Pick = Callable[[FloatArray, FloatArray], FloatArray]

LEAST, MOST = -1.0, 1.0
"""Bounds of every robustness."""


class Robustness:
    """Computes robustness over the rows of one ego; equal parts of formulas are computed once."""

    def __init__(
        self, signal: Callable[[str], FloatArray], step_length: float, count: int, *, beyond: float
    ) -> None:
        """Keeps the signals; nothing is computed yet.

        Args:
            signal: Returns the (n,) values of a signal; flags are 0 or 1.
            step_length: Seconds between rows.
            count: Number n of rows.
            beyond: Robustness assumed of rows before the first and after the last: ``MOST`` takes
                what is not recorded in favour of the formula, ``LEAST`` against it.
        """
        self._signal, self._step, self._count, self._beyond = signal, step_length, count, beyond
        self._known: dict[Formula, FloatArray] = {}

    def of(self, formula: Formula) -> FloatArray:
        """Returns the (n,) robustness of a formula in normal form."""
        known = self._known.get(formula)
        if known is None:
            known = self._known[formula] = self._compute(formula)
        return known

    def _compute(self, formula: Formula) -> FloatArray:
        match formula:
            case Comparison():
                total: FloatArray = np.full(self._count, formula.constant, dtype=np.float64)
                for name, factor in formula.terms:
                    total += factor * self._signal(name)
                return np.clip(total / formula.scale, LEAST, MOST)
            case Flag():
                return np.where((self._signal(formula.signal) > 0.5) == formula.holds, MOST, LEAST)
            case And() | Or():
                return self._reduce(formula)
            case Temporal():
                return self._window(formula)
            case Until():
                return self._until(formula)
            case Not() | Implies():
                raise TypeError("robustness is computed of formulas in normal form")

    def _reduce(self, formula: And | Or) -> FloatArray:
        """Joins parts until the result is known: most flags are false throughout a run."""
        is_and = isinstance(formula, And)
        pick, last = (np.minimum, LEAST) if is_and else (np.maximum, MOST)
        picked: FloatArray | None = None
        for part in sorted(formula.parts, key=lambda one: not isinstance(one, Flag)):
            found = self.of(part)
            picked = found if picked is None else pick(picked, found)
            if (picked.max() if is_and else picked.min()) == last:
                break
        assert picked is not None, "a conjunction or disjunction has parts"
        return picked

    def _window(self, formula: Temporal) -> FloatArray:
        inner = self.of(formula.inner)
        first, last = self._rows(formula.interval)
        pick = np.minimum if formula.window.is_universal else np.maximum
        if formula.window.is_past:
            return _slide_window(inner[::-1], first, last, pick, self._beyond)[::-1]
        return _slide_window(inner, first, last, pick, self._beyond)

    def _until(self, formula: Until) -> FloatArray:
        left, right = self.of(formula.left), self.of(formula.right)
        first, last = self._rows(formula.interval)
        # Release is the same with the two operations swapped.
        both, either = (np.maximum, np.minimum) if formula.dual else (np.minimum, np.maximum)
        held = np.full(self._count, LEAST if formula.dual else MOST)
        found = np.full(self._count, MOST if formula.dual else LEAST)
        for ahead in range(last + 1):
            if ahead >= first:
                found = either(found, both(held, _shift(right, ahead, self._beyond)))
            held = both(held, _shift(left, ahead, self._beyond))
        return found

    def _rows(self, interval: Interval) -> tuple[int, int]:
        return round(interval.start / self._step), round(interval.end / self._step)


def _shift(values: FloatArray, by: int, beyond: float) -> FloatArray:
    """Returns the values ``by`` rows later."""
    shifted = np.full(len(values), beyond)
    shifted[: max(len(values) - by, 0)] = values[by:]
    return shifted


def _slide_window(
    values: FloatArray,
    first: int,
    last: int,
    pick: _Pick,
    beyond: float,
) -> FloatArray:
    """Returns the least or greatest value ``first`` to ``last`` rows after each row."""
    count, width = len(values), last - first + 1
    padded = np.full(count + last, beyond)
    padded[:count] = values
    picked, covered = padded[first:], 1
    while covered < width:
        step = min(covered, width - covered)
        picked = pick(picked[:-step], picked[step:])
        covered += step
    return picked[:count]
