"""Plug-ins of a package: agents and a feedback that misbehave."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import libsumo

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.interface import Agent, AgentContext, Control, Observation, PedalControl
from drivora_service.agents.plugin import AgentPlugin
from drivora_service.feedback.measurement import Feedback, Measurement
from drivora_service.feedback.plugin import FeedbackPlugin
from drivora_service.observations.run_view import RunView

NAP_S = 1.5
"""Seconds for which the slow agent sleeps in each of its first two calls."""


class SlowStarter:
    """Needs long to set up, and long for its first step."""

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        self._naps = 2

    def setup_env(self, context: AgentContext) -> None:
        self._nap()

    def run_step(self, observation: Observation) -> Control:
        if self._naps:
            self._nap()
        return PedalControl(throttle=0.3, brake=0.0, steer=0.0)

    def _nap(self) -> None:
        self._naps -= 1
        time.sleep(NAP_S)


class Saboteur:
    """Closes the simulator under the episode."""

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        """Takes no parameters."""

    def setup_env(self, context: AgentContext) -> None:
        """Does nothing."""

    def run_step(self, observation: Observation) -> Control:
        if observation.step == 20:
            for name in libsumo.vehicle.getIDList():
                libsumo.vehicle.remove(name)
        return PedalControl(throttle=0.3, brake=0.0, steer=0.0)


@dataclass(frozen=True, slots=True)
class Moody:
    """A feedback that misbehaves as its parameter says."""

    mood: str
    objectives: tuple[str, ...] = ("gap",)

    def measure(self, run: RunView) -> Measurement:
        match self.mood:
            case "raises":
                raise ZeroDivisionError("in a bad mood")
            case "leaves":
                raise SystemExit(3)
            case "text":
                return "no measurement"  # type: ignore[return-value] # what a package might do
            case "other":
                return Measurement(objectives={"distance": 1.0})
            case "infinite":
                return Measurement(objectives={"gap": float("inf")})
        return Measurement(objectives={"gap": 1.0})


def _moody(parameters: Mapping[str, Any]) -> Feedback:
    if parameters["mood"] == "unmade":
        raise KeyError("nothing to make it of")
    return Moody(parameters["mood"])


def _agent(name: str, make: Callable[[Mapping[str, Any]], Agent]) -> AgentPlugin:
    entry = AgentEntry(
        name=name,
        kind=AgentKind.BASELINE,
        description="Does what it should not.",
        source="tests",
        licence="Apache-2.0",
    )
    return AgentPlugin(entry=entry, create=make)


slow_starter = _agent("slow-starter", SlowStarter)
saboteur = _agent("saboteur", Saboteur)
moody = FeedbackPlugin(name="moody", description="Misbehaves.", create=_moody)
