"""The built-in agents keep the contract for agents."""

from __future__ import annotations

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.testing.agent_contract import AgentContract
from tests.simulation.episodes import Blind


class TestIdm(AgentContract):
    def make_agent(self) -> Agent:
        agent = AgentCatalogue().create("idm", {})
        assert not isinstance(agent, SumoDriver)
        return agent


class TestAnAgentWithoutALog(AgentContract):
    """The smallest agent there is: it keeps the contract without logging a thing."""

    def make_agent(self) -> Agent:
        return Blind()
