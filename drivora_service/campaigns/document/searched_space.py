"""The road networks and the gene spaces of a stored campaign."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import CampaignDocument, to_campaign
from drivora_service.campaigns.document.campaign_reading import hash_of_networks
from drivora_service.errors import CampaignError
from drivora_service.given_names import read_stored
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.validation import validate_document
from drivora_service.search.genes import GeneSpace
from drivora_service.search.space.own_space import make_space
from drivora_service.store.campaigns.campaign_records import CampaignRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchedSpace:
    """The common parts of campaigns on one seed scenario."""

    network: RoadNetwork
    space: GeneSpace


def searched_spaces_of(record: CampaignRecord, catalogues: Catalogues) -> tuple[SearchedSpace, ...]:
    """Returns the network and the genes of each seed scenario of a campaign.

    Its plug-ins need not be installed: results are read without what made them.

    Raises:
        InvalidDocument: A road network or a model in it is no longer available.
        CampaignError: Its road network has changed since.
        SearchError: Its space can no longer be built.
    """
    document = read_stored(CampaignDocument, record.document)
    seeds = [
        # Any agent: the gene space does not depend on it.
        validate_document(scenario, catalogues.networks, None)
        for scenario in document.seeds.values()
    ]
    networks = {seed.network.name: seed.network for seed in seeds}
    if hash_of_networks(tuple(networks.values())) != record.network_sha256:
        raise CampaignError(
            f"the road network {record.town!r} has changed since campaign {record.id} was made: "
            "its gene space is no longer known; restore the old network, or leave the campaign out"
        )
    options = to_campaign(document).space
    return tuple(
        SearchedSpace(
            network=seed.network,
            space=make_space(seed.scenario, seed.network, options).genes,
        )
        for seed in seeds
    )
