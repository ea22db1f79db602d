"""Values of parameters as people read them."""

from __future__ import annotations

from typing import Any

import pytest

from drivora_service.agents.configuration import configuration_of
from drivora_service.scenario.model import AgentChoice
from drivora_service.short_values import short_value


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.5, "0.5"),
        ([0.1, 0.2, 0.3], "[0.1, 0.2, 0.3]"),
        ([0.1 * n for n in range(500)], "[0.0, 0.1, … 500 values]"),
        (
            [[0.25] * 500] * 500,
            "[[0.25, 0.25, … 500 values], [0.25, 0.25, … 500 values], … 500 values]",
        ),
        ({f"key {n}": n for n in range(500)}, '{"key 0": 0, "key 1": 1, … 500 values}'),
        ("Zürich", '"Zürich"'),
        ("x" * 500, '"' + "x" * 77 + '…"'),
    ],
)
def test_only_long_values_are_shortened(value: Any, text: str) -> None:
    assert short_value(value) == text


def test_the_words_of_a_configuration_count_the_elements_of_a_list() -> None:
    choice = AgentChoice(name="acme", parameters={"gains": [0.5 + n for n in range(500)]})
    assert (
        configuration_of([choice], lambda _: None).words == "acme · gains [0.5, 1.5, … 500 values]"
    )
