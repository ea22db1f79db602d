"""How the egos of scenarios turn."""

from __future__ import annotations

import json

import pytest

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.cli.campaigns.campaign_files import shipped_campaigns
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import validate_data
from drivora_service.studies.coverage.campaign_coverage import turns_of
from drivora_service.studies.coverage.coverage_values import Turn


def shipped(catalogues: Catalogues, name: str, *, headings: bool) -> Scenario:
    """An example seed, with the headings of its waypoints or without."""
    document = json.loads((shipped_campaigns() / f"{name}.json").read_text())
    if not headings:
        for ego in document["ego_vehicles"]:
            for point in ego["route"]:
                point.pop("yaw", None)
    return validate_data(json.dumps(document), catalogues.networks, ("idm",)).scenario


@pytest.mark.parametrize(
    ("name", "turn"), [("market-street", Turn.LEFT), ("highway-in-rain", Turn.STRAIGHT)]
)
@pytest.mark.parametrize("headings", [True, False])
def test_turns_are_those_of_the_lanes_where_waypoints_have_no_heading(
    catalogues: Catalogues, name: str, turn: Turn, headings: bool
) -> None:
    scenario = shipped(catalogues, name, headings=headings)
    network = catalogues.networks.get(scenario.map_region.town)
    assert turns_of(network, [scenario, scenario]) == [{turn}, {turn}]
