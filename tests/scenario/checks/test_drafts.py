"""Documents with many mistakes at once: each is named, and nothing that is no mistake."""

from __future__ import annotations

import copy
import json
from collections import Counter
from typing import Any

import hypothesis.strategies as st
import pytest
from hypothesis import given

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.document_problems import NAMED_LISTS
from drivora_service.scenario.validation import ValidScenario, validate_data
from tests.scenario.conftest import GOOD
from tests.scenario.strategies import documents, garbled
from tests.scenario.test_bad_input import BROKEN, CONE, NPC, WALKER

EGO = GOOD["ego_vehicles"][0]
AGENTS = ("idm",)


def problems_of(content: dict[str, Any], networks: NetworkCatalogue) -> list[tuple[str, str]]:
    with pytest.raises(InvalidDocument) as caught:
        validate_data(json.dumps(content), networks, AGENTS)
    return [(problem.pointer, problem.code) for problem in caught.value.problems]


NEEDS_FRAME = {
    "SUMO without a way",
    "start off the map",
    "walker off the map",
    "start is the destination",
    "overlapping starts",
    "patch beside the road",
    "patch off the map",
}
"""Mistakes that show only where the places are known in the network's plane."""
NEEDS_TOWN = NEEDS_FRAME | {"unknown light"}
NEEDS_FIRST_EGO = {"same id twice", "overlapping starts", "patch with an actor's id"}
"""Mistakes that are ones beside the first ego, which is well-formed."""
ALONE = {"start outside the region"}
"""Mistakes that concern all actors."""
LISTED = {
    name: pointer.split("/")[1]
    for name, (_, pointer) in BROKEN.items()
    if pointer.startswith(tuple(f"/{actors}/" for actors in NAMED_LISTS)) and name not in ALONE
}
"""The list of the actor or patch that each mistake of one is made in."""
ELSEWHERE = {
    name: pointer.split("/")[1]
    for name, (_, pointer) in BROKEN.items()
    if pointer and name not in {*LISTED, *ALONE, "repeated key"}
}
"""The key below which each of the others is made; those that make a text unreadable left out."""


@st.composite
def mistakes(draw: st.DrawFn) -> list[str]:
    """Names of mistakes that do not depend on one another."""
    chosen = draw(st.lists(st.sampled_from(sorted(LISTED)), unique=True, max_size=8))
    keys: set[str] = {LISTED[name] for name in chosen}
    for name in draw(st.permutations(sorted(ELSEWHERE)))[: draw(st.integers(0, 8))]:
        if ELSEWHERE[name] not in keys:
            keys.add(ELSEWHERE[name])
            chosen.append(name)
    unknown: set[str] = set()
    if "frame" in keys:
        unknown |= NEEDS_FRAME
    if any(ELSEWHERE.get(name) == "map_region" and "region" not in name for name in chosen):
        unknown |= NEEDS_TOWN
    if any(ELSEWHERE.get(name) == "ego_vehicles" for name in chosen):
        unknown |= NEEDS_FIRST_EGO
    return [name for name in chosen if name not in unknown]


def with_all(names: list[str]) -> tuple[dict[str, Any], list[str]]:
    """A document with all those mistakes, each made by an actor of its own, and their pointers."""
    content = copy.deepcopy(GOOD)
    pointers = []
    for name in names:
        change, pointer = BROKEN[name]
        changed = change(copy.deepcopy(GOOD))
        if name in ELSEWHERE:
            key = ELSEWHERE[name]
            if key in changed:
                content[key] = changed[key]
            else:
                del content[key]
        else:
            actors = content.setdefault(LISTED[name], [])
            (actor,) = changed[LISTED[name]]
            pointer = pointer.replace("/0", f"/{len(actors)}", 1)
            actors.append(actor if name in NEEDS_FIRST_EGO else moved(actor, name, len(actors)))
        pointers.append(pointer)
    return content, pointers


def moved(actor: Any, name: str, index: int) -> Any:
    """An actor apart from the others of its list, and with an id of its own."""
    if not isinstance(actor, dict):
        return actor
    own = dict(actor)
    if "id" not in BROKEN[name][1].split("/"):
        own["id"] = f"{actor['id']}_{index}"
    places = [dict(place) for place in actor.get("route", ())]
    start = EGO["route"][0]
    for place in places:
        if (place["x"], place["y"]) == (start["x"], start["y"]):
            place["x"] -= 7.0 * index
    return own | ({"route": places} if places else {})


@given(names=mistakes())
def test_each_of_many_mistakes_is_named(networks: NetworkCatalogue, names: list[str]) -> None:
    content, pointers = with_all(names)
    try:
        validate_data(json.dumps(content), networks, AGENTS)
        found = []
    except InvalidDocument as error:
        found = [problem.pointer for problem in error.problems]
    assert Counter(found) == Counter(pointers)


