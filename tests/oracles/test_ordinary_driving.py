"""Ordinary driving through the real simulation breaks no traffic rule."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.minimum_speed import MinimumSpeed
from drivora_service.oracles.near_miss import NearMiss
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.tailgating import Tailgating
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import read_document
from tests.simulation.episodes import network, run

RULES = (RedLight(), StopSign(), FailureToYield(), NearMiss(), Tailgating(), MinimumSpeed())


@pytest.mark.parametrize("name", ["highway-cut-in", "lead-vehicle-and-pedestrian", "wet-arterial"])
def test_idm_keeps_the_rules_in_the_shipped_examples(name: str, repository: Path) -> None:
    text = (repository / "openscenario_schemas" / "examples" / f"{name}.json").read_text()
    document = read_document(text).document
    assert document is not None
    town = network(document.map_region.town)
    view = RunView(run(to_scenario(document, town)), town)
    broken = [
        (verdict.oracle, verdict.message)
        for rule in RULES
        for verdict in rule.judge(view)
        if verdict.outcome is not Outcome.PASSED
    ]
    assert not broken
