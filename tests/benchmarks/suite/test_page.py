from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.suite.page import number, page
from tests.benchmarks.suite.results import MACHINE, result, series


def test_equal_cases_are_rows() -> None:
    text = page(
        result(
            series("run", 79.0, 80.0, 85.0, case="Town01", unit="ms"),
            series("run / floor", 1.5, 1.25, 1.0, case="Town01"),
            series("run", 337.0, case="Town04", unit="ms"),
            series("run / floor", 1.25, case="Town04"),
        )
    )
    assert (
        "| | run, ms | run / floor |\n|---|---|---|\n"
        "| Town01 | 80.0 (79.0 to 85.0) | 1.25 (1.00 to 1.50) |\n"
        "| Town04 | 337 | 1.25 |\n"
    ) in text
    assert "## Cost of a run\n\nWhat is measured.\n" in text
    assert "`run-cost`: 1 or 3 rounds, 12 s, load 0.5 before." in text


def test_different_quantities_have_rows_of_their_own() -> None:
    text = page(result(series("run", 2.0, unit="ms"), series("rate", 3.0, case="b", unit="1/s")))
    assert "| | | |\n|---|---|---|\n| a town | run, ms | 2.00 |\n| b | rate, 1/s | 3.00 |" in text


def test_it_says_where_it_was_measured() -> None:
    text = page(result(series("run", 1.0)))
    for row in (
        "| begun | 2026-01-02T03:04:05+00:00 |",
        "| command | `python -m benchmarks --rounds 3` |",
        "| commit | abc |",
        "| processor | 2 cores of A processor, 8.0 GB |",
        "| packages | libsumo 1.28.0 |",
        "| load over 1, 5, 15 minutes | 0.5, 0.4, 0.3 |",
        "| nice | 0 |",
    ):
        assert row in text
    assert "Other programs" not in text
    assert "short form" not in text


def test_it_says_that_a_result_is_disturbed_or_short() -> None:
    busy = replace(MACHINE, load=(3.0, 1.0, 1.0))
    text = page(result(series("run", 1.0), machine=busy, short=True))
    assert "the load was 3.0 on 2 cores" in text
    assert "The short form" in text


def test_what_was_left_out_is_said_without_an_empty_table() -> None:
    text = page(result(remarks=("a peer, which cannot be installed.",)))
    assert "Left out: a peer, which cannot be installed." in text
    assert "|---|---|---|" not in text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.0312, "0.031"),
        (0.123, "0.12"),
        (9.994, "9.99"),
        (12.34, "12.3"),
        (99.94, "99.9"),
        (99.96, "100"),
        (12345.6, "12,346"),
    ],
)
def test_numbers_have_about_three_digits(value: float, text: str) -> None:
    assert number(value) == text
