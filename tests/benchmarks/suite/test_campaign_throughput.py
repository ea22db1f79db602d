"""Every method has a campaign whose throughput can be measured."""

from __future__ import annotations

import json

import pytest

from benchmarks.methods import METHODS
from benchmarks.suite.campaign_throughput import (
    SHORT_SIMULATIONS,
    campaign_document,
    least_simulations,
)
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.search_preparation import prepare_search


@pytest.mark.parametrize("method", METHODS)
def test_its_campaign_can_begin(method: str, catalogues: Catalogues) -> None:
    if method == "deepcollision":
        pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")
    valid = read_campaign(json.dumps(campaign_document(method, 7)), catalogues)
    assert valid.campaign.tester.name == method
    assert len(prepare_search(valid, catalogues, run_prefix="throughput").parts) == 1


def test_the_budgets_leave_something_to_measure() -> None:
    assert least_simulations(short=True) <= SHORT_SIMULATIONS
    assert least_simulations(short=True) < least_simulations(short=False) <= 400
