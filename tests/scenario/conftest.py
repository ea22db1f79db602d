"""A valid document and the shipped networks."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from drivora_service.networks.catalogue import NetworkCatalogue

GOOD: dict[str, Any] = {
    "version": "1.0",
    "frame": "sumo",
    "ego_vehicles": [
        {
            "id": "ego_0",
            "model": "vehicle.lincoln.mkz_2017",
            "route": [{"x": 100.0, "y": 152.1}, {"x": 30.0, "y": 153.2}],
            "agent": {"name": "idm"},
        }
    ],
    "map_region": {"town": "tee-town"},
}


@pytest.fixture
def good() -> dict[str, Any]:
    """A small valid document, to be changed by the test."""
    return copy.deepcopy(GOOD)


@pytest.fixture(scope="session")
def networks(repository: Path) -> NetworkCatalogue:
    """The shipped networks."""
    return NetworkCatalogue(repository / "sumo_nets")