def test_mistakes_of_both_kinds_in_one_actor_are_named_in_order(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    good["seed"] = -1
    good["ego_vehicles"][0] = {
        "id": "a/b",
        "model": "bh.crossbike",
        "route": [{"x": 100.0, "y": 152.1}, {"x": 9e5, "y": 0.0}],
        "colour": "red",
        "initial_speed": 90.0,
        "start_time": -1.0,
        "agent": {"name": "nobody", "speed": 1},
    }
    good["npc_obstacles"] = [{**CONE, "model": "nothing", "length": 0}]
    assert problems_of(good, networks) == [
        ("/ego_vehicles/0/id", "string_pattern_mismatch"),
        ("/ego_vehicles/0/route/1", "off_network"),
        ("/ego_vehicles/0/colour", "extra_forbidden"),
        ("/ego_vehicles/0/initial_speed", "too_fast"),
        ("/ego_vehicles/0/start_time", "greater_than_equal"),
        ("/ego_vehicles/0/agent/name", "unknown_agent"),
        ("/ego_vehicles/0/agent/speed", "extra_forbidden"),
        ("/seed", "greater_than_equal"),
        ("/npc_obstacles/0/model", "unknown_model"),
        ("/npc_obstacles/0/length", "greater_than_equal"),
    ]


def test_rules_about_a_whole_are_judged_although_a_part_is_malformed(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    good["ego_vehicles"][0].update(config_path="idm", colour="red")
    good["ego_vehicles"][0]["route"][1] = {"x": 9e5, "y": 0.0}
    good["background_traffic"] = {"count": -1, "density": 1.0, "start_time": -1}
    assert problems_of(good, networks) == [
        ("/ego_vehicles/0", "two_agents"),
        ("/ego_vehicles/0/route/1", "off_network"),
        ("/ego_vehicles/0/colour", "extra_forbidden"),
        ("/background_traffic", "one_amount"),
        ("/background_traffic/count", "greater_than_equal"),
        ("/background_traffic/start_time", "greater_than_equal"),
    ]


@pytest.mark.parametrize(
    "route",
    [
        None,
        [{"x": 100.0, "y": 152.1}],
        [{"x": 9e5, "y": 0.0}, {"x": "30", "y": 153.2}],
        [{"x": 9e5, "y": 0.0}, {"x": 30.0, "y": 153.2, "speed": -1.0}],
    ],
)
def test_a_malformed_route_is_not_driven(
    networks: NetworkCatalogue, good: dict[str, Any], route: Any
) -> None:
    good["ego_vehicles"][0].update(route=route, model="nothing")
    model, shape = problems_of(good, networks)
    assert model == ("/ego_vehicles/0/model", "unknown_model")
    assert shape[0].startswith("/ego_vehicles/0/route")


def test_a_malformed_actor_is_in_no_actors_way(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    place = GOOD["ego_vehicles"][0]["route"][0]
    good["npc_obstacles"] = [{**CONE, "location": place}]
    assert problems_of(good, networks) == [("/npc_obstacles/0/location", "overlapping_start")]
    good["npc_obstacles"][0]["start_time"] = "now"
    assert problems_of(good, networks) == [("/npc_obstacles/0/start_time", "float_type")]
    good["npc_obstacles"][0]["start_time"] = 0.0
    good["ego_vehicles"][0]["colour"] = "red"
    assert problems_of(good, networks) == [("/ego_vehicles/0/colour", "extra_forbidden")]


def test_misspelt_keys_have_no_consequences(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    # As CARLA's coordinates these places might lie on the road; replayed, the car may stand here.
    del good["frame"]
    good["fraem"] = "carla"
    good["ego_vehicles"][0]["route"][0]["y"] = -152.1
    assert problems_of(good, networks) == [("/fraem", "extra_forbidden")]
    del good["fraem"]
    good["ego_vehicles"] = [EGO]
    good["npc_vehicles"] = [{**NPC, "behaviour": "replay", "route": [{"x": 60.0, "y": 170.0}] * 2}]
    assert problems_of(good, networks) == [("/npc_vehicles/0/behaviour", "extra_forbidden")]
    del good["npc_vehicles"][0]["behaviour"]
    assert ("/npc_vehicles/0/route/0", "off_network") in problems_of(good, networks)


def test_a_key_that_is_nothing_like_the_frame_leaves_the_places_known(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    del good["frame"]
    good["name"] = "crossing"
    good["npc_walkers"] = [{**WALKER, "route": [{"x": 9e5, "y": 0.0}]}]
    assert problems_of(good, networks) == [
        ("/name", "extra_forbidden"),
        ("/npc_walkers/0/route/0", "off_network"),
    ]


@pytest.mark.parametrize("region", [None, {"town": 5}, {"town": "Town12"}, {"regoin_segment": {}}])
def test_without_a_town_models_and_agents_are_looked_up_all_the_same(
    networks: NetworkCatalogue, good: dict[str, Any], region: Any
) -> None:
    good["map_region"] = region
    good["ego_vehicles"][0]["agent"]["name"] = "nobody"
    good["ego_vehicles"][0]["route"][1] = {"x": 9e5, "y": 0.0}
    good["npc_walkers"] = [{**WALKER, "model": "nothing"}]
    pointers = [pointer for pointer, _ in problems_of(good, networks)]
    assert pointers[0] == "/ego_vehicles/0/agent/name"
    assert pointers[-1] == "/npc_walkers/0/model"
    assert all(pointer.startswith("/map_region") for pointer in pointers[1:-1])
    assert len(pointers) > 2


def test_duplicate_ids_and_places_are_named_together(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    good["npc_walkers"] = [{**WALKER, "id": "ego_0", "route": [{"x": 9e5, "y": 0.0}]}]
    assert problems_of(good, networks) == [
        ("/npc_walkers/0/id", "duplicate_id"),
        ("/npc_walkers/0/route/0", "off_network"),
    ]


def test_any_agent_will_do_where_none_is_named(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    good["ego_vehicles"][0]["agent"]["name"] = "nobody"
    valid = validate_data(json.dumps(good), networks, None)
    assert valid.scenario.ego_vehicles[0].agent.name == "nobody"


@given(content=garbled(documents()))
def test_garbled_documents_are_refused_or_valid(
    networks: NetworkCatalogue, content: dict[str, Any]
) -> None:
    before = copy.deepcopy(content)
    try:
        assert isinstance(validate_data(content, networks, AGENTS), ValidScenario)
    except InvalidDocument as error:
        places = [(problem.pointer, problem.message) for problem in error.problems]
        assert len(set(places)) == len(places)
    assert repr(content) == repr(before)
