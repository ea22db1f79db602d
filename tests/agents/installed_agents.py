"""Agents with environments of their own, where a tester has installed them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.interface import Agent
from drivora_service.agents.sumo_driver import SumoDriver


@contextmanager
def installed_agents(*names: str) -> Iterator[AgentCatalogue]:
    """Returns a catalogue in which agents are installed; skips where they are not.

    ``DRIVORA_TEST_AGENTS`` names the folder of agents.
    """
    folder = os.environ.get("DRIVORA_TEST_AGENTS", "")
    catalogue = AgentCatalogue(folder=Path(folder) if folder else None)
    missing = [name for name in names if not catalogue.entry(name).installed]
    if missing:
        pytest.skip(
            f"not installed: `drivora agents install {missing[0]}`, and DRIVORA_TEST_AGENTS names "
            "the folder of agents"
        )
    yield catalogue
    catalogue.close()


def fresh_agent(catalogue: AgentCatalogue, name: str) -> Agent:
    """Makes an agent for the next run."""
    catalogue.begin_run()
    agent = catalogue.create(name, {})
    assert not isinstance(agent, SumoDriver)
    return agent
