"""Every built-in feedback keeps the contract, and the contract finds those that do not."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
import pytest

from drivora_service.errors import SearchError
from drivora_service.feedback.avfuzzer import AVFUZZER
from drivora_service.feedback.behavexplor import BEHAVEXPLOR
from drivora_service.feedback.catalogue import BUILT_IN
from drivora_service.feedback.decictor import DECICTOR
from drivora_service.feedback.deepcollision import DEEPCOLLISION
from drivora_service.feedback.doppeltest import DOPPELTEST
from drivora_service.feedback.drivefuzz import DRIVEFUZZ
from drivora_service.feedback.general import GENERAL
from drivora_service.feedback.lawbreaker import lawbreaker_feedback
from drivora_service.feedback.measurement import Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.feedback.samota import SAMOTA
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent, Trace
from drivora_service.testing.feedback_contract import FeedbackContract


class TestGeneral(FeedbackContract):
    plugin = GENERAL


class TestAvfuzzer(FeedbackContract):
    plugin = AVFUZZER


class TestBehavexplor(FeedbackContract):
    plugin = BEHAVEXPLOR


class TestDecictor(FeedbackContract):
    plugin = DECICTOR

    def runs(self) -> tuple[Trace, ...]:
        return (*super().runs(), *map(_compared, super().runs()))


class TestDeepcollision(FeedbackContract):
    plugin = DEEPCOLLISION


class TestDoppelTest(FeedbackContract):
    plugin = DOPPELTEST


class TestSamota(FeedbackContract):
    plugin = SAMOTA


class TestLawbreaker(FeedbackContract):
    plugin = lawbreaker_feedback()


class TestDriveFuzz(FeedbackContract):
    plugin = DRIVEFUZZ


def _compared(trace: Trace) -> Trace:
    """Gives each ego of a run a path to compare with: 100 m east within 10 s."""
    path = np.array([(0.0, 0.0, 0.0, 0.0, 10.0, 0.0), (10.0, 100.0, 0.0, 0.0, 10.0, 0.0)])
    arrived = (TerminalEvent.ARRIVED,) * trace.ego_count
    return replace(trace, references=(path,) * trace.ego_count, ego_ends=arrived)


def test_every_built_in_feedback_is_under_contract() -> None:
    under_contract = {suite.plugin.name for suite in FeedbackContract.__subclasses__()}
    assert {plugin.name for plugin in BUILT_IN} | {"lawbreaker"} <= under_contract


@dataclass(kw_only=True)
class Duration:
    """Measures the duration of a run, with one mistake or none."""

    mistake: str
    measured: list[float] = field(default_factory=list)

    objectives: ClassVar[tuple[str, ...]] = ("duration",)

    def measure(self, run: RunView) -> Measurement:
        duration = float(run.trace.times[-1])
        self.measured.append(duration)
        values: dict[str, float | None] = {"duration": duration}
        features: dict[str, tuple[tuple[float, ...], ...]] = {}
        match self.mistake:
            case "another objective":
                values = {"length": duration}
            case "infinite":
                values = {"duration": math.inf}
            case "constant":
                values = {"duration": 1.0}
            case "remembers":
                values = {"duration": sum(self.measured)}
            case "writes":
                run.trace.states[0, 0, 0] += 1.0
            case "looks beyond the end":
                values = {"duration": float(run.trace.states[-1, 0, 0])}
            case "ragged":
                features = {"table": ((1.0,),) if duration > 5.0 else ((1.0, 2.0),)}
            case "sometimes a table":
                features = {"table": ()} if duration > 5.0 else {}
        return Measurement(objectives=values, features=features)


MISTAKES: Mapping[str, Callable[[FeedbackContract], None]] = {
    "another objective": (
        FeedbackContract.test_every_measurement_holds_its_objectives_in_their_order
    ),
    "infinite": FeedbackContract.test_objectives_are_finite_or_not_measurable,
    "constant": FeedbackContract.test_some_objective_tells_the_example_runs_apart,
    "remembers": (
        FeedbackContract.test_the_same_run_gives_the_same_measurement_whatever_was_measured_before
    ),
    "writes": FeedbackContract.test_measuring_leaves_the_trace_alone,
    "looks beyond the end": FeedbackContract.test_what_happens_after_an_egos_end_changes_nothing,
    "ragged": (FeedbackContract.test_features_are_the_same_tables_of_finite_numbers_for_every_run),
    "sometimes a table": (
        FeedbackContract.test_features_are_the_same_tables_of_finite_numbers_for_every_run
    ),
}


def suite_of(mistake_made: str) -> FeedbackContract:
    def create(parameters: Mapping[str, Any]) -> Duration:
        if parameters:
            raise SearchError("it has no parameters")
        return Duration(mistake=mistake_made)

    class Suite(FeedbackContract):
        plugin = FeedbackPlugin(name="duration", description="how long it took", create=create)

    return Suite()


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_found(mistake: str) -> None:
    test = MISTAKES[mistake]
    test(suite_of("none"))
    with pytest.raises(AssertionError):
        test(suite_of(mistake))
