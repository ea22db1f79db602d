"""Whatever an agent does wrong ends its run with a cause, never the process."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.built_in_agents import BUILT_IN
from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.interface import (
    AccelerationControl,
    AgentContext,
    Observation,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.agents.plugin import AgentPlugin
from drivora_service.errors import AgentError
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.worker import performing
from drivora_service.worker.setup import WorkerSetup
from tests.simulation.episodes import ego, place, run, scenario


def _recurse(depth: int = 0) -> int:
    return _recurse(depth + 1) + 1


def _raise(error: BaseException) -> Any:
    raise error


class Faulty:
    def __init__(
        self,
        answer: Callable[[], Any] = lambda: AccelerationControl(1.0, 0.0),
        setup: Callable[[], Any] = lambda: None,
    ) -> None:
        self.answer, self.setup = answer, setup

    def setup_env(self, context: AgentContext) -> None:
        self.setup()

    def run_step(self, observation: Observation) -> Any:
        return self.answer() if observation.step >= 10 else AccelerationControl(1.0, 0.0)


def fail(agent: Faulty) -> AgentError:
    what = scenario(ego(place("harbour_1_0", 20), place("harbour_1_0", 120)), seconds=2.0)
    with pytest.raises(AgentError) as failure:
        run(what, agent)
    return failure.value


RAISING = {
    "ValueError": lambda: _raise(ValueError("lost the way")),
    "ZeroDivisionError": lambda: 1 / 0,
    "RecursionError": _recurse,
    "SystemExit": lambda: sys.exit(3),
    "MemoryError": lambda: _raise(MemoryError()),
}


@pytest.mark.parametrize("name", RAISING)
def test_an_agent_that_raises_while_driving(name: str) -> None:
    error = fail(Faulty(answer=RAISING[name]))
    assert error.cause == "agent_raised"
    assert "'ego'" in str(error)
    assert name in str(error)
    assert "run_step at 0.50 s" in str(error)
    assert "Traceback" in error.log or name == "RecursionError"
    assert name in error.log


@pytest.mark.parametrize("name", RAISING)
def test_an_agent_that_raises_in_its_setup(name: str) -> None:
    error = fail(Faulty(setup=RAISING[name]))
    assert error.cause == "agent_raised"
    assert name in str(error)
    assert "setup_env" in str(error)


@pytest.mark.parametrize(
    "answer",
    [
        None,
        "left",
        (1.0, 0.0),
        math.nan,
        AccelerationControl(math.nan, 0.0),
        AccelerationControl(0.0, math.inf),
        AccelerationControl("full", 0.0),  # type: ignore[arg-type]  # what authors do
        AccelerationControl(None, 0.0),  # type: ignore[arg-type]  # what authors do
        PedalControl(math.nan, 0.0, 0.0),
        PedalControl(0.0, math.inf, 0.0),
        PedalControl(0.0, 0.0, -math.nan),
        PedalControl([1.0], 0.0, 0.0),  # type: ignore[arg-type]  # what authors do
        PoseControl(math.nan, 0.0, 0.0),
        PoseControl(0.0, 0.0, 0.0, math.inf),
        PoseControl(0.0, 0.0, 0.0, "fast"),  # type: ignore[arg-type]  # what authors do
        TrajectoryControl(np.zeros((3, 3))),
        TrajectoryControl(np.zeros((0, 4))),
        TrajectoryControl(np.zeros((3, 4))),
        TrajectoryControl(np.full((3, 4), math.nan)),
        TrajectoryControl(None),  # type: ignore[arg-type]  # what authors do
        TrajectoryControl([["a"] * 4] * 2),  # type: ignore[arg-type]  # what authors do
    ],
    ids=repr,
)
def test_an_agent_that_answers_no_control(answer: object) -> None:
    error = fail(Faulty(answer=lambda: answer))
    assert error.cause == "agent_invalid_control"
    assert "ego" in str(error)


def test_an_agent_may_answer_numpy_numbers() -> None:
    what = scenario(ego(place("harbour_1_0", 20), place("harbour_1_0", 120)), seconds=1.0)
    answer = AccelerationControl(np.float32(1.5), np.float64(0.0))  # type: ignore[arg-type]  # as computed
    assert run(what, Faulty(answer=lambda: answer)).step_count == 21


def test_the_process_goes_on_after_a_failed_agent() -> None:
    fail(Faulty(answer=RAISING["RecursionError"]))
    what = scenario(ego(place("harbour_1_0", 20), place("harbour_1_0", 120)), seconds=1.0)
    assert run(what, Faulty()).step_count == 21


def test_a_log_that_no_longer_fits_what_was_declared_is_told_of() -> None:
    class Late(Faulty):
        def setup_env(self, context: AgentContext) -> None:
            self.context = context

        def run_step(self, observation: Observation) -> AccelerationControl:
            self.context.log.declare("surprise", "another")
            return AccelerationControl(1.0, 0.0)

    error = fail(Late())
    assert error.cause == "agent_raised"
    assert "run_step at 0.00 s" in str(error)


def test_whatever_an_agent_logs_becomes_a_line_of_text() -> None:
    class Chatty(Faulty):
        def setup_env(self, context: AgentContext) -> None:
            self.context = context

        def run_step(self, observation: Observation) -> AccelerationControl:
            self.context.log.event({"speed": observation.speed})  # type: ignore[arg-type]  # no text
            return AccelerationControl(1.0, 0.0)

    what = scenario(ego(place("harbour_1_0", 20), place("harbour_1_0", 120)), seconds=0.1)
    trace = run(what, Chatty())
    assert [(event.step, event.message) for event in trace.log_events][:1] == [
        (0, "{'speed': 0.0}")
    ]


@pytest.mark.parametrize(
    ("wrong", "cause", "says"),
    [
        ("run_step", "agent_raised", "lost"),
        ("setup_env", "agent_raised", "lost"),
        ("make", "agent_raised", "lost"),
        ("answer", "agent_invalid_control", "NoneType"),
    ],
)
def test_a_run_reports_what_its_agent_did(
    wrong: str, cause: str, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def make(parameters: Mapping[str, Any]) -> Faulty:
        if wrong == "make":
            raise KeyError("lost")
        lost: Callable[[], Any] = lambda: _raise(KeyError("lost"))  # noqa: E731  # two of them
        if wrong == "setup_env":
            return Faulty(setup=lost)
        return Faulty(answer=lost if wrong == "run_step" else lambda: None)

    entry = AgentEntry(
        name="faulty", kind=AgentKind.BASELINE, description="fails", source="", licence=""
    )
    catalogue = AgentCatalogue((*BUILT_IN, AgentPlugin(entry=entry, create=make)))
    monkeypatch.setattr(performing, "agents_of", lambda setup: catalogue)
    what = scenario(
        ego(place("harbour_1_0", 20), place("harbour_1_0", 120), agent="faulty"), seconds=2.0
    )
    report = performing.perform(
        RunSpec(run_id="r", document=canonical_json(what)),
        WorkerSetup(shipped_networks=shipped_networks(), imported_networks=None),
    )
    assert report.status is RunStatus.AGENT_FAILED
    assert report.failure is not None
    assert report.failure.cause == cause
    assert says in report.failure.message
    assert says in report.failure.log
