"""Ordinary driving through the real simulation breaks no traffic rule."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.junction_blocking import JunctionBlocking
from drivora_service.oracles.junction_stands.stands import find_junction_stands
from drivora_service.oracles.minimum_speed import MinimumSpeed
from drivora_service.oracles.near_miss import NearMiss
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.tailgating import Tailgating
from drivora_service.oracles.verdict import WITHOUT_FINDING, Outcome
from drivora_service.scenario.conversion import to_scenario
from drivora_service.scenario.documents import read_document
from drivora_service.scenario.model import BackgroundTraffic
from drivora_service.scenario.seed_generation import generate_seeds
from tests.simulation.episodes import network, run

RULES = (
    RedLight(),
    StopSign(),
    FailureToYield(),
    JunctionBlocking(),
    NearMiss(),
    Tailgating(),
    MinimumSpeed(),
)


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
        if verdict.outcome not in WITHOUT_FINDING
    ]
    assert not broken


@pytest.mark.parametrize(
    ("town", "number", "stands"),
    [
        # Waits in the junction for 11.7 s, for a gap in the traffic that goes first.
        ("roundabout", 6, True),
        # Waits for more than a minute behind a vehicle that stopped after the ego had entered.
        ("old-town", 3, True),
        ("arterial", 0, False),
        ("signal-grid", 0, False),
        ("tee-town", 0, False),
    ],
)
def test_idm_blocks_no_junction_in_dense_traffic(town: str, number: int, stands: bool) -> None:
    where = network(town)
    seeds = generate_seeds(where, count=8, min_length=150.0, max_length=400.0, seed=7, agent="idm")
    document = next(islice(seeds, number, None))
    what = replace(
        to_scenario(document, where),
        background_traffic=BackgroundTraffic(count=60),
        max_sim_time=120.0,
    )
    view = RunView(run(what), where)
    (verdict,) = JunctionBlocking().judge(view)
    assert verdict.outcome is Outcome.PASSED
    found = find_junction_stands(view.egos[0], standing_speed=0.1)
    assert any(len(one.rows) * view.trace.step_length >= 10.0 for one in found) is stands
