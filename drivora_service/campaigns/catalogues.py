"""The catalogues for the names in a campaign."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.oracles.catalogue import OracleCatalogue
from drivora_service.search.catalogue import TesterCatalogue


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogues:
    """Catalogues of everything that a campaign may name."""

    networks: NetworkCatalogue
    agents: AgentCatalogue
    testers: TesterCatalogue
    oracles: OracleCatalogue


def installed_catalogues(networks: NetworkCatalogue, agents: Path | None = None) -> Catalogues:
    """Returns the catalogues of this installation, with these networks.

    Args:
        networks: The road networks.
        agents: Folder of installed agents and of the operator's manifests.
    """
    return Catalogues(
        networks=networks,
        agents=AgentCatalogue(folder=agents),
        testers=TesterCatalogue(),
        oracles=OracleCatalogue(),
    )
