"""The contract of metrics, as a suite of tests for authors of metrics.

Derive a class whose name begins with ``Test`` and give it the plug-in::

    class TestMyMetric(MetricContract):
        plugin = MY_PLUGIN
"""

from __future__ import annotations

import pickle
import re
from dataclasses import replace
from typing import ClassVar

from drivora_service.metrics.installed_metrics import InstalledMetric
from drivora_service.metrics.metric_descriptions import METRICS
from drivora_service.metrics.plugin import MetricPlugin
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.testing.networks import straight_road
from drivora_service.testing.oracle_contract import example_runs


class MetricContract:
    """Tests that every metric passes.

    Attributes:
        plugin: The metric under test.
    """

    plugin: ClassVar[MetricPlugin]

    def runs(self) -> tuple[Trace, ...]:
        """Returns runs on ``straight_road``; a metric that needs more than they have adds it."""
        return example_runs()

    def measure(self, trace: Trace) -> tuple[float | None, ...]:
        """Measures each ego of a run on ``straight_road``, as a worker does."""
        metric = InstalledMetric(
            name=self.plugin.name,
            package="tests",
            metric=self.plugin.create(),
            combine=self.plugin.several_egos,
        )
        return metric.measure(RunView(trace, straight_road())).values

    def test_it_says_what_it_is(self) -> None:
        assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", self.plugin.name)
        assert len(self.plugin.name) <= 60
        assert self.plugin.description
        assert self.plugin.unit

    def test_its_name_is_not_that_of_a_built_in_metric(self) -> None:
        assert self.plugin.name not in {metric.name for metric in METRICS}

    def test_every_ego_gets_a_finite_number_or_none(self) -> None:
        # A value that is neither raises.
        for trace in self.runs():
            assert len(self.measure(trace)) == trace.ego_count

    def test_it_tells_the_example_runs_apart(self) -> None:
        values = {
            value
            for trace in self.runs()
            for ego, value in zip(
                RunView(trace, straight_road()).egos, self.measure(trace), strict=True
            )
            if ego.count
        }
        assert len(values) > 1

    def test_the_same_run_gives_the_same_value_whatever_was_measured_before(self) -> None:
        runs = self.runs()
        alone = [self.measure(trace) for trace in runs]
        metric = self.plugin.create()
        for _ in range(2):
            for trace, expected in zip(runs, alone, strict=True):
                egos = RunView(trace, straight_road()).egos
                assert tuple(metric.measure(e) if e.count else None for e in egos) == expected

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
