"""The candidates of a campaign, from the side of its search."""

from __future__ import annotations

from typing import Protocol

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.runs.candidate import Candidate, Reference, SpaceSource
from drivora_service.search.genes import GeneSpace


class Candidates(Protocol):
    """The space of the candidates; the same values always give the same candidate."""

    @property
    def genes(self) -> GeneSpace:
        """The genes of the candidates."""
        ...

    @property
    def source(self) -> SpaceSource:
        """The space as workers get it, which decode the values."""
        ...

    def prepare(self, values: FloatArray, reference: Reference | None = None) -> Candidate:
        """Repairs values (d,), decodes them, and checks the scenario, as workers do."""
        ...
