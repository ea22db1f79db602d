"""Campaigns in spaces with slippery patches, of the methods that treat them in their own ways."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.model import Scenario
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import CampaignState, EvaluationRecord
from drivora_service.store.database import Database
from tests.campaigns.analytic import sequence
from tests.campaigns.records.test_stored_campaigns import Campaigns

METHODS = ("decictor", "drivefuzz", "lawbreaker", "samota", "behavexplor")
SPACE = {
    "vehicles": 2,
    "walkers": 1,
    "obstacles": 1,
    "patches": 3,
    "optional": True,
    "max_deceleration": 9.0,
    "max_lateral_acceleration": 6.0,
    "max_wait": 4.0,
    "at_end": "stay",
}


@pytest.fixture
def campaigns(database: Database, catalogues: Catalogues, tmp_path: Path) -> Campaigns:
    return Campaigns(database, catalogues, tmp_path)


def _evaluated(
    campaigns: Campaigns, content: dict[str, Any], workers: int
) -> tuple[list[EvaluationRecord], list[Scenario]]:
    made = campaigns.create(content)
    assert campaigns.run(made, workers).state is CampaignState.FINISHED
    journal = StoreJournal(campaigns.database, made)
    told = campaigns.evaluations(made)
    return told, [from_canonical(journal.document(one.number)) for one in told]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*METHODS, "deepcollision"])
def test_the_number_of_workers_does_not_change_a_campaign_with_patches(
    campaigns: Campaigns, content: dict[str, Any], name: str
) -> None:
    parameters = {}
    if name == "deepcollision":
        pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")
        parameters = {"scene": "drawn", "interval": 4.0, "learning_starts": 8, "hidden": 16}
    content |= {"tester": {"name": name, "parameters": parameters}, "space": SPACE}
    content["oracles"] = ["collision", "non_optimal_decision"]
    alone, scenarios = _evaluated(campaigns, content, 1)
    assert any(scenario.friction_patches for scenario in scenarios)
    assert {one.status for one in alone} <= {EvaluationStatus.JUDGED, EvaluationStatus.INVALID}
    together, _ = _evaluated(campaigns, content, 2)
    assert sequence(together) == sequence(alone)
    assert [one.report.trace_sha256 for one in together] == [
        one.report.trace_sha256 for one in alone
    ]


def test_decictor_keeps_the_patches_of_its_reference(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    content |= {"tester": {"name": "decictor"}, "space": SPACE}
    content |= {"oracles": ["non_optimal_decision"], "budget": {"simulations": 9}}
    told, (first, *others) = _evaluated(campaigns, content, 2)
    assert told[0].proposal.origin == "reference"
    assert first.friction_patches
    assert {one.friction_patches for one in others} == {first.friction_patches}
    assert all(ego.reference_path for one in others for ego in one.ego_vehicles)
    assert len({(one.npc_vehicles, one.npc_walkers, one.npc_obstacles) for one in others}) > 3


def test_drivefuzz_adds_patches_to_a_parent_that_keeps_its_own(
    campaigns: Campaigns, content: dict[str, Any]
) -> None:
    content |= {
        "tester": {"name": "drivefuzz", "parameters": {"patch_chance": 1.0, "weather_chance": 0.0}},
        "space": SPACE,
        "budget": {"simulations": 18},
    }
    told, scenarios = _evaluated(campaigns, content, 2)
    counts = {len(scenario.friction_patches) for scenario in scenarios}
    assert max(counts) >= 2
    for record, scenario in zip(told, scenarios, strict=True):
        for parent in record.proposal.parents:
            known = scenarios[parent]
            assert len(scenario.friction_patches) <= len(known.friction_patches) + 1
            assert scenario.npc_vehicles == known.npc_vehicles
