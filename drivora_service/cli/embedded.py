"""What commands work with when no service is asked."""

from __future__ import annotations

from pathlib import Path

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.settings import Settings, load_settings


def settings_for(data_dir: Path | None, **overrides: object) -> Settings:
    """Reads the settings; options that were given win over the environment."""
    return load_settings(data_dir=data_dir, **overrides)


def network_catalogue(settings: Settings) -> NetworkCatalogue:
    """Returns the networks that are shipped and those that were imported here."""
    return NetworkCatalogue(shipped_networks(), settings.imported_networks_dir)
