"""Campaigns with the candidates that they start from."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument, campaign_text
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.document.start_checks import read_starts
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.errors import InvalidDocument
from drivora_service.search.genes import GeneSpace
from drivora_service.studies.study_reading import read_study


def content(start: object, **changes: Any) -> dict[str, Any]:
    return {
        "name": "warm",
        "tester": {"name": "avfuzzer", "start_from": start},
        "agent": {"name": "idm"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": {"vehicles": 2, "walkers": 1},
        "budget": {"simulations": 12},
        **changes,
    }


def start_of(*candidates: Any, **more: Any) -> dict[str, Any]:
    listed = [{"values": list(one)} for one in candidates]
    return {"source": "campaign a", "kind": "failures", "candidates": listed, **more}


@pytest.fixture(scope="module")
def genes(catalogues: Catalogues) -> GeneSpace:
    cold = content(None)
    del cold["tester"]["start_from"]
    search = prepare_search(read_campaign(cold, catalogues), catalogues, run_prefix="")
    return search.parts[0].candidates.genes


def problems(catalogues: Catalogues, campaign: dict[str, Any]) -> dict[str, str]:
    with pytest.raises(InvalidDocument) as caught:
        prepare_search(read_campaign(campaign, catalogues), catalogues, run_prefix="")
    return {one.pointer: one.message for one in caught.value.problems}


def test_the_genes_are_proposed_first(catalogues: Catalogues, genes: GeneSpace) -> None:
    known = genes.sample(np.random.default_rng(3), 2)
    valid = read_campaign(content(start_of(*known.tolist())), catalogues)
    assert "the search starts from 2 failures of campaign a" in valid.notes
    search = prepare_search(valid, catalogues, run_prefix="")
    proposals = search.parts[0].tester.ask(3)
    assert [one.origin for one in proposals] == ["start", "start", "initial"]
    assert np.array_equal([one.values for one in proposals[:2]], known)
    # What is stored is what was read, to the last digit.
    stored = CampaignDocument.model_validate_json(campaign_text(valid.document))
    assert stored == valid.document
    assert np.array_equal(read_starts(stored, "", genes), known)


def test_genes_of_another_space_are_refused(catalogues: Catalogues, genes: GeneSpace) -> None:
    short, odd, wrong = (genes.lows.tolist() for _ in range(3))
    short.pop()
    choice = int(np.flatnonzero(genes.is_category)[0])
    odd[choice] = 0.5
    wrong[0] = 1e6
    found = problems(catalogues, content(start_of(short, odd, wrong)))
    place = "/tester/start_from/candidates"
    assert f"found {len(genes) - 1} genes" in found[f"{place}/0/values"]
    assert genes.names[choice] in found[f"{place}/1/values"]
    assert "whole" in found[f"{place}/1/values"]
    assert "found 1e+06 for gene 'vehicle_0.present'" in found[f"{place}/2/values"]


def test_other_networks_and_seeds_are_refused(catalogues: Catalogues, genes: GeneSpace) -> None:
    low = genes.lows.tolist()
    found = problems(catalogues, content(start_of(low, network_sha256="0" * 64)))
    assert "another version of the road network" in found["/tester/start_from/network_sha256"]
    named = {"source": "a", "kind": "elites", "candidates": [{"seed": "north", "values": low}]}
    found = problems(catalogues, content(named))
    assert "found 'north'" in found["/tester/start_from/candidates/0/seed"]


def test_only_the_command_line_looks_up_campaigns(catalogues: Catalogues) -> None:
    found = problems(catalogues, content({"campaign": "latest"}))
    assert "only the command line looks it up" in found["/tester/start_from"]


def test_a_budget_without_room_for_the_method_is_noted(
    catalogues: Catalogues, genes: GeneSpace
) -> None:
    many = genes.sample(np.random.default_rng(3), 12).tolist()
    valid = read_campaign(content(start_of(*many)), catalogues)
    assert any("take the whole budget of 12 simulations" in note for note in valid.notes)


def test_a_study_names_the_scenario_of_each(catalogues: Catalogues, genes: GeneSpace) -> None:
    low, high = genes.lows.tolist(), genes.highs.tolist()
    start = start_of(low, high)
    start["candidates"][0]["seed"], start["candidates"][1]["seed"] = "north", "south"
    study = {
        "name": "warm and cold",
        "scenarios": [
            {"document": copy.deepcopy(SCENARIO), "label": label} for label in ("north", "south")
        ],
        "agents": [{"name": "idm"}],
        "methods": [{"name": "random"}, {"name": "random", "start_from": start}],
        "space": {"vehicles": 2, "walkers": 1},
        "budget": {"simulations": 12},
    }
    valid = read_study(study, catalogues)
    assert valid.document.method_labels == ("random", "random from failures")
    starts = {
        (one.cell.scenario, one.cell.method): read_starts(
            CampaignDocument.model_validate_json(one.document), "", genes
        )
        for one in valid.campaigns
        if one.cell is not None
    }
    assert starts["north", "random"] == []
    assert np.array_equal(starts["north", "random from failures"], [low])
    assert np.array_equal(starts["south", "random from failures"], [high])
    start["candidates"][1]["seed"] = "west"
    with pytest.raises(InvalidDocument) as caught:
        read_study(study, catalogues)
    messages = " ".join(problem.message for problem in caught.value.problems)
    assert "no candidate of scenario 'south'" in messages
    assert "a candidate of no scenario: 'west'" in messages
