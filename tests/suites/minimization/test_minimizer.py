"""The minimiser on scenarios that fail by rules on their documents: no simulation is needed."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.suites.minimization.edits import content_of
from drivora_service.suites.minimization.minimizer import Minimizer, Phase
from tests.suites.minimization.synthetic import Content, Rule, answered, checker, minimizer

_FIELDS = ("npc_vehicles", "npc_walkers", "npc_obstacles")


def crowded() -> ScenarioDocument:
    """A street with five other actors, weather, extensions and numbers of many digits."""
    content: dict[str, Any] = copy.deepcopy(SCENARIO)
    _start, end = content["ego_vehicles"][0]["route"]
    content["npc_vehicles"] = [
        {
            "id": f"car_{n}",
            "model": "vehicle.lincoln.mkz_2017",
            "behavior": "replay",
            "route": [
                {"x": end["x"] + 0.123 * n, "y": end["y"] - 10.0 * n - step, "speed": 3.25}
                for step in (0.0, 2.5, 5.125)
            ],
        }
        for n in range(3)
    ]
    content["npc_walkers"] = [
        {
            "id": "walker",
            "model": "walker.pedestrian.0001",
            "route": [{"x": 15.0, "y": 60.0}, {"x": 5.0, "y": 60.25, "speed": 1.5}],
            "start_time": 1.75,
        }
    ]
    content["npc_obstacles"] = [
        {
            "id": "barrel",
            "model": "static.prop.container",
            "location": {"x": 20.5, "y": 70.125, "yaw": 12.5},
        }
    ]
    content["weather"] = {"precipitation": 80.0, "fog_density": 33.25, "wetness": 50.5}
    content["extensions"] = {"a:one": {"free": 1}, "b:two": [1, 2]}
    content["max_sim_time"] = 60.0
    document = parse_document(content)
    assert checker()(document) is not None
    return document


def ids(content: Content) -> set[str]:
    return {actor["id"] for key in _FIELDS for actor in content.get(key, ())}


def smaller(content: Content) -> Iterator[Content]:
    """Every document with one thing fewer, by code that knows nothing of the minimiser."""
    for key in _FIELDS:
        for index, actor in enumerate(content.get(key, ())):
            less = copy.deepcopy(content)
            del less[key][index]
            yield less
            for number in range(len(actor.get("route", ()))):
                if len(actor["route"]) > 1:
                    less = copy.deepcopy(content)
                    del less[key][index]["route"][number]
                    yield less
            for name in {"start_time", "behavior"} & actor.keys():
                less = copy.deepcopy(content)
                del less[key][index][name]
                yield less
    for name in content.get("weather", ()):
        less = copy.deepcopy(content)
        del less["weather"][name]
        yield less
    for name in content.get("extensions", ()):
        less = copy.deepcopy(content)
        del less["extensions"][name]
        yield less
    yield from rounded(content)


def rounded(content: Content) -> Iterator[Content]:
    """Every document with one number of fewer digits, found in its text."""
    text = json.dumps(content)
    decoder = json.JSONDecoder(parse_float=lambda digits: [digits])
    places: list[tuple[Any, ...]] = []

    def look(part: Any, place: tuple[Any, ...]) -> None:
        if isinstance(part, dict):
            for key, value in part.items():
                look(value, (*place, key))
        elif isinstance(part, list) and len(part) == 1 and isinstance(part[0], str):
            places.append(place)
        elif isinstance(part, list):
            for index, value in enumerate(part):
                look(value, (*place, index))

    look(decoder.decode(text), ())
    for place in places:
        for decimals in range(4):
            less = json.loads(text)
            part = less
            for key in place[:-1]:
                part = part[key]
            if round(part[place[-1]], decimals) != part[place[-1]]:
                part[place[-1]] = round(part[place[-1]], decimals)
                yield less


def fails(content: Content, rule: Rule) -> bool:
    """Whether a document can be run and fails."""
    document = parse_document(content)
    return checker()(document) is not None and rule(dict(content_of(document)))


@st.composite
def rules(draw: st.DrawFn) -> Rule:
    """A scenario fails with some actors, weather, and coordinates within bounds."""
    needed = draw(st.frozensets(st.sampled_from(["car_0", "car_1", "car_2", "walker", "barrel"])))
    rain = draw(st.sampled_from([0.0, 50.0, 79.5]))
    north = draw(st.sampled_from([0.0, 104.3, 104.31]))
    odd = draw(st.booleans())

    def rule(content: Content) -> bool:
        there = ids(content)
        return (
            needed <= there
            # Not monotone: one other actor hides the failure.
            and not (odd and len(there) == len(needed) + 1)
            and content.get("weather", {}).get("precipitation", 0.0) >= rain
            and content["ego_vehicles"][0]["route"][-1]["y"] >= min(north, 200.0)
        )

    return rule


@settings(max_examples=25)
@given(rules())
def test_no_single_thing_can_be_left_out_of_the_result(rule: Rule) -> None:
    """Brute force by other code: each actor, waypoint, setting and digit is needed."""
    document = crowded()
    if not rule(dict(content_of(document))):
        return
    made = minimizer(document)
    answered(made, rule)
    assert made.phase is Phase.DONE
    assert made.is_one_minimal
    assert made.state is not None
    content = dict(content_of(made.state.document))
    assert fails(content, rule)
    for less in smaller(content):
        assert not fails(less, rule), less


@settings(max_examples=25)
@given(rules(), st.integers(2, 7), st.randoms(use_true_random=False))
def test_the_number_of_workers_and_their_luck_do_not_matter(
    rule: Rule, workers: int, luck: random.Random
) -> None:
    document = crowded()
    if not rule(dict(content_of(document))):
        return
    alone, together = minimizer(document), minimizer(document)
    answered(alone, rule)
    answered(together, rule, workers=workers, luck=luck)
    assert end_of(alone) == end_of(together)


@settings(max_examples=15)
@given(rules(), st.integers(1, 40), st.integers(1, 4), st.randoms(use_true_random=False))
def test_a_budget_ends_at_the_same_place_on_any_number_of_workers(
    rule: Rule, budget: int, workers: int, luck: random.Random
) -> None:
    document = crowded()
    if not rule(dict(content_of(document))):
        return
    alone, together = minimizer(document, budget=budget), minimizer(document, budget=budget)
    answered(alone, rule)
    answered(together, rule, workers=workers, luck=luck)
    assert end_of(alone) == end_of(together)
    assert alone.decided <= budget
    if not alone.is_one_minimal:
        assert alone.decided == budget


@settings(max_examples=15)
@given(rules(), st.integers(1, 60), st.integers(1, 3))
def test_one_that_begins_again_goes_on_with_stored_results(
    rule: Rule, most: int, workers: int
) -> None:
    document = crowded()
    if not rule(dict(content_of(document))):
        return
    whole, killed, again = (minimizer(document) for _ in range(3))
    results = answered(whole, rule)
    stored = answered(killed, rule, workers=workers, most=most)
    assert stored.keys() <= results.keys() or workers > 1
    asked: list[Content] = []

    def counted(content: Content) -> bool:
        asked.append(content)
        return rule(content)

    answered(again, counted, told=stored)
    assert end_of(again) == end_of(whole)
    assert len(asked) == len(results.keys() - stored.keys())


def end_of(made: Minimizer) -> tuple[Any, ...]:
    assert made.is_over
    assert made.state is not None
    return made.phase, made.state.document, made.decided, made.is_one_minimal


def test_a_failure_that_does_not_come_again() -> None:
    made = minimizer(crowded())
    answered(made, lambda _content: False)
    assert made.phase is Phase.NOT_REPRODUCED
    assert made.state is None
    assert made.choose_trials(5) == ()


def test_a_result_that_does_not_fail_again() -> None:
    made = minimizer(crowded())
    calls = 0

    def fails_once(_content: Content) -> bool:
        nonlocal calls
        calls += 1
        # The result of everything away is asked twice: at first, and to confirm it.
        return made.phase != Phase.CONFIRMING

    answered(made, fails_once)
    assert made.phase is Phase.NOT_CONFIRMED
    assert calls > 3


def test_the_ads_under_test_always_stays() -> None:
    content = dict(content_of(crowded()))
    content["ego_vehicles"][0]["agent"] = {"name": "idm", "parameters": {"speed_factor": 1.25}}
    made = minimizer(parse_document(content))
    answered(made, lambda _content: True)
    assert made.state is not None
    (ego,) = made.state.document.ego_vehicles
    assert ego.agent is not None
    assert ego.agent.parameters == {"speed_factor": 1.25}


def test_a_document_that_cannot_be_run() -> None:
    content = dict(content_of(crowded()))
    content["map_region"] = {"town": "tee-town"}
    content["ego_vehicles"][0]["route"][0]["x"] = 90_000.0
    with pytest.raises(ValueError, match="cannot be run"):
        minimizer(parse_document(content))
