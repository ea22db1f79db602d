"""Campaigns that are led by the margin of an own oracle, and by an own metric."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.campaigns.campaign_records import CampaignState, EvaluationRecord
from drivora_service.store.database import Database
from tests.campaigns.records.test_stored_campaigns import Campaigns
from tests.installed_parts import install_parts

SPACE = {"vehicles": 0, "walkers": 1, "weather": False, "max_walker_delay": 0.0}
LED = {
    "margin": {"name": "walker_spare"},
    "metric": {"name": "walker_speed_mps", "direction": "maximise", "target": 2.999},
}


@pytest.fixture
def campaigns(database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Campaigns:
    install_parts(tmp_path / "site", monkeypatch)
    return Campaigns(database, Catalogues(NetworkCatalogue(shipped_networks())), tmp_path)


def evaluated(
    campaigns: Campaigns, content: dict[str, Any], **changes: Any
) -> list[EvaluationRecord]:
    """Runs a campaign of short simulations, in which nothing but one walker varies."""
    content |= {"space": SPACE, "oracles": ["walker_runs"], "budget": {"simulations": 40}}
    content["scenario"]["max_sim_time"] = 1.0
    made = campaigns.create({**content, **changes})
    assert campaigns.run(made, 2).state is CampaignState.FINISHED
    assert campaigns.record(made).versions["own-parts"] == "0.1"
    return campaigns.evaluations(made)


def found(told: list[EvaluationRecord]) -> int:
    return sum(bool(one.violations) for one in told)


@pytest.mark.slow
@pytest.mark.parametrize("led", LED)
def test_a_search_that_is_led_finds_what_random_draws_do_not(
    led: str, campaigns: Campaigns, content: dict[str, Any]
) -> None:
    # The gene of the walker's speed ends at 3 m/s: one draw of 2,000 violates the oracle.
    drawn = evaluated(campaigns, content, feedback=LED[led])
    assert found(drawn) == 0
    told = evaluated(campaigns, content, tester={"name": "samota"}, feedback=LED[led])
    assert found(told) > 0
    name = "walker_spare" if led == "margin" else "negated_walker_speed_mps"
    best = [
        min(
            one.report.measurement.objectives[name] or 0.0
            for one in records
            if one.report.measurement is not None
        )
        for records in (drawn, told)
    ]
    assert best[1] < best[0]
    for one in told:
        report = one.report
        assert report.measurement is not None
        # What was chosen stands first, and what the method's publication minimises is kept.
        assert next(iter(report.measurement.objectives)) == name
        assert "lane_centre" in report.measurement.objectives
        assert report.scores["walker_spare"] is not None
        speed = report.metrics["walker_speed_mps"]
        assert speed == pytest.approx(2.999 - report.scores["walker_spare"])
        assert report.versions["own-parts"] == "0.1"
