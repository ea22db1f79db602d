"""The road network and the gene space of a stored campaign."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.reading import read_campaign
from drivora_service.errors import CampaignError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.search.genes import GeneSpace
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.store.campaign_records import CampaignRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """What campaigns on one seed scenario have in common."""

    network: RoadNetwork
    space: GeneSpace


def ground_of(record: CampaignRecord, catalogues: Catalogues) -> Ground:
    """Returns the network and the genes of a campaign.

    Raises:
        InvalidDocument: What it names is not there any more.
        CampaignError: Its road network has changed since.
        SearchError: Its space cannot be built any more.
    """
    valid = read_campaign(record.document, catalogues)
    if valid.network.sha256 != record.network_sha256:
        raise CampaignError(
            f"the road network {record.town!r} has changed since campaign {record.id} was made: "
            "what it searched is not known any more; bring the old one back, or leave it out"
        )
    space = ScenarioSpace(valid.seed, valid.network, valid.campaign.space)
    return Ground(network=valid.network, space=space.genes)
