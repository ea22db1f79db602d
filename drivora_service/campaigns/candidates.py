"""Candidates: a tester's values and their scenario, or the reason that there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.genes import GeneSpace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """Values, and the scenario that they encode.

    Attributes:
        values: (d,) genes, repaired.
        document: Canonical JSON text of the scenario; "" if there is none.
        problem: Why there is none, or "".
    """

    values: FloatArray
    document: str = ""
    problem: str = ""


class Candidates(Protocol):
    """Makes candidates; the same values always give the same candidate."""

    @property
    def genes(self) -> GeneSpace:
        """The genes of the candidates."""
        ...

    def prepare(self, values: FloatArray) -> Candidate:
        """Repairs values (d,), decodes them, and checks the scenario."""
        ...
