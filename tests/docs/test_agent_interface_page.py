"""The page of the interface of agents names every field that an agent gets or may answer."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

from drivora_service.agents import interface
from drivora_service.networks.routes.lane_route import LaneRoute

_PAGE = (
    Path(__file__).resolve().parents[2] / "docs" / "reference" / "agent-interface.md"
).read_text()
_NAMED = set(re.findall(r"`(?:log\.)?([a-z_]+)", _PAGE))


@pytest.mark.parametrize("part", [interface.AgentContext, interface.Observation])
def test_every_field_is_named(part: type) -> None:
    assert {field.name for field in fields(part)} <= _NAMED


@pytest.mark.parametrize(
    "control",
    [
        interface.PedalControl,
        interface.AccelerationControl,
        interface.PoseControl,
        interface.TrajectoryControl,
    ],
)
def test_every_control_is_named_with_its_fields(control: type) -> None:
    assert f"`{control.__name__}`" in _PAGE
    assert set(control._fields) <= _NAMED  # type: ignore[attr-defined]  # all are named tuples


def test_the_route_has_what_the_page_says() -> None:
    rows = re.search(r"\| field of `route` .*?\n\n", _PAGE, re.DOTALL)
    assert rows
    named = set(re.findall(r"^\| `([a-z_]+)`", rows[0], re.MULTILINE))
    assert named == {"line", "arc", "speed_limits", "signals", "stop_signs", "runs"}
    assert named <= {field.name for field in fields(LaneRoute)}
