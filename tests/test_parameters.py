"""What users set in plug-ins, and what is told of it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any, Literal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.parameters import (
    describe_allowed_values,
    describe_parameters,
    parameter_problems,
    read_parameters,
)


class Colour(StrEnum):
    """A choice with a name and a description of its own."""

    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """Parameters of every kind.

    Attributes:
        rate: How often,
            of all.
    """

    rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    size: Annotated[int, Field(gt=0)] = 4
    mode: Literal["slow", "fast"] = "slow"
    colour: Colour = Colour.RED
    names: tuple[str, ...] = ()
    choice: tuple[int, ...] | Annotated[str, Field(max_length=3)] | None = None


def test_every_problem_has_place_value_and_allowed_values() -> None:
    written = {"rat": 1, "rate": 2, "size": 0, "mode": "Fast", "names": ["a", 1], "a/b": None}
    problems = parameter_problems(Sample, written, of="sample")
    assert [(problem.pointer, problem.code) for problem in problems] == [
        ("/rat", "unknown_parameter"),
        ("/a~1b", "unknown_parameter"),
        ("/rate", "less_than_equal"),
        ("/size", "greater_than"),
        ("/mode", "literal_error"),
        ("/names/1", "string_type"),
    ]
    assert [problem.message for problem in problems] == [
        "sample has no parameter 'rat'; did you mean 'rate'? Known: rate, size, mode, colour, "
        "names, choice",
        "sample has no parameter 'a/b'; known: rate, size, mode, colour, names, choice",
        "sample: rate is 2; allowed: a number from 0 to 1",
        "sample: size is 0; allowed: an integer above 0",
        'sample: mode is "Fast"; allowed: "slow", "fast"',
        "sample: names.1 is 1; allowed: a list, each of it text",
    ]


def test_a_value_of_one_of_several_types_is_told_of_where_it_stands() -> None:
    problems = parameter_problems(Sample, {"choice": [1, "b"]}, of="sample")
    assert {problem.pointer for problem in problems} <= {"/choice", "/choice/1"}
    assert "a list, each of it an integer or text or null" in problems[0].message


def test_long_values_are_not_repeated() -> None:
    (problem,) = parameter_problems(Sample, {"rate": "x" * 10_000}, of="sample")
    assert len(problem.message) < 200


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=5,
)


@settings(max_examples=40)
@given(
    st.dictionaries(st.sampled_from(["rate", "size", "names", "choice"]) | st.text(), json_values)
)
def test_what_has_no_problems_is_read_and_the_rest_is_not(written: dict[str, Any]) -> None:
    if parameter_problems(Sample, written, of="sample"):
        with pytest.raises(SearchError):
            read_parameters(Sample, written, of="sample")
    else:
        assert isinstance(read_parameters(Sample, written, of="sample"), Sample)


@pytest.mark.parametrize(
    ("schema", "words"),
    [
        ({"type": "number"}, "a number"),
        ({"type": "integer", "minimum": 1}, "an integer of at least 1"),
        ({"type": "number", "maximum": 2.5}, "a number of at most 2.5"),
        (
            {"type": "number", "exclusiveMinimum": 0, "maximum": 1},
            "a number above 0 and of at most 1",
        ),
        ({"type": "boolean"}, "true or false"),
        ({"const": "a"}, '"a"'),
        ({"anyOf": [{"type": "string"}, {"type": "null"}]}, "text or null"),
        ({"type": "object", "title": "X"}, '{"type": "object"}'),
    ],
)
def test_what_is_allowed_is_said_in_words(schema: dict[str, Any], words: str) -> None:
    assert describe_allowed_values(schema) == words


def test_a_description_is_that_of_the_docstring() -> None:
    rate, *others = describe_parameters(Sample)
    assert (rate.name, rate.default, rate.description) == ("rate", 0.5, "How often, of all.")
    assert rate.schema == {"type": "number", "minimum": 0.0, "maximum": 1.0}
    assert {other.description for other in others} == {""}


def test_the_schema_of_a_parameter_stands_by_itself() -> None:
    colour = next(one for one in describe_parameters(Sample) if one.name == "colour")
    assert colour.schema == {"type": "string", "enum": ["red", "blue"]}
    assert colour.default == "red"
    (problem,) = parameter_problems(Sample, {"colour": "green"}, of="sample")
    assert problem.message == 'sample: colour is "green"; allowed: "red", "blue"'
