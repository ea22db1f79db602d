"""The contract of feedbacks, as a suite of tests for authors of feedbacks.

Derive a class whose name begins with ``Test`` and give it the plug-in::

    class TestMyFeedback(FeedbackContract):
        plugin = MY_PLUGIN
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import Feedback, FeedbackChoice, Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.runs.report_encoding import (
    choice_from_json,
    choice_to_json,
    report_from_json,
    report_to_json,
)
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.testing.networks import straight_road
from drivora_service.testing.oracle_contract import example_runs


class FeedbackContract:
    """Tests that every feedback passes.

    Attributes:
        plugin: The feedback under test.
        parameters: Parameters that a tester sets; the tests use the defaults of the others.
    """

    plugin: ClassVar[FeedbackPlugin]
    parameters: ClassVar[Mapping[str, Any]] = {}

    def runs(self) -> tuple[Trace, ...]:
        """Returns runs on ``straight_road``; a feedback that needs more than they have adds it."""
        return example_runs()

    def create(self) -> Feedback:
        """Makes the feedback as a worker does."""
        return self.plugin.create(self.parameters)

    def measure(self, trace: Trace) -> Measurement:
        """Measures a run on ``straight_road`` with a fresh feedback."""
        return self.create().measure(RunView(trace, straight_road()))

    def test_it_says_what_it_is(self) -> None:
        assert self.plugin.name.strip() == self.plugin.name != ""
        assert self.plugin.description

    def test_every_measurement_holds_its_objectives_in_their_order(self) -> None:
        objectives = self.create().objectives
        assert objectives
        assert len(set(objectives)) == len(objectives)
        for trace in self.runs():
            assert tuple(self.measure(trace).objectives) == objectives

    def test_objectives_are_finite_or_not_measurable(self) -> None:
        for trace in self.runs():
            for value in self.measure(trace).objectives.values():
                assert value is None or math.isfinite(value)

    def test_some_objective_tells_the_example_runs_apart(self) -> None:
        measured = {tuple(self.measure(trace).objectives.values()) for trace in self.runs()}
        assert len(measured) > 1

    def test_features_are_the_same_tables_of_finite_numbers_for_every_run(self) -> None:
        widths: dict[str, set[int]] = {}
        for number, trace in enumerate(self.runs()):
            features = self.measure(trace).features
            assert number == 0 or features.keys() == widths.keys()
            for name, rows in features.items():
                assert all(math.isfinite(value) for row in rows for value in row)
                widths.setdefault(name, set()).update(len(row) for row in rows)
        assert all(len(width) <= 1 for width in widths.values())

    def test_the_same_run_gives_the_same_measurement_whatever_was_measured_before(self) -> None:
        runs = self.runs()
        alone = [self.measure(trace) for trace in runs]
        one = self.create()
        views = [RunView(trace, straight_road()) for trace in runs]
        for _ in range(2):
            assert [one.measure(view) for view in views] == alone

    def test_measuring_leaves_the_trace_alone(self) -> None:
        for trace in self.runs():
            before = pickle.dumps(trace)
            self.measure(trace)
            assert pickle.dumps(trace) == before

    def test_what_happens_after_an_egos_end_changes_nothing(self) -> None:
        for trace in self.runs():
            ends = trace.ego_end_steps
            if trace.ego_count > 1 or ends[0] + 1 >= trace.step_count:
                continue
            wild = replace(trace, states=trace.states.copy(), ego_values=trace.ego_values.copy())
            after = ends[0] + 1
            wild.states[after:, 0, 0] += 1000.0
            wild.states[after:, 0, 2] += 2.0
            wild.ego_values[after:, 0] = 77.0
            assert self.measure(wild) == self.measure(trace)

    def test_a_measurement_comes_back_from_storage_as_it_was(self) -> None:
        for trace in self.runs():
            measurement = self.measure(trace)
            report = RunReport(run_id="run", status=RunStatus.FINISHED, measurement=measurement)
            assert pickle.loads(pickle.dumps(measurement)) == measurement
            assert report_from_json(report_to_json(report)).measurement == measurement

    def test_a_choice_that_was_stored_makes_the_same_feedback(self) -> None:
        choice = FeedbackChoice(name=self.plugin.name, parameters=self.parameters)
        stored = choice_from_json(choice_to_json(choice))
        assert stored == choice
        made = self.plugin.create(stored.parameters)
        assert made.objectives == self.create().objectives
        trace = self.runs()[0]
        assert made.measure(RunView(trace, straight_road())) == self.measure(trace)

    def test_a_parameter_that_it_does_not_have_is_refused(self) -> None:
        with pytest.raises(SearchError):
            self.plugin.create({**self.parameters, "no_such_parameter": 1})
