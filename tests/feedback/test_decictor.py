"""The difference of a run from its reference, and the paths that a reference run hands out."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from drivora_service.feedback.decictor import (
    CONSISTENCY,
    REFERENCE,
    DecictorFeedback,
    mean_discrepancy,
)
from drivora_service.feedback.measurement import Measurement
from drivora_service.observations.reference_path import recorded_path
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace

Floats = NDArray[np.float64]
ROUTE = np.array([(0.0, 0.0), (400.0, 0.0)])
X = 0.5 * np.arange(400)


def run(x: Any, y: Any, *others: SyntheticActor, **fields: Any) -> Trace:
    defaults: dict[str, Any] = {"route": ROUTE, "end": TerminalEvent.ARRIVED}
    ego = SyntheticEgo(motion=Motion.along(x, y), **{**defaults, **fields})
    return make_trace([ego], others)


def measured(trace: Trace, reference: Floats | None = None, **parameters: float) -> Measurement:
    if reference is not None:
        trace = replace(trace, references=(reference,))
    return DecictorFeedback(**parameters).measure(RunView(trace, straight_road()))


def path_of(trace: Trace) -> Floats:
    return recorded_path(RunView(trace, straight_road()).egos[0])


PLAIN = run(X, 0.0)
PATH = path_of(PLAIN)


def test_a_reference_run_hands_out_its_paths() -> None:
    told = measured(PLAIN)
    assert told.objectives == {CONSISTENCY: None}
    rows = np.array(told.features[REFERENCE])
    assert (rows[:, 0] == 0.0).all()
    assert np.array_equal(rows[:, 1:], PATH)


def test_of_several_egos_each_has_its_path_or_there_is_none() -> None:
    egos = [
        SyntheticEgo(id=name, motion=Motion.along(X, y), route=ROUTE, end=TerminalEvent.ARRIVED)
        for name, y in (("one", 0.0), ("two", 20.0))
    ]
    rows = np.array(measured(make_trace(egos)).features[REFERENCE])
    assert set(rows[:, 0]) == {0.0, 1.0}
    assert set(rows[rows[:, 0] == 1.0, 3]) == {20.0}
    stuck = replace(egos[1], end=TerminalEvent.STUCK)
    assert measured(make_trace([egos[0], stuck])).features[REFERENCE] == ()


def test_the_reference_itself_is_the_worst() -> None:
    value = measured(PLAIN, PATH).objectives[CONSISTENCY]
    assert value == pytest.approx(0.0, abs=1e-4)


def test_each_part_of_the_difference_counts() -> None:
    aside = 3.0 * np.sin(np.pi * np.clip((X - 50.0) / 100.0, 0.0, 1.0)) ** 2
    slow = np.concatenate((X[:100], np.repeat(X[100:120], 4), X[120:]))
    without = {"weight": 0.0}
    beside = measured(run(X, aside), PATH, **without).objectives[CONSISTENCY]
    late = measured(run(slow, np.zeros(len(slow))), PATH, **without).objectives[CONSISTENCY]
    assert beside is not None
    # 3 m, and the share of the pieces further than 1.6 m beside.
    assert beside == pytest.approx(-3.0 - (1.0 - 100 / (100 + 25)) * 2, abs=0.25)
    assert late == pytest.approx(0.0, abs=0.05), "only the motion differs"
    weighed = measured(run(slow, np.zeros(len(slow))), PATH).objectives[CONSISTENCY]
    assert weighed is not None
    assert weighed < -0.5


def test_a_run_that_did_not_arrive_or_whose_path_was_closed_is_not_measurable() -> None:
    hit = run(X, 0.0, end=TerminalEvent.COLLISION)
    assert measured(hit, PATH).objectives[CONSISTENCY] is None
    in_the_way = SyntheticActor(motion=Motion.steady(100.0, 0.0, steps=len(X)))
    assert measured(run(X, 5.0, in_the_way), PATH).objectives[CONSISTENCY] is None


samples = st.integers(1, 6).flatmap(
    lambda n: arrays(np.float64, (n, 4), elements=st.floats(-3.0, 3.0))
)


@given(first=samples, second=samples)
def test_the_discrepancy_is_that_of_the_definition(first: Floats, second: Floats) -> None:
    def kernel(one: Floats, other: Floats) -> float:
        return math.exp(-sum((a - b) ** 2 for a, b in zip(one, other, strict=True)) / 0.5)

    def mean(one: Floats, other: Floats) -> float:
        return sum(kernel(a, b) for a in one for b in other) / (len(one) * len(other))

    square = mean(first, first) + mean(second, second) - 2.0 * mean(first, second)
    found = mean_discrepancy(first, second, 0.5)
    assert found**2 == pytest.approx(max(square, 0.0), abs=1e-9)
    assert 0.0 <= found <= math.sqrt(2.0) + 1e-9
