"""Parameters of testers follow the budget of their campaign."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Any

import pytest
from pydantic import Field

from drivora_service.errors import Problem, SearchError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.parameters import describe_allowed_values, describe_parameters
from drivora_service.search.budget_bounds import MOST_CANDIDATES, problems_of_tester, within_budget
from drivora_service.search.catalogue import BUILT_IN
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.testers.avfuzzer.search import AVFUZZER
from drivora_service.search.testers.random_search import RandomTester
from drivora_service.search.testers.samota.tester import SAMOTA


def integers(plugin: TesterPlugin[Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for one in describe_parameters(plugin.parameters):
        if one.schema.get("type") == "integer":
            yield one.name, dict(one.schema)


@pytest.mark.parametrize("plugin", BUILT_IN, ids=lambda plugin: plugin.name)
def test_every_integer_of_a_tester_is_bounded(plugin: TesterPlugin[Any]) -> None:
    for name, schema in integers(plugin):
        (found,) = problems_of_tester(plugin, {name: 10**9}, 30)
        assert found.pointer == f"/{name}"
        assert "is 1000000000; allowed: an integer " in found.message
        assert schema["maximum"] <= 10**8
    assert not list(problems_of_tester(plugin, {}, 1))


def test_what_is_simulated_may_not_exceed_the_budget() -> None:
    (found,) = problems_of_tester(SAMOTA, {"initial": 301}, 300)
    assert found.code == "beyond_budget"
    assert found.message == (
        "tester 'samota': initial is 301; allowed: an integer from 1 to 300 (the budget of a seed "
        "scenario, as each of these candidates is simulated)"
    )
    assert not list(problems_of_tester(SAMOTA, {"initial": 300}, 300))


def test_a_population_has_a_bound_whatever_the_budget() -> None:
    (found,) = problems_of_tester(AVFUZZER, {"population": MOST_CANDIDATES + 1}, 10**6)
    assert found.message.endswith("allowed: an integer from 2 to 10000 (whatever the budget)")
    # Of two bounds, the message names the lower one.
    (found,) = problems_of_tester(AVFUZZER, {"population": 20_000_000}, 30)
    assert "allowed: an integer from 2 to 30 (the budget" in found.message


def test_the_default_is_allowed_with_a_smaller_budget() -> None:
    assert not list(problems_of_tester(SAMOTA, {"initial": 30}, 4))
    (found,) = problems_of_tester(SAMOTA, {"initial": 31}, 4)
    assert "from 1 to 30 (the default; the budget of a seed scenario is 4)" in found.message


@dataclass(frozen=True, slots=True, kw_only=True)
class WithoutDefaults:
    needed: Annotated[int, within_budget(2)]
    optional: Annotated[int, within_budget(2)] | None = None


@pytest.mark.parametrize("name", ["needed", "optional"])
def test_a_parameter_without_a_default_number_is_bounded(name: str) -> None:
    plugin: TesterPlugin[WithoutDefaults] = TesterPlugin(
        name="own",
        title="Own",
        description="has parameters without defaults",
        source="the tests",
        parameters=WithoutDefaults,
        feedback=OWN.feedback,
        create=lambda context, _parameters, _components: RandomTester(context),
        is_generational=True,
    )
    assert not list(problems_of_tester(plugin, {"needed": 2, name: 30}, 30))
    (found,) = problems_of_tester(plugin, {"needed": 2, name: 31}, 30)
    assert found.pointer == f"/{name}"
    assert "allowed: an integer from 2 to 30 (the budget" in found.message
    (found,) = problems_of_tester(plugin, {"needed": 2, name: 3}, 1)
    assert "from 2 to 2 (the least value; the budget of a seed scenario is 1)" in found.message


def test_a_campaign_of_an_earlier_version_is_not_compared_with_its_budget() -> None:
    assert not list(problems_of_tester(SAMOTA, {"initial": 31}, None))


@dataclass(frozen=True, slots=True, kw_only=True)
class Islands:
    islands: Annotated[int, Field(ge=1, le=100)] = 2
    size: Annotated[int, within_budget(2)] = 4


def check_islands(parameters: Islands, budget: int) -> Iterator[Problem]:
    if parameters.islands * parameters.size > max(budget, 8):
        yield Problem(pointer="/islands", code="beyond_budget", message="too many")


OWN = TesterPlugin(
    name="islands",
    title="Islands",
    description="has several populations",
    source="the tests",
    parameters=Islands,
    feedback=FeedbackChoice(name="general"),
    create=lambda context, _parameters, _components: RandomTester(context),
    is_generational=True,
    check=check_islands,
)


def test_a_plug_in_gets_the_same_and_may_check_several_parameters_together() -> None:
    problems = [
        [(found.pointer, found.code) for found in problems_of_tester(OWN, given, 40)]
        for given in (
            {"size": 41, "islands": 5},
            {"size": 10, "islands": 5},
            {"size": 10, "islands": 4},
        )
    ]
    assert problems == [[("/size", "beyond_budget")], [("/islands", "beyond_budget")], []]


def test_a_check_that_raises_is_a_problem_of_its_plug_in() -> None:
    def fail(_parameters: Islands, _budget: int) -> Iterator[Problem]:
        raise ZeroDivisionError("division by zero")

    def refuse(_parameters: Islands, _budget: int) -> Iterator[Problem]:
        raise SearchError("no islands here")

    (raised,) = problems_of_tester(replace(OWN, check=fail), {}, 40)
    (refused,) = problems_of_tester(replace(OWN, check=refuse), {}, 40)
    assert raised.code == refused.code == "plugin"
    assert "raised ZeroDivisionError when it checked its parameters" in raised.message
    assert refused.message == "no islands here"


def test_the_allowed_values_name_the_budget() -> None:
    allowed = {
        one.name: describe_allowed_values(one.schema) for one in describe_parameters(Islands)
    }
    assert allowed == {
        "islands": "an integer from 1 to 100",
        "size": "an integer from 2 to 10000, not above the budget",
    }
