"""Agents whose drives cannot be replayed: they depend on more than scenario and seed."""

from __future__ import annotations

import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.plugin import AgentPlugin

DICES_FROM_S = 1.0
REMEMBERS_FROM_S = 2.0
FAILS_AT_S = 0.5


class Dicing(IdmAgent):
    """Drives as idm for a second, and then with draws from a generator without a seed."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        control = super().run_step(observation)
        if observation.time < DICES_FROM_S - 1e-6:
            return control
        return control._replace(acceleration=control.acceleration - random.SystemRandom().random())


class Remembering(IdmAgent):
    """Drives as idm the first time, and brakes in later runs: it keeps a file between them."""

    def __init__(self, notes: Path, *, fails: bool) -> None:
        super().__init__()
        self._fails = fails
        self._has_driven = (notes / "driven").exists()
        (notes / "driven").touch()

    def run_step(self, observation: Observation) -> AccelerationControl:
        control = super().run_step(observation)
        if self._has_driven and self._fails and observation.time > FAILS_AT_S:
            raise ValueError("I was here before")
        if self._has_driven and observation.time > REMEMBERS_FROM_S - 1e-6:
            return control._replace(acceleration=-3.0)
        return control


class Failing(IdmAgent):
    """Raises in every run."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        if observation.time > FAILS_AT_S:
            raise ValueError("this far and no further")
        return super().run_step(observation)


def _entry(name: str, kind: type[IdmAgent]) -> AgentEntry:
    return AgentEntry(
        name=name,
        kind=AgentKind.MODULE_BASED,
        description=kind.__doc__ or "",
        source="the tests",
        licence="Apache-2.0",
    )


def _remembering(parameters: Mapping[str, Any]) -> Remembering:
    return Remembering(Path(parameters["notes"]), fails=bool(parameters.get("fails")))


dicing = AgentPlugin(entry=_entry("dicing", Dicing), create=lambda _parameters: Dicing())
failing = AgentPlugin(entry=_entry("failing", Failing), create=lambda _parameters: Failing())
remembering = AgentPlugin(entry=_entry("remembering", Remembering), create=_remembering)
