from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.feedback.objective_choice import (
    WEIGHTED_SUM,
    ObjectiveChoice,
    ObjectiveKind,
    combine_objectives,
    share_of,
)
from drivora_service.runs.report_encoding import choice_from_json, choice_to_json

NUMBERS = st.floats(min_value=-1e6, max_value=1e6)


def chosen(name: str, weight: float | None = None, **changes: Any) -> ObjectiveChoice:
    return ObjectiveChoice(
        name=name, kind=ObjectiveKind.METRIC, member=name, weight=weight, **changes
    )


@given(NUMBERS, NUMBERS, st.floats(min_value=1e-3, max_value=1e3))
def test_shares_keep_the_order_and_do_not_saturate(one: float, two: float, scale: float) -> None:
    first, second = (share_of(value, target=2.0, scale=scale) for value in (one, two))
    assert -1.0 < first < 1.0
    if one - two > 1e-3 * scale:
        assert first > second
    assert share_of(2.0, target=2.0, scale=scale) == 0.0
    assert share_of(2.0 + scale, target=2.0, scale=scale) == pytest.approx(0.5)


def test_objectives_without_weights_stay_by_themselves() -> None:
    values = {"a": 1.0, "b": None}
    assert combine_objectives([chosen("a"), chosen("b")], values) == values


def test_weights_make_one_objective_and_keep_its_parts() -> None:
    choices = [chosen("a", 3.0, scale=2.0), chosen("b", 1.0)]
    values: dict[str, float | None] = {"a": 2.0, "b": -1.0}
    made = combine_objectives(choices, values)
    assert made == {WEIGHTED_SUM: pytest.approx((3.0 * 0.5 - 0.5) / 4.0), **values}
    assert next(iter(made)) == WEIGHTED_SUM


def test_a_part_that_is_not_measurable_counts_as_the_worst() -> None:
    choices = [chosen("a", 1.0), chosen("b", 1.0)]
    assert combine_objectives(choices, {"a": 1.0, "b": None})[WEIGHTED_SUM] == 0.75
    assert combine_objectives(choices, {"a": None, "b": None})[WEIGHTED_SUM] is None


def test_a_choice_is_stored_and_read() -> None:
    choice = FeedbackChoice(name="general", objectives=(chosen("a", 2.0, target=1.5),))
    assert choice_from_json(choice_to_json(choice)) == choice
    plain = FeedbackChoice(name="general", parameters={"a": 1})
    assert choice_to_json(plain) == '{"name":"general","parameters":{"a":1}}'
    # Those of earlier versions have none.
    assert choice_from_json('{"name": "general", "parameters": {}}').objectives == ()
