"""How severe violations are, and when one is clearly more severe than another."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.built_in import default_oracles
from drivora_service.oracles.verdict import Severity
from drivora_service.oracles.verdicts.violation_magnitude import (
    DECLARED,
    Magnitude,
    add_run,
    beyond_bound,
    class_magnitude,
    declared_magnitude,
    join_in_run,
    magnitudes_of,
)
from tests.suites.made_results import verdict

VALUES = st.floats(-1e3, 1e3).map(lambda value: round(value, 3))
MARGINS = st.floats(1e-3, 1e2)
EVIDENCE: Mapping[str, Mapping[str, Any]] = {
    "collision": {"relative_speed": 15.0},
    "red_light": {"speed": 8.0, "red_for": 3.0},
    "stop_sign": {"speed": 5.0, "slowest": 2.0},
    "failure_to_yield": {"encroachment": None, "braking": 5.0},
    "off_road": {"distance": 0.5, "duration": 1.1},
    "wrong_way": {"distance": 3.0, "severe": False},
    "lane_keeping": {"distance": 4.0, "share": 0.1},
    "route_deviation": {"distance": 30.0, "beside": 12.0},
    "speeding": {"speed": 16.0, "speed_limit": 13.0, "duration": 4.0},
    "blocked": {"duration": 61.0},
    "junction_blocking": {"duration": 12.0, "longest_wait": 4.0},
    "deadlock": {"cycle": ["a", "b"]},
    "destination": {"goal_distance": 40.0, "reason": "timeout"},
    "near_miss": {"measure": "time_to_collision", "seconds": 0.8},
    "tailgating": {"safe_distance": 9.0, "distance": 4.0, "duration": 3.0},
    "minimum_speed": {"speed": 3.0, "speed_limit": 13.0, "duration": 20.0},
    "discomfort": {"share": 0.2},
    "non_optimal_decision": {"path_difference": 4.0},
}
EXPECTED = {
    "collision": {"impact_speed": 15.0},
    "red_light": {"speed": 8.0, "red_for": 3.0},
    "stop_sign": {"slowest_approach": 2.0},
    "failure_to_yield": {"encroachment": 10.0, "braking": 5.0},
    "off_road": {"depth": 0.5, "duration": 1.1},
    "wrong_way": {"distance": 3.0},
    "lane_keeping": {"distance": 4.0},
    "route_deviation": {"distance": 30.0},
    "speeding": {"excess": 3.0, "duration": 4.0},
    "blocked": {"duration": 61.0},
    "junction_blocking": {"duration": 12.0, "longest_wait": 4.0},
    "deadlock": {},
    "destination": {"distance_left": 40.0},
    "near_miss": {"time_to_collision": 0.8},
    "tailgating": {"missing_distance": 5.0, "duration": 3.0},
    "minimum_speed": {"missing_speed": 10.0, "duration": 20.0},
    "discomfort": {"share": 0.2},
    "non_optimal_decision": {"path_difference": 4.0},
}


def measure(margin: float = 0.1, *values: float, less_is_worse: bool = False) -> Magnitude:
    return Magnitude(
        name="depth", unit="m", margin=margin, less_is_worse=less_is_worse, values=values
    )


def measured(oracle: str, evidence: Mapping[str, Any]) -> dict[str, float]:
    found = magnitudes_of(verdict(oracle, evidence=evidence))
    return {one.name: one.values[0] for one in found}


def test_every_built_in_oracle_has_its_measures() -> None:
    names = [oracle.name for oracle in default_oracles()]
    assert {name: measured(name, EVIDENCE[name]) for name in names} == EXPECTED


@pytest.mark.parametrize("oracle", sorted(EVIDENCE))
def test_evidence_of_older_versions_has_no_measure(oracle: str) -> None:
    assert measured(oracle, {}) == {}
    assert measured(oracle, {"relative_speed": math.nan, "distance": True, "duration": "1"}) == {}


def test_a_traffic_law_is_measured_by_its_robustness() -> None:
    evidence = {"robustness": -0.4, "formula": "always speed < 10"}
    (found,) = magnitudes_of(verdict("speed_law", evidence=evidence))
    assert (found.name, found.values, found.less_is_worse) == ("robustness", (-0.4,), True)
    assert found.is_clearly_worse(-0.1, -0.4)
    assert not found.is_clearly_worse(-0.4, -0.1)


def test_the_encroachment_of_the_other_is_worse_if_it_is_less() -> None:
    evidence = {"encroachment": 0.9, "braking": 0.0}
    first, _ = magnitudes_of(verdict("failure_to_yield", evidence=evidence))
    assert first.is_clearly_worse(0.9, 0.3)
    assert first.is_clearly_worse(10.0, 0.9)
    assert not first.is_clearly_worse(0.3, 0.9)


def test_an_oracle_of_a_package_gives_its_own_measure() -> None:
    given_measure = {"name": "gap", "value": 0.4, "unit": "m", "margin": 0.2, "less_is_worse": True}
    (found,) = magnitudes_of(verdict("walker_gap", evidence={DECLARED: given_measure}))
    assert found == Magnitude(name="gap", unit="m", margin=0.2, less_is_worse=True, values=(0.4,))
    assert magnitudes_of(verdict("walker_gap", evidence={"distance": 3.0})) == ()


@pytest.mark.parametrize(
    "change",
    [{"name": ""}, {"name": 1}, {"value": None}, {"value": math.inf}, {"margin": 0.0}, {"unit": 1}],
)
def test_a_measure_that_is_none_is_not_taken(change: dict[str, Any]) -> None:
    given_measure = {"name": "gap", "value": 0.4, "margin": 0.2, **change}
    assert declared_magnitude({DECLARED: given_measure}) is None
    assert declared_magnitude({DECLARED: 3.0}) is None


@pytest.mark.parametrize(
    ("before", "now", "worse"),
    [
        (0.3, 0.5, True),
        (0.3, 0.4, True),
        (0.3, 0.39, False),
        (2.0, 2.4, False),
        (2.0, 2.5, True),
        (0.0, 0.1, True),
        (0.5, 0.3, False),
    ],
)
def test_more_is_clearly_more_by_the_margin_and_by_a_quarter(
    before: float, now: float, *, worse: bool
) -> None:
    assert measure().is_clearly_worse(before, now) == worse


@given(MARGINS, VALUES, st.booleans())
def test_equal_values_are_no_alarm(margin: float, value: float, less: bool) -> None:
    assert not measure(margin, less_is_worse=less).is_clearly_worse(value, value)


@given(MARGINS, VALUES, VALUES, st.floats(0.0, 1e3), st.booleans())
def test_what_is_worse_stays_worse_if_it_grows(
    margin: float,
    before: float,
    now: float,
    growth: float,
    less: bool,
) -> None:
    one = measure(margin, less_is_worse=less)
    further = now - growth if less else now + growth
    if one.is_clearly_worse(before, now):
        assert one.is_clearly_worse(before, further)
        assert not one.is_clearly_worse(now, before)


@given(st.lists(VALUES, min_size=1, max_size=9), st.booleans())
def test_the_median_lies_between_the_least_and_the_worst(values: list[float], less: bool) -> None:
    one = measure(0.1, *values, less_is_worse=less)
    assert one.median in values
    for better, worse in ((one.least, one.median), (one.median, one.worst)):
        assert worse <= better if less else worse >= better


def test_of_several_violations_in_a_run_the_worst_counts() -> None:
    one, two = measure(0.1, 0.3), measure(0.1, 0.5)
    assert [m.values for m in join_in_run((one,), (two,))] == [(0.5,)]
    assert [m.values for m in join_in_run((two,), (one,))] == [(0.5,)]
    assert [m.values for m in join_in_run((one,), ())] == [(0.3,)]


def test_a_measure_that_a_run_does_not_have_is_left_out() -> None:
    one = measure(0.1, 0.3)
    assert [m.values for m in add_run((one,), (measure(0.1, 0.5),))] == [(0.3, 0.5)]
    assert add_run((one,), ()) == ()


def test_a_graver_class_is_clearly_worse() -> None:
    classes = list(Severity)
    for graver, lighter in itertools.pairwise(classes):
        now, before = class_magnitude([graver]), class_magnitude([lighter])
        assert now.is_clearly_worse(before.median, now.median)
        assert not now.is_clearly_worse(now.median, before.median)
        assert (before.format(before.median), now.format(now.median)) == (lighter, graver)


def test_a_metric_is_measured_by_the_distance_from_its_bound() -> None:
    assert beyond_bound(50.0, low=60.0, high=90.0).values == (10.0,)
    assert beyond_bound(95.0, low=60.0, high=90.0).values == (5.0,)
    one = beyond_bound(57.0, low=60.0, high=None)
    assert one.margin == pytest.approx(3.0)
    assert one.is_clearly_worse(1.0, 4.0)
    assert not one.is_clearly_worse(1.0, 3.5)
