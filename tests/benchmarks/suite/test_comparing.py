from __future__ import annotations

import math
from dataclasses import replace

import pytest

from benchmarks.suite.comparing import Comparison, Finding, compare, table
from benchmarks.suite.result import Better
from tests.benchmarks.suite.results import MACHINE, result, series


@pytest.mark.parametrize(
    ("one", "other", "better", "finding"),
    [
        ((1.0, 1.2, 1.1), (0.7, 0.9, 0.8), Better.LOWER, Finding.BETTER),
        ((1.0, 1.2, 1.1), (1.3, 1.5, 1.4), Better.LOWER, Finding.WORSE),
        ((1.0, 1.2, 1.1), (1.3, 1.5, 1.4), Better.HIGHER, Finding.BETTER),
        ((1.0, 1.2, 1.1), (0.7, 0.9, 0.8), Better.HIGHER, Finding.WORSE),
        ((1.0, 1.2, 1.1), (0.7, 0.9, 0.8), Better.NEITHER, Finding.DIFFERENT),
        ((1.0, 1.2, 1.1), (1.2, 1.5, 1.4), Better.LOWER, Finding.WITHIN),
        ((1.0, 1.2, 1.1), (1.05, 1.1), Better.LOWER, Finding.WITHIN),
        ((1.0,), (9.0, 9.1), Better.LOWER, Finding.UNKNOWN),
        ((1.0, 1.1), (9.0,), Better.LOWER, Finding.UNKNOWN),
    ],
)
def test_results_differ_if_their_ranges_do_not_overlap(
    one: tuple[float, ...], other: tuple[float, ...], better: Better, finding: Finding
) -> None:
    (difference,) = compare(
        result(series("run", *one, better=better)), result(series("run", *other, better=better))
    ).differences
    assert difference.finding is finding


def test_a_ratio_is_of_medians_and_its_spread_of_the_rounds() -> None:
    (difference,) = compare(
        result(series("run", 1.0, 2.0, 4.0)), result(series("run", 3.0, 6.0, 12.0))
    ).differences
    assert difference.ratio == 3.0
    assert difference.spread == (0.75, 12.0)


def test_nothing_is_over_zero() -> None:
    (difference,) = compare(
        result(series("run", 0.0, 0.0)), result(series("run", 1.0, 2.0))
    ).differences
    assert math.isnan(difference.ratio)


def test_quantities_of_one_result_are_listed() -> None:
    one, other = series("run", 1.0, 2.0), series("run", 1.0, 2.0, case="another town")
    compared = compare(result(one), result(other))
    assert not compared.differences
    assert compared.only_one == (("run-cost", one.quantity),)
    assert compared.only_other == (("run-cost", other.quantity),)
    text = table(compared)
    assert "Only in the first result:\n  run-cost: a town: run" in text
    assert "Only in the second result:\n  run-cost: another town: run" in text
    assert text.endswith("0 quantities: none.\n")


def test_the_table_counts_the_findings() -> None:
    one = result(series("run", 1.0, 1.1), series("floor", 1.0, 1.1))
    other = result(series("run", 2.0, 2.1), series("floor", 1.05, 1.1))
    text = table(compare(one, other))
    assert "a town: run" in text
    assert text.endswith("2 quantities: 1 worse, 1 within the spread.\n")
    assert "Careful" not in text


def _warnings(comparison: Comparison) -> str:
    return "\n".join(comparison.warnings)


def test_it_warns_of_what_disturbs_comparisons() -> None:
    one = result(series("run", 1.0))
    assert not compare(one, one).warnings
    elsewhere = result(series("run", 1.0), machine=replace(MACHINE, cpu="Another"))
    assert "different machines, 2 cores of A processor and 2 of Another" in _warnings(
        compare(one, elsewhere)
    )
    polite = result(series("run", 1.0), machine=replace(MACHINE, nice=19))
    assert "nice 0 and 19" in _warnings(compare(one, polite))
    busy = result(series("run", 1.0), machine=replace(MACHINE, load=(7.5, 1.0, 1.0)))
    assert "the load was 7.5 on 2 cores in the second result" in _warnings(compare(one, busy))
    short = result(series("run", 1.0), short=True)
    assert "the first result is of the short form" in _warnings(compare(short, one))
