"""Negations mean the opposite, and the ways to violate a formula are together its negation."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, assume, example, given, settings

from drivora_service.oracles.laws.formula import (
    And,
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
from drivora_service.oracles.laws.normal_form import (
    count_sub_violations,
    normal_form,
    sub_violations,
)
from drivora_service.oracles.laws.parsing import read_law
from drivora_service.oracles.laws.robustness import LEAST, MOST, Robustness
from tests.oracles.laws.formulas import STEP, arrays, formulas, horizons, reference, signals


@given(formulas())
def test_a_normal_form_negates_comparisons_and_flags_only(formula: Formula) -> None:
    assert not _has_negations(normal_form(formula))
    assert not _has_negations(normal_form(formula, negated=True))


@given(formulas())
def test_two_negations_are_none(formula: Formula) -> None:
    once = normal_form(formula, negated=True)
    assert normal_form(once, negated=True) == normal_form(formula)


@settings(suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow])
@given(formulas(), signals(1, 14))
@example(
    And(
        parts=(
            Flag(signal="f"),
            Temporal(
                window=Window.ALWAYS, interval=Interval(start=2, end=4), inner=Flag(signal="g")
            ),
        )
    ),
    {name: [0.0, 0.0, 0.0] for name in "abcfg"},
)
def test_the_ways_to_violate_are_together_the_negation(
    formula: Formula, values: dict[str, list[float]]
) -> None:
    assume(count_sub_violations(formula) <= 32)
    ways = sub_violations(formula)
    count = len(values["a"])
    over = Robustness(arrays(values).__getitem__, STEP, count, beyond=LEAST)
    held = (np.max([over.of(way) for way in ways], axis=0) > 0.0).tolist()
    violated = [reference(formula, values, row, MOST) < 0.0 for row in range(count)]
    back, ahead = horizons(formula)
    # None, where the formula looks further than there are rows.
    whole = slice(back, max(count - ahead, 0))
    assert held[whole] == violated[whole]
    # Where rows are missing, it may be known that the formula is violated, but not how.
    assert all(known for way, known in zip(held, violated, strict=True) if way)


@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(formulas())
def test_their_number_is_known_before(formula: Formula) -> None:
    assume(count_sub_violations(formula) <= 200)
    assert 1 <= len(sub_violations(formula)) <= count_sub_violations(formula)


def test_the_published_rules() -> None:
    assert _ways("always (not (in_junction and turning))") == ["in_junction and turning"]
    # not (a and b): three cases.
    assert _ways("always (in_junction and turning)") == [
        "not in_junction and turning",
        "not turning and in_junction",
        "not in_junction and not turning",
    ]
    # not (a -> b): a and not b.
    assert _ways("always (in_junction -> speed <= 5)") == ["in_junction and speed > 5"]
    # not (a or b): one case.
    assert _ways("always (in_junction or speed < 5)") == ["not in_junction and speed >= 5"]
    # always and eventually swap, and eventually has the cases of what is in it.
    assert _ways("always (always[0:2] (in_junction and turning))") == [
        "eventually[0:2] (not in_junction and turning)",
        "eventually[0:2] (not turning and in_junction)",
        "eventually[0:2] (not in_junction and not turning)",
    ]
    assert _ways("always (eventually[0:2] (in_junction and turning))") == [
        "always[0:2] (not in_junction or not turning)"
    ]
    assert _ways("always (historically[0:2] turning)") == ["once[0:2] (not turning)"]
    assert _ways("always (turning until[0:2] in_junction)") == [
        "not turning release[0:2] not in_junction"
    ]


def _ways(text: str) -> list[str]:
    formula, _ = read_law(text, {})
    return [str(way) for way in sub_violations(formula)]


def _has_negations(formula: Formula) -> bool:
    match formula:
        case Not() | Implies():
            return True
        case Temporal():
            return _has_negations(formula.inner)
        case Until():
            return _has_negations(formula.left) or _has_negations(formula.right)
        case Or(parts=parts):
            return any(map(_has_negations, parts))
        case _:
            return any(map(_has_negations, getattr(formula, "parts", ())))
