"""Random formulas and signals, and a second way to compute their robustness, for tests."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from hypothesis import strategies as st

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
    Window,
)

NAMES = ("a", "b", "c")
FLAGS = ("f", "g")
STEP = 1.0

Signals = Mapping[str, Sequence[float]]


@st.composite
def comparisons(draw: st.DrawFn) -> Comparison:
    """Draws ``signal > number``; the numbers have odd digits, so that no robustness is 0."""
    name = draw(st.sampled_from(NAMES))
    threshold = draw(st.integers(-3, 3)) / 10.0 + 0.0171
    operator = draw(st.sampled_from((">", "<=")))
    sign = 1.0 if operator == ">" else -1.0
    return Comparison(
        left=name,
        operator=operator,
        right=f"{threshold!r}",
        terms=((name, sign),),
        constant=-sign * threshold,
        scale=1.0,
    )


def flags() -> st.SearchStrategy[Formula]:
    """Draws a flag or its negation."""
    return st.builds(Flag, signal=st.sampled_from(FLAGS), holds=st.booleans())


@st.composite
def intervals(draw: st.DrawFn) -> Interval:
    """Draws an interval of at most 4 rows."""
    start, more = draw(st.integers(0, 2)), draw(st.integers(0, 2))
    return Interval(start=start * STEP, end=(start + more) * STEP)


def _larger(inner: st.SearchStrategy[Formula]) -> st.SearchStrategy[Formula]:
    parts = st.lists(inner, min_size=2, max_size=3).map(tuple)
    return st.one_of(
        st.builds(Not, inner=inner),
        st.builds(And, parts=parts),
        st.builds(Or, parts=parts),
        st.builds(Implies, condition=inner, consequence=inner),
        st.builds(Temporal, window=st.sampled_from(Window), interval=intervals(), inner=inner),
        st.builds(Until, left=inner, right=inner, interval=intervals()),
    )


def formulas(*, with_flags: bool = True) -> st.SearchStrategy[Formula]:
    """Draws formulas as a user can write them."""
    leaves: st.SearchStrategy[Formula] = comparisons()
    if with_flags:
        leaves = st.one_of(leaves, flags())
    return st.recursive(leaves, _larger, max_leaves=6)


@st.composite
def signals(draw: st.DrawFn, least: int = 1, most: int = 12) -> dict[str, list[float]]:
    """Draws the values of all signals over some rows."""
    count = draw(st.integers(least, most))
    values = st.lists(st.integers(-5, 5).map(lambda n: n / 10.0), min_size=count, max_size=count)
    truths = st.lists(st.sampled_from((0.0, 1.0)), min_size=count, max_size=count)
    return {name: draw(values) for name in NAMES} | {name: draw(truths) for name in FLAGS}


def arrays(given: Signals) -> dict[str, FloatArray]:
    """Returns signals as arrays."""
    return {name: np.array(values) for name, values in given.items()}


def reference(formula: Formula, given: Signals, row: int, beyond: float) -> float:
    """Computes robustness by the definition, row by row, of a formula as it was written.

    ``beyond`` is what rows outside the record count for the formula; for a negated part they
    count the other way.
    """
    count = len(next(iter(given.values())))
    if not 0 <= row < count:
        return beyond
    match formula:
        case Comparison():
            total = formula.constant + sum(f * given[name][row] for name, f in formula.terms)
            return max(-1.0, min(1.0, total / formula.scale))
        case Flag():
            return 1.0 if (given[formula.signal][row] > 0.5) == formula.holds else -1.0
        case Not():
            return -reference(formula.inner, given, row, -beyond)
        case And():
            return min(reference(part, given, row, beyond) for part in formula.parts)
        case Or():
            return max(reference(part, given, row, beyond) for part in formula.parts)
        case Implies():
            return max(
                -reference(formula.condition, given, row, -beyond),
                reference(formula.consequence, given, row, beyond),
            )
        case Temporal():
            sign = -1 if formula.window.is_past else 1
            rows = [row + sign * away for away in _away(formula.interval)]
            values = [reference(formula.inner, given, there, beyond) for there in rows]
            return min(values) if formula.window.is_universal else max(values)
        case Until():
            assert not formula.dual
            best = -math.inf
            for away in _away(formula.interval):
                before = [reference(formula.left, given, row + k, beyond) for k in range(away)]
                there = reference(formula.right, given, row + away, beyond)
                best = max(best, min([there, *before]))
            return best


def _away(interval: Interval) -> range:
    return range(round(interval.start / STEP), round(interval.end / STEP) + 1)


def horizons(formula: Formula) -> tuple[int, int]:
    """Returns how many rows a formula looks back and ahead."""
    match formula:
        case Comparison() | Flag():
            return 0, 0
        case Not():
            return horizons(formula.inner)
        case And() | Or():
            found = [horizons(part) for part in formula.parts]
        case Implies():
            found = [horizons(formula.condition), horizons(formula.consequence)]
        case Temporal():
            back, ahead = horizons(formula.inner)
            rows = round(formula.interval.end / STEP)
            return (back + rows, ahead) if formula.window.is_past else (back, ahead + rows)
        case Until():
            rows = round(formula.interval.end / STEP)
            (a, b), (c, d) = horizons(formula.left), horizons(formula.right)
            return max(a, c), max(b, d) + rows
    return max(back for back, _ in found), max(ahead for _, ahead in found)
