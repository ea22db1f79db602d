"""Agents that do to a worker what real ones do: crash the simulator, spin, eat memory."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Mapping
from typing import Any

import libsumo
import numpy as np

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.plugin import AgentPlugin

AFTER_S = 1.0


class Crasher(IdmAgent):
    """Crashes libsumo by a segmentation fault: a walker at a place where none can walk."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        if observation.time > AFTER_S:
            edge = next(e for e in libsumo.edge.getIDList() if not e.startswith(":"))
            libsumo.person.add("walker", edge, 5.0)
            libsumo.person.appendWaitingStage("walker", 100.0)
            for step in range(30):
                # The first calls raise; libsumo 1.28 does not survive those after them.
                with contextlib.suppress(Exception):
                    libsumo.person.moveToXY("walker", edge, 10.0 + step, 10.0, 0.0, 2, 100.0)
                with contextlib.suppress(Exception):
                    libsumo.simulationStep()
        return super().run_step(observation)


class Spinner(IdmAgent):
    """Never answers."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        while observation.time > AFTER_S:
            time.sleep(0.0)
        return super().run_step(observation)


class Eater(IdmAgent):
    """Grows with every call: a machine may be too slow to fill the limit within one."""

    def __init__(self) -> None:
        super().__init__()
        self._kept: list[object] = []

    def run_step(self, observation: Observation) -> AccelerationControl:
        if observation.time > AFTER_S:
            self._kept.append(np.ones(2**23))
        return super().run_step(observation)


def _plugin(name: str, kind: type[IdmAgent]) -> AgentPlugin:
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


crasher = _plugin("crasher", Crasher)
spinner = _plugin("spinner", Spinner)
eater = _plugin("eater", Eater)
