"""Robustness agrees with its definition, with another library, and with values by hand."""

from __future__ import annotations

import sys
import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

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
from drivora_service.oracles.laws.normal_form import normal_form
from drivora_service.oracles.laws.robustness import LEAST, MOST, Robustness
from tests.oracles.laws.formulas import (
    STEP,
    arrays,
    comparisons,
    formulas,
    horizons,
    reference,
    signals,
)


def robustness(
    formula: Formula, values: dict[str, list[float]], beyond: float = MOST, step: float = STEP
) -> list[float]:
    count = len(next(iter(values.values())))
    computed = Robustness(arrays(values).__getitem__, step, count, beyond=beyond)
    found: list[float] = computed.of(normal_form(formula)).tolist()
    return found


@given(formulas(), signals(), st.sampled_from((LEAST, MOST)))
def test_it_is_that_of_the_definition(
    formula: Formula, values: dict[str, list[float]], beyond: float
) -> None:
    rows = range(len(values["a"]))
    assert robustness(formula, values, beyond) == [
        pytest.approx(reference(formula, values, row, beyond)) for row in rows
    ]


def test_by_hand() -> None:
    over = Comparison(
        left="a", operator=">=", right="1", terms=(("a", 1.0),), constant=-1.0, scale=2.0
    )
    values = {"a": [1.0, 2.0, 0.0, 9.0], "f": [0.0, 1.0, 1.0, 0.0]}
    assert robustness(over, values) == [0.0, 0.5, -0.5, 1.0]
    always = Temporal(window=Window.ALWAYS, interval=Interval(start=0.0, end=1.0), inner=over)
    assert robustness(always, values) == [0.0, -0.5, -0.5, 1.0]
    assert robustness(always, values, LEAST) == [0.0, -0.5, -0.5, -1.0]
    later = Temporal(window=Window.EVENTUALLY, interval=Interval(start=1.0, end=2.0), inner=over)
    assert robustness(later, values) == [0.5, 1.0, 1.0, 1.0]
    assert robustness(later, values, LEAST) == [0.5, 1.0, 1.0, -1.0]
    before = Temporal(window=Window.ONCE, interval=Interval(start=1.0, end=1.0), inner=over)
    assert robustness(before, values, LEAST) == [-1.0, 0.0, 0.5, -0.5]
    flag = Flag(signal="f")
    assert robustness(flag, values) == [-1.0, 1.0, 1.0, -1.0]
    assert robustness(Not(inner=flag), values) == [1.0, -1.0, -1.0, 1.0]
    until = Until(left=flag, right=over, interval=Interval(start=0.0, end=2.0))
    # Row 1: over at once (0.5); or in row 3 after two rows with the flag (1.0).
    assert robustness(until, values)[1] == 1.0
    # Row 0: over at once only, as the flag does not hold there.
    assert robustness(until, values)[0] == 0.0


def test_seconds_become_rows_by_the_step_length() -> None:
    over = Comparison(left="a", operator=">", right="0", terms=(("a", 1.0),), constant=0, scale=1.0)
    window = Temporal(window=Window.ALWAYS, interval=Interval(start=0.0, end=0.3), inner=over)
    values = {"a": [0.1 * (9 - k) for k in range(9)]}
    assert robustness(window, values, step=0.1)[0] == pytest.approx(0.6)
    assert robustness(window, values, step=0.05)[0] == pytest.approx(0.3)


@given(formulas(), signals())
def test_what_is_not_recorded_counts_for_or_against_the_formula(
    formula: Formula, values: dict[str, list[float]]
) -> None:
    for_it, against = robustness(formula, values, MOST), robustness(formula, values, LEAST)
    assert np.all(np.array(for_it) >= np.array(against))
    assert robustness(Not(inner=formula), values, LEAST) == [-value for value in for_it]


def test_only_formulas_in_normal_form_are_computed() -> None:
    with pytest.raises(TypeError, match="normal form"):
        Robustness(arrays({"f": [1.0]}).__getitem__, STEP, 1, beyond=MOST).of(
            Not(inner=Flag(signal="f"))
        )


@pytest.mark.skipif(sys.version_info >= (3, 13), reason="rtamt has no version for it")
@settings(suppress_health_check=[HealthCheck.filter_too_much], deadline=None)
@given(formulas(with_flags=False), signals(8, 14))
def test_rtamt_computes_the_same(formula: Formula, values: dict[str, list[float]]) -> None:
    back, ahead = horizons(formula)
    count = len(values["a"])
    assume(back + ahead < count)
    inner = slice(back, count - ahead)
    assert robustness(formula, values)[inner] == pytest.approx(_by_rtamt(formula, values)[inner])


@pytest.mark.skipif(sys.version_info >= (3, 13), reason="rtamt has no version for it")
@given(comparisons())
def test_rtamt_reads_the_comparisons(comparison: Comparison) -> None:
    values = {name: [0.3, -0.2] for name in "abcfg"}
    assert robustness(comparison, values) == pytest.approx(_by_rtamt(comparison, values))


def _by_rtamt(formula: Formula, values: dict[str, list[float]]) -> list[float]:
    with warnings.catch_warnings():
        # Its parser names modules of the standard library that are gone in Python 3.13.
        warnings.simplefilter("ignore", DeprecationWarning)
        import rtamt

    specification: Any = rtamt.StlDiscreteTimeSpecification()
    for name in ("a", "b", "c", "out"):
        specification.declare_var(name, "float")
    specification.spec = f"out = {_text(formula)}"
    specification.parse()
    given_ = {name: values[name] for name in "abc"}
    told = specification.evaluate({"time": list(range(len(values["a"]))), **given_})
    return [value for _, value in told]


def _text(formula: Formula) -> str:
    match formula:
        case Comparison():
            return f"({formula.left} {formula.operator} {formula.right})"
        case Not():
            return f"(not {_text(formula.inner)})"
        case And() | Or():
            word = " and " if isinstance(formula, And) else " or "
            text = _text(formula.parts[0])
            for part in formula.parts[1:]:
                text = f"({text}{word}{_text(part)})"
            return text
        case Implies():
            return f"({_text(formula.condition)} implies {_text(formula.consequence)})"
        case Temporal():
            return f"({formula.window}{formula.interval} {_text(formula.inner)})"
        case Until():
            return f"({_text(formula.left)} until{formula.interval} {_text(formula.right)})"
        case Flag():
            raise AssertionError("rtamt has no flags")
