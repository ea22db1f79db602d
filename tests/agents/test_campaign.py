"""The module-based agents on random routes of every shipped network, in traffic."""

from __future__ import annotations

import functools
import json
from dataclasses import replace

import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace import TerminalEvent
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.verdict import Outcome
from drivora_service.scenario.model import BackgroundTraffic, Scenario
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document
from tests.simulation.episodes import network, run

TOWNS = (
    "arterial", "highway", "old-town", "roundabout", "rural", "signal-grid", "tee-town",
)  # fmt: skip


@functools.lru_cache(maxsize=1)
def _networks() -> NetworkCatalogue:
    return NetworkCatalogue(shipped_networks())


def seeds(town: str, agent: str, count: int = 10) -> list[Scenario]:
    documents = generate_seeds(
        network(town), count=count, min_length=150.0, max_length=350.0, seed=7, agent=agent
    )
    return [
        replace(
            validate_document(document, _networks(), [agent]).scenario,
            background_traffic=BackgroundTraffic(count=15),
        )
        for document in documents
    ]


@pytest.mark.slow(seconds=4)
@pytest.mark.parametrize("agent", ["idm", "idm-mobil", "pdm-closed"])
@pytest.mark.parametrize("town", TOWNS)
def test_it_arrives_without_being_at_fault(town: str, agent: str) -> None:
    arrived, faults = 0, []
    for number, what in enumerate(seeds(town, agent)):
        trace = run(what)
        arrived += trace.ego_ends[0] is TerminalEvent.ARRIVED
        if trace.ego_ends[0] is not TerminalEvent.ARRIVED:
            faults.append(f"{number}: {trace.ego_ends[0]} after {trace.times[-1]:.1f} s")
        faults += [
            f"{number} at {verdict.time} s: {verdict.message}"
            for verdict in judge_all(trace, network(town), (Collision(), RedLight()))
            if verdict.outcome is Outcome.VIOLATED and verdict.at_fault
        ]
    listing = json.dumps(faults, indent=1)
    assert arrived >= 9, listing
    assert not [fault for fault in faults if " at " in fault], listing
