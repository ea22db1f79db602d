"""A valid document, the shipped networks, and validation on them."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.documents import parse_document
from drivora_service.scenario.validation import ValidScenario, validate_document

AGENTS = ("idm", "sumo-krauss")

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


@pytest.fixture
def valid(networks: NetworkCatalogue) -> Any:
    """Validates a document."""

    def validate(content: dict[str, Any]) -> ValidScenario:
        return validate_document(parse_document(content), networks, AGENTS)

    return validate


@pytest.fixture
def refused(networks: NetworkCatalogue) -> Any:
    """Returns the problems of a document."""

    def problems(content: dict[str, Any]) -> tuple[Problem, ...]:
        with pytest.raises(InvalidDocument) as caught:
            validate_document(parse_document(content), networks, AGENTS)
        return caught.value.problems

    return problems
