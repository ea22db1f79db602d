"""Whether a candidate's scenario is one that may be run, by the validation of all documents."""

from __future__ import annotations

from collections.abc import Collection

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import validate_document


def find_problems(
    scenario: Scenario, networks: NetworkCatalogue, agents: Collection[str]
) -> tuple[Problem, ...]:
    """Gives what is wrong with a scenario; nothing where it may be run.

    Args:
        scenario: As decoded.
        networks: Where its town is looked up.
        agents: Names of the agents that exist.
    """
    try:
        validate_document(to_document(scenario), networks, agents)
    except InvalidDocument as error:
        return error.problems
    return ()
