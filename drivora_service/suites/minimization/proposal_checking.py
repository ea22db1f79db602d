"""Checking proposals: a document that can be run, with the text and hash that identify it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.canonical import canonical_json, from_canonical
from drivora_service.scenario.documents import ScenarioDocument, document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.overrides import with_overrides
from drivora_service.scenario.validation import validate_document


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedDocument:
    """A document that can be run.

    Attributes:
        document: In the network's plane.
        text: Canonical JSON of its scenario.
        sha256: Hash of the text, hexadecimal.
    """

    document: ScenarioDocument
    text: str
    sha256: str


class Checker:
    """Checks documents against the networks and agents of this installation."""

    def __init__(
        self,
        networks: NetworkLookup,
        agents: Mapping[str, str],
        go_on: Callable[[], None] = lambda: None,
    ) -> None:
        """Takes the catalogues.

        Args:
            networks: Road networks.
            agents: Agents, as for :func:`validate_document`.
            go_on: Called before each document that is checked; raises if that is not wanted.
        """
        self._networks, self._agents, self._go_on = networks, agents, go_on
        self._known: dict[str, CheckedDocument | None] = {}

    def __call__(self, document: ScenarioDocument) -> CheckedDocument | None:
        """Returns a document that can be run; ``None`` if it cannot."""
        key = document_text(document)
        if key not in self._known:
            self._go_on()
            self._known[key] = self._validate(document)
        return self._known[key]

    def network_of(self, document: ScenarioDocument) -> RoadNetwork:
        """Returns the road network of a document.

        Raises:
            UnknownName: There is no such network.
        """
        return self._networks.get(document.map_region.town)

    def _validate(self, document: ScenarioDocument) -> CheckedDocument | None:
        try:
            valid = validate_document(document, self._networks, self._agents)
        except InvalidDocument:
            return None
        text = canonical_json(valid.scenario)
        return CheckedDocument(
            document=document, text=text, sha256=hashlib.sha256(text.encode()).hexdigest()
        )


def document_of_run(text: str, *, agent: str, seed: int | None) -> ScenarioDocument:
    """Returns what a run has driven as a document of its own, without overrides.

    Args:
        text: Canonical JSON of the run's scenario.
        agent: Agent that drives every ego instead of the documented ones; "": none.
        seed: Seed instead of the documented one.
    """
    return to_document(with_overrides(from_canonical(text), agent=agent, seed=seed))
