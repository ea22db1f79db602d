"""Preparing a process for checking documents.

The first check of a process loads the compiled kernels, which takes half a second; in a new
installation it compiles them, which takes several.
"""

from __future__ import annotations

from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.seeds import generate_seeds
from drivora_service.scenario.validation import validate_document

_AGENT = "idm"


def warm_up_checks(networks: NetworkCatalogue) -> Scenario:
    """Checks a small scenario on the first network and returns it."""
    network = networks.get(networks.names()[0])
    (document,) = generate_seeds(
        network, count=1, min_length=50.0, max_length=300.0, seed=0, agent=_AGENT
    )
    return validate_document(document, networks, (_AGENT,)).scenario
