"""A scenario has the problems of the document that stands for it, whatever is wrong with it."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from drivora_service.errors import FurtherProblems, InvalidDocument, Problem
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario import model
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.document_problems import structural_problems
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.scenario.exporting import document_content, to_document
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.plain_data import MAX_PROBLEMS
from drivora_service.scenario.validation import (
    scenario_problems,
    validate_data,
    validate_document,
)
from drivora_service.search.space.space_options import SpaceOptions
from tests.scenario.broken_scenarios import (
    CHANGES,
    HARMLESS,
    leaves,
    with_agent,
    with_background,
    with_cone,
    with_lights,
    with_parked,
    with_region,
    with_value,
    with_walker,
)
from tests.scenario.checks.test_agent_checks import Drivers
from tests.scenario.strategies import documents
from tests.search.space.seeds import NETWORKS, SHIPPED, seed_scenario, space_around

OPTIONS = (
    SpaceOptions(vehicles=3, walkers=1, obstacles=1, lights=True),
    SpaceOptions(egos=4, vehicles=3, walkers=2, obstacles=2, lights=True, optional=True),
    SpaceOptions(vehicles=2, walkers=0, behavior=model.NpcBehavior.SUMO),
    SpaceOptions(vehicles=2, walkers=0, behavior=model.NpcBehavior.REPLAY),
)
ODD_NUMBERS = (math.nan, math.inf, -math.inf, 1e9, -1e9, 2**31, -1, -0.5, 1e-9, 0, True, np.True_)
AGENTS: tuple[Collection[str] | None, ...] = (
    None,
    ("idm",),
    ("other",),
    {"idm": "gone"},
    Drivers(),
)


def problems_of_document(scenario: Scenario, agents: Collection[str] | None) -> tuple[Problem, ...]:
    """What validation finds in the document that stands for a scenario."""
    try:
        validate_document(to_document(scenario), NETWORKS, agents)
    except InvalidDocument as error:
        return error.problems
    except ValidationError as error:
        # No document can be made of it: what there is stands for it as a user would write it.
        content = document_content(scenario)
        with pytest.raises(InvalidDocument) as caught:
            validate_data(content, NETWORKS, agents)
        if [problem.code for problem in caught.value.problems] == ["too_large"]:
            # Its parts are not read.
            return caught.value.problems
        listed = caught.value.problems
        malformed = structural_problems(error, ScenarioDocument, content)
        left_out = {one.pointer for one in malformed} - {one.pointer for one in listed}
        # Of many problems, the first of the document are listed, with the number of the others.
        is_full = len(listed) == MAX_PROBLEMS + 1 and isinstance(listed[-1], FurtherProblems)
        assert not left_out or is_full
        return listed
    return ()


@st.composite
def candidates(draw: st.DrawFn) -> Scenario:
    """Scenarios of spaces around seeds of all shipped networks, with genes at their bounds too."""
    space = space_around(draw(st.sampled_from(SHIPPED)), draw(st.sampled_from(OPTIONS)))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    values = space.genes.clip(space.genes.sample(random) * random.choice([1.0, 1e9, -1e9]))
    at_bounds = space.genes.clip(random.choice([-1e9, 1e9], len(values)))
    mixed = np.where(
        random.random(len(values)) < draw(st.sampled_from([0, 0.3, 1])), at_bounds, values
    )
    return space.scenario(space.repair(mixed) if draw(st.booleans()) else mixed)


# A failing example is small as it is drawn, and some take seconds: making it smaller would take
# minutes.
@settings(max_examples=60, phases=(Phase.explicit, Phase.reuse, Phase.generate))
@given(
    scenario=candidates(),
    changes=st.lists(st.sampled_from(sorted(CHANGES)), max_size=3),
    agents=st.sampled_from(AGENTS),
)
def test_broken_candidates_have_the_problems_of_their_documents(
    scenario: Scenario, changes: list[str], agents: Collection[str] | None
) -> None:
    for name in changes:
        if scenario.ego_vehicles and scenario.ego_vehicles[0].route:
            scenario = CHANGES[name](scenario)
    assert scenario_problems(scenario, NETWORKS, agents) == problems_of_document(scenario, agents)


@settings(max_examples=120)
@given(scenario=candidates(), data=st.data(), value=st.sampled_from(ODD_NUMBERS) | st.floats())
def test_numbers_have_the_bounds_of_documents(
    scenario: Scenario, data: st.DataObject, value: float
) -> None:
    place = data.draw(st.sampled_from(leaves(scenario)))
    broken = with_value(scenario, place, value)
    assert scenario_problems(broken, NETWORKS, ("idm",)) == problems_of_document(broken, ("idm",))


@settings(max_examples=50)
@given(scenario=candidates())
def test_valid_candidates_are_what_their_documents_validate_to(scenario: Scenario) -> None:
    problems = scenario_problems(scenario, NETWORKS, ("idm",))
    assert problems == problems_of_document(scenario, ("idm",))
    if not problems:
        again = validate_document(to_document(scenario), NETWORKS, ("idm",)).scenario
        assert canonical_json(again) == canonical_json(scenario)


@settings(max_examples=50)
@given(content=documents())
def test_scenarios_of_documents_have_the_problems_of_documents(
    networks: NetworkCatalogue, content: dict[str, Any]
) -> None:
    scenario = to_scenario(parse_document(content), networks.get("tee-town"))
    found = scenario_problems(scenario, NETWORKS, ("idm",))
    assert found == problems_of_document(scenario, ("idm",))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e9, -1e9, True, "1"])
def test_every_number_of_a_scenario_has_bounds(value: object) -> None:
    scenario = with_lights(seed_scenario("signal-grid"), none=model.LightTimes())
    scenario = with_background(with_region(with_cone(with_walker(scenario)), 900.0), 3)
    scenario = with_parked(scenario, id="one", start_time=3.0)
    for place in leaves(scenario):
        if place[-1] == "yaw" and value not in ODD_NUMBERS[:3]:
            # Any angle has degrees within a full turn.
            continue
        if place[-1] == "joins" and value is True:
            continue
        broken = with_value(scenario, place, value)
        problems = scenario_problems(broken, NETWORKS, ("idm",))
        assert [p for p in problems if p.code not in ("overlapping_start", "unknown_traffic_light")]


@pytest.mark.parametrize("name", sorted(CHANGES))
def test_every_change_alone_has_the_problems_of_its_document(name: str) -> None:
    broken = CHANGES[name](seed_scenario("signal-grid"))
    found = scenario_problems(broken, NETWORKS, Drivers())
    assert found == problems_of_document(broken, Drivers())
    assert bool(found) is (name not in HARMLESS)


def test_many_egos_with_many_waypoints_are_too_large_for_a_document() -> None:
    broken = CHANGES["65 egos"](CHANGES["2001 waypoints"](seed_scenario("signal-grid")))
    (problem,) = scenario_problems(broken, NETWORKS, ("idm",))
    assert (problem.pointer, problem.code) == ("", "too_large")
    assert problems_of_document(broken, ("idm",)) == (problem,)


@pytest.mark.parametrize("odd", [math.nan, "\0", "\ud800", 2**64, {1: 2}])
def test_free_data_that_no_document_can_hold(odd: object) -> None:
    """The document's class takes them; a text that says so is refused, and no worker reads them."""
    scenario = replace(seed_scenario("tee-town"), extensions={"a:b": {"c": odd}})
    (problem,) = scenario_problems(scenario, NETWORKS, ("idm",))
    assert problem.pointer.startswith("/extensions/a:b")
    (problem,) = scenario_problems(
        with_agent(seed_scenario("tee-town"), "idm", c=odd), NETWORKS, ("idm",)
    )
    assert problem.pointer.startswith("/ego_vehicles/0/agent/parameters/c")


def test_the_content_of_a_document_is_in_the_order_of_its_fields() -> None:
    scenario = with_lights(with_cone(with_walker(with_parked(seed_scenario("tee-town")))))
    scenario = with_lights(scenario, a=model.LightTimes(green=3.0))
    content = document_content(with_background(with_region(scenario, 9.0), 3))
    dumped = ScenarioDocument.model_validate(content).model_dump()
    assert in_order(content, dumped)


def in_order(content: Any, dumped: Any) -> bool:
    """Whether all keys are in an order, where there are keys."""
    if isinstance(content, dict):
        own = [key for key in dumped if key in content]
        return own == list(content) and all(in_order(content[key], dumped[key]) for key in own)
    if isinstance(content, list | tuple):
        return all(map(in_order, content, dumped))
    return True
