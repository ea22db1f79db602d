"""From scenarios back to documents."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import example, given, settings
from hypothesis import strategies as st

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.canonical import scenario_sha256
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import document_text, parse_document
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.frames import FrameTransform
from tests.scenario.strategies import documents


@settings(max_examples=40)
@given(content=documents())
def test_the_document_of_a_scenario_gives_the_same_scenario(
    networks: NetworkCatalogue, content: dict[str, Any]
) -> None:
    network = networks.get("tee-town")
    scenario = to_scenario(parse_document(content), network)
    text = document_text(to_document(scenario))
    again = to_scenario(parse_document(text), network)
    assert again == scenario
    assert scenario_sha256(again) == scenario_sha256(scenario)


@example(degrees=-5e-324, mirrored=False)
@example(degrees=0.0, mirrored=True)
@given(st.floats(-720, 720), st.booleans())
def test_a_heading_is_never_minus_zero(degrees: float, mirrored: bool) -> None:
    angle = FrameTransform(mirrored=mirrored).yaw_to_network(degrees)
    assert angle or math.copysign(1.0, angle) == 1.0


@given(st.floats(-720, 720), st.booleans())
def test_frames_give_the_same_numbers_for_a_heading(degrees: float, mirrored: bool) -> None:
    angle = FrameTransform(mirrored=mirrored).yaw_to_network(degrees)
    assert FrameTransform(mirrored=not mirrored).yaw_to_network(-degrees) == angle
