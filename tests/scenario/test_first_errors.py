"""The first of very many mistakes in a document."""

from __future__ import annotations

import json
import time
import tracemalloc
from typing import Any

import pytest
from pydantic import ValidationError

from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.errors import FurtherProblems, InvalidDocument, Problem, count_problems
from drivora_service.scenario.document_problems import structural_problems
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.scenario.plain_data import MAX_PROBLEMS, plain_data

MANY = 100_000
_MOST_TIMES_PARSING = 10.0
"""Was 20 and more while every problem was described and sorted; is 3."""


def refused(text: str, form: Any = "json") -> tuple[Problem, ...]:
    with pytest.raises(InvalidDocument) as caught:
        parse_document(text, form)
    return caught.value.problems


def test_many_unknown_keys_cost_little(good: dict[str, Any]) -> None:
    text = json.dumps({**good, **{f"k{number}": 0 for number in range(MANY)}})
    refused(json.dumps({"unknown": 1}))
    begun = time.process_time()
    json.loads(text)
    parsed = time.process_time()
    problems = refused(text)
    assert time.process_time() - parsed < _MOST_TIMES_PARSING * (parsed - begun)
    assert [problem.pointer for problem in problems[:2]] == ["/k0", "/k1"]
    assert len(problems) == MAX_PROBLEMS + 1
    assert count_problems(problems) == MANY
    assert problems[-1].message == f"{MANY - MAX_PROBLEMS} further problems are not listed"
    assert problems[-1].pointer == ""


def test_memory_is_that_of_the_listed_problems(good: dict[str, Any]) -> None:
    content, _ = plain_data(json.dumps({**good, **{f"k{number}": 0 for number in range(MANY)}}))
    with pytest.raises(ValidationError) as caught:
        ScenarioDocument.model_validate(content)
    tracemalloc.start()
    try:
        problems = structural_problems(caught.value, ScenarioDocument, content)
        assert tracemalloc.get_traced_memory()[1] < 10 << 20
    finally:
        tracemalloc.stop()
    assert count_problems(problems) == MANY


@pytest.mark.parametrize(
    "lists",
    [
        {"npc_vehicles": [{"a": 1}] * 20_000},
        {"npc_obstacles": [{f"k{number}": 0 for number in range(80)}] * 200},
        {"weather_changes": [[[0] * 60] * 60] * 10},
    ],
)
def test_many_mistakes_in_deep_lists(good: dict[str, Any], lists: dict[str, Any]) -> None:
    problems = refused(json.dumps({**good, **lists}))
    (name,) = lists
    assert len(problems) <= MAX_PROBLEMS + 1
    assert all(problem.pointer.startswith(f"/{name}") for problem in problems[:-1])


def test_mistakes_behind_many_right_items_are_found(good: dict[str, Any]) -> None:
    waypoint = {"x": 1.0, "y": 2.0}
    good["ego_vehicles"][0]["route"] = [waypoint] * 1500 + [{"x": "a", "y": "b"}] * 500
    good["ego_vehicles"] *= 5
    with pytest.raises(ValidationError) as caught:
        ScenarioDocument.model_validate(good)
    problems = structural_problems(caught.value, ScenarioDocument, good)
    pointers = [problem.pointer for problem in problems]
    assert "/ego_vehicles/0/route/1500/x" in pointers
    # Nothing is missing or too short only because a part was left out.
    assert not any(problem.code in ("missing", "too_short") for problem in problems)
    assert isinstance(problems[-1], FurtherProblems)


def test_names_that_are_known_elsewhere_stay(good: dict[str, Any]) -> None:
    content = {f"k{number}": 0 for number in range(5000)} | {"tester": {"name": 1}, "budget": {}}
    with pytest.raises(ValidationError) as caught:
        CampaignDocument.model_validate(content)
    problems = structural_problems(caught.value, CampaignDocument, content)
    assert "/tester/name" in [problem.pointer for problem in problems]


def test_many_keys_in_yaml() -> None:
    text = "\n".join(f"k{number}: 0" for number in range(5000))
    assert count_problems(refused(text, "yaml")) > 5000


@pytest.mark.parametrize(
    "text",
    [
        "{" + ",".join(f'"k\\u0000{number}": 0' for number in range(5000)) + "}",
        "{" + ",".join(f'"k{number}": 1, "k{number}": 2' for number in range(5000)) + "}",
        '{"a": [' + ",".join(["NaN"] * 5000) + "]}",
    ],
)
def test_many_odd_keys_and_values(text: str) -> None:
    problems = refused(text)
    assert len(problems) == MAX_PROBLEMS + 1
    assert "the rest of the document was not checked" in problems[-1].message
