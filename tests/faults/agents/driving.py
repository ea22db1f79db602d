"""Good agents of the tests, and what all agents of the tests are made with."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.plugin import AgentPlugin

BEGIN_S = 0.5
"""Seconds of simulation after which a hostile agent does what it is named after."""


def evidence() -> Path:
    """Returns the folder where hostile agents leave what they have managed to do."""
    site = next(p for p in map(Path, sys.path) if (p / "faulty_agents-1.0.dist-info").is_dir())
    return site / "evidence"


def workers_folder() -> Path:
    """Returns the folder with the files of the service's workers."""
    return Path("/proc/self/fd/1").readlink().parent


class Steady(IdmAgent):
    """Drives as idm does, and takes some tenths of a second for it."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        time.sleep(0.003)
        return super().run_step(observation)


class Slow(IdmAgent):
    """Drives as idm does, and takes some seconds for it."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        time.sleep(0.04)
        return super().run_step(observation)


class Hostile(IdmAgent):
    """Drives as idm does, and does its harm once."""

    def __init__(self) -> None:
        super().__init__()
        self._done = False

    def run_step(self, observation: Observation) -> AccelerationControl:
        if observation.time > BEGIN_S and not self._done:
            self._done = True
            self.harm()
        return super().run_step(observation)

    def harm(self) -> None:
        """Does the harm."""
        raise NotImplementedError


def plugin(name: str, kind: type[IdmAgent]) -> AgentPlugin:
    """Returns the catalogue's entry of an agent."""

    def create(parameters: Mapping[str, Any]) -> IdmAgent:
        return kind()

    entry = AgentEntry(
        name=name,
        kind=AgentKind.MODULE_BASED,
        description=kind.__doc__ or "",
        source="the tests",
        licence="Apache-2.0",
    )
    return AgentPlugin(entry=entry, create=create)


steady = plugin("steady", Steady)
slow = plugin("slow", Slow)
