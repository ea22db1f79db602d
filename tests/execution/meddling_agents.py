"""An agent that drives well, and changes the code that judges it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import AccelerationControl, Observation
from drivora_service.agents.plugin import AgentPlugin
from drivora_service.oracles.destination import Destination


class Meddler(IdmAgent):
    """Has every run count as arrived."""

    def run_step(self, observation: Observation) -> AccelerationControl:
        Destination.judge = lambda self, run: ()  # type: ignore[method-assign] # what it is about
        return super().run_step(observation)


def _create(parameters: Mapping[str, Any]) -> Meddler:
    return Meddler()


meddler = AgentPlugin(
    entry=AgentEntry(
        name="meddler",
        kind=AgentKind.MODULE_BASED,
        description="changes its judge",
        source="the tests",
        licence="Apache-2.0",
    ),
    create=_create,
)
