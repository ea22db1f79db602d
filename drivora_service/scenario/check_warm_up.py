"""Preparing a process for checking documents.

A process that checks many documents uses compiled kernels. Loading them takes half a second; in a
new installation they are compiled, which takes several.
"""

from __future__ import annotations

from drivora_service.compilation import load_compiler
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document

_AGENT = "idm"


def warm_up_checks(networks: NetworkCatalogue) -> Scenario:
    """Checks a small scenario on the first network and returns it."""
    load_compiler()
    network = networks.get(networks.names()[0])
    (document,) = generate_seeds(
        network, count=1, min_length=50.0, max_length=300.0, seed=0, agent=_AGENT
    )
    return validate_document(document, networks, (_AGENT,)).scenario
