"""Plug-ins of agents with and without parameters, and those that cannot be made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.plugin import NoParameters, agent_plugin
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError

ENTRY = AgentEntry(
    name="own", kind=AgentKind.BASELINE, description="Own.", source="here", licence="none"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    headway: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Demanding:
    headway: float


def driver(*_parameters: object) -> SumoDriver:
    return SumoDriver(car_following="idm")


def without() -> SumoDriver:
    return driver()


@pytest.mark.parametrize("make", [without, driver, lambda _none: driver()])
def test_an_agent_without_parameters_is_made_of_nothing(make: Any) -> None:
    plugin = agent_plugin(ENTRY, None, make)
    assert plugin.parameters is NoParameters
    assert plugin.create({}) == driver()
    with pytest.raises(AgentError, match="headway"):
        plugin.create({"headway": 1.0})


def test_an_agent_gets_the_parameters_of_the_document() -> None:
    got: list[Options] = []

    def make(options: Options) -> SumoDriver:
        got.append(options)
        return driver()

    agent_plugin(ENTRY, Options, make).create({"headway": 2.0})
    assert got == [Options(headway=2.0)]


@pytest.mark.parametrize(
    ("parameters", "make", "said"),
    [
        (dict, driver, "its parameters are dict; allowed: a frozen dataclass"),
        ({}, driver, r"its parameters are \{\}; allowed: a frozen dataclass"),
        (Demanding, driver, "its parameter 'headway' has no default"),
        (Options, without, "`make` must be callable with one argument, its parameters"),
        (None, lambda _a, _b: driver(), "`make` must be callable with no argument"),
        (None, driver(), "`make` must be callable with no argument"),
    ],
)
def test_what_cannot_be_made_is_refused_where_the_plug_in_is_defined(
    parameters: Any, make: Any, said: str
) -> None:
    with pytest.raises(AgentError, match=f"agent 'own': {said}") as refused:
        agent_plugin(ENTRY, parameters, make)
    assert refused.value.cause == "agent_plugin"
