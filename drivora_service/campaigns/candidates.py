"""From a tester's values to a scenario that can be run, or to what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.genes import GeneSpace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """Values, and the scenario that they stand for.

    Attributes:
        values: (d,) genes, repaired.
        document: Canonical JSON text of the scenario; "" where there is none.
        problem: Why there is none, or "".
    """

    values: FloatArray
    document: str = ""
    problem: str = ""


class Candidates(Protocol):
    """Makes candidates; the same values always give the same candidate."""

    @property
    def genes(self) -> GeneSpace:
        """What can be varied."""
        ...

    def prepare(self, values: FloatArray) -> Candidate:
        """Repairs values (d,), decodes them, and checks the scenario."""
        ...
