"""Settings of a command, and the catalogues of this installation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.oracles.laws.sources import read_law_sources
from drivora_service.settings import Settings, load_settings

if TYPE_CHECKING:
    from drivora_service.campaigns.document.campaign_catalogues import Catalogues
    from drivora_service.networks.catalogue import NetworkCatalogue
    from drivora_service.oracles.catalogue import OracleCatalogue


def settings_for(data_dir: Path | None, **overrides: object) -> Settings:
    """Reads the settings; options that were given win over the environment."""
    return load_settings(data_dir=data_dir, **overrides)


def network_catalogue(settings: Settings) -> NetworkCatalogue:
    """Returns the networks that are shipped and those that were imported here."""
    from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks

    return NetworkCatalogue(shipped_networks(), settings.imported_networks_dir)


def catalogues_for(data_dir: Path | None) -> Catalogues:
    """Returns the catalogues of this installation and a data folder."""
    from drivora_service.campaigns.document.campaign_catalogues import Catalogues

    settings = settings_for(data_dir)
    return Catalogues(
        network_catalogue(settings), settings.agents_folder, read_law_sources(settings.laws_folder)
    )


def oracle_catalogue(settings: Settings) -> OracleCatalogue:
    """Returns the oracles of this installation, with the user's traffic laws."""
    from drivora_service.oracles.catalogue import OracleCatalogue

    return OracleCatalogue(read_law_sources(settings.laws_folder))
