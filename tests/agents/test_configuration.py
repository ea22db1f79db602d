from __future__ import annotations

from typing import Any

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.agents.configuration import (
    ID_LENGTH,
    LONGEST_WORDS,
    AgentConfiguration,
    configuration_of,
)
from drivora_service.errors import UnknownName
from drivora_service.parameters import ParameterDescription
from drivora_service.scenario.model import AgentChoice

AGENTS = AgentCatalogue()
DEFAULTS = AGENTS.fill_defaults(AgentChoice(name="idm")).parameters


def idm(**parameters: Any) -> AgentChoice:
    return AgentChoice(name="idm", parameters=parameters)


def configuration(*choices: AgentChoice) -> AgentConfiguration:
    return AGENTS.configuration(choices)


def test_only_parameters_that_differ_from_their_defaults_are_named() -> None:
    plain, slowed = configuration(idm()), configuration(idm(reaction_time=1.0))
    assert (plain.words, slowed.words) == ("idm", "idm · reaction_time 1.0")
    assert plain.id != slowed.id
    assert {len(plain.id), len(slowed.id)} == {ID_LENGTH}


def test_a_default_that_is_written_changes_neither_words_nor_id() -> None:
    assert configuration(idm(**DEFAULTS)) == configuration(idm())
    assert configuration(idm(**{**DEFAULTS, "reaction_time": 1.0})) == configuration(
        idm(reaction_time=1.0)
    )


def test_an_integer_and_the_equal_decimal_number_are_one_value() -> None:
    assert configuration(idm(reaction_time=1)) == configuration(idm(reaction_time=1.0))


def test_parameters_are_named_in_the_order_in_which_the_agent_declares_them() -> None:
    first, second = list(DEFAULTS)[:2]
    one = configuration(idm(**{first: 3.25, second: 4.5}))
    other = configuration(idm(**{second: 4.5, first: 3.25}))
    assert one == other
    assert one.words == f"idm · {first} 3.25 · {second} 4.5"


def test_equal_agents_of_several_egos_count_once_and_others_are_joined() -> None:
    slowed = idm(reaction_time=1.0)
    assert configuration(slowed, slowed) == configuration(slowed)
    both = configuration(idm(), slowed)
    assert both.words == "idm,idm · reaction_time 1.0"
    assert both.id not in {configuration(idm()).id, configuration(slowed).id}


def test_an_agent_that_is_not_installed_here_has_the_parameters_that_it_was_given() -> None:
    one = AgentChoice(name="elsewhere", parameters={"b": "text", "a": [1, 2]})
    same = AgentChoice(name="elsewhere", parameters={"a": [1, 2], "b": "text"})
    found = configuration(one)
    assert found.words == "elsewhere · a [1, 2] · b text"
    assert found == configuration(same)
    assert found.id != configuration(AgentChoice(name="elsewhere")).id


@pytest.mark.parametrize("declared", [None, "unknown"])
def test_without_declared_parameters_no_default_is_assumed(declared: str | None) -> None:
    def look_up(name: str) -> tuple[ParameterDescription, ...] | None:
        if declared:
            raise UnknownName("agent", name, ())
        return None

    found = configuration_of([AgentChoice(name="own", parameters={"speed": 3})], look_up)
    assert found.words == "own · speed 3"


def test_long_values_and_words_are_cut_while_their_ids_differ() -> None:
    found = [
        configuration(
            AgentChoice(name="own", parameters={f"p{n}": "x" * 90 + end for n in range(20)})
        )
        for end in "ab"
    ]
    assert found[0].words == found[1].words
    assert len(found[0].words) == LONGEST_WORDS
    assert found[0].words.endswith("…")
    assert found[0].id != found[1].id


def test_ids_are_those_of_earlier_versions() -> None:
    """Stored ids are compared with new ones, so that how they are made never changes."""
    found = configuration(AgentChoice(name="elsewhere", parameters={"speed": 1.5, "on": True}))
    assert found.id == "70938592"
