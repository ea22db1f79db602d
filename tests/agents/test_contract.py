"""The built-in agents keep the contract for agents."""

from __future__ import annotations

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.testing.agent_contract import AgentContract
from tests.simulation.episodes import Blind


def made(name: str) -> Agent:
    agent = AgentCatalogue().create(name, {})
    assert not isinstance(agent, SumoDriver)
    return agent


class TestIdm(AgentContract):
    def make_agent(self) -> Agent:
        return made("idm")


class TestIdmMobil(AgentContract):
    def make_agent(self) -> Agent:
        return made("idm-mobil")


class TestPdmClosed(AgentContract):
    def make_agent(self) -> Agent:
        return made("pdm-closed")


class TestScripted(AgentContract):
    def make_agent(self) -> Agent:
        return made("scripted")


class TestAnAgentWithoutALog(AgentContract):
    """The smallest agent there is: it keeps the contract without logging a thing."""

    def make_agent(self) -> Agent:
        return Blind()
