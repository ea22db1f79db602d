"""The campaigns that check the guarantees of every method can begin."""

from __future__ import annotations

import json
from typing import Any

import pytest

from benchmarks.method_campaigns import (
    BUDGET,
    TELLING,
    make_generated_campaign,
    make_telling_campaign,
)
from benchmarks.methods import METHODS
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.search.search_preparation import prepare_search


def test_every_method_has_both() -> None:
    assert set(BUDGET) == set(TELLING) == set(METHODS)


@pytest.mark.parametrize("method", METHODS)
def test_they_can_begin(method: str, catalogues: Catalogues) -> None:
    if method == "deepcollision":
        pytest.importorskip("stable_baselines3", reason="an extra: `adversary`")
    for town in ("tee-town", "signal-grid"):
        _begin(
            make_generated_campaign(catalogues.networks, method, town, seed=1, simulations=5),
            catalogues,
        )
    _begin(make_telling_campaign(method, seed=1, simulations=5), catalogues)


def _begin(document: dict[str, Any], catalogues: Catalogues) -> None:
    valid = read_campaign(json.dumps(document), catalogues)
    for note in valid.notes:
        assert "which do not count here" not in note
    search = prepare_search(valid, catalogues, run_prefix="check")
    assert all(part.tester.ask(1) for part in search.parts)
