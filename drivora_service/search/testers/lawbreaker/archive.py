"""The scenarios nearest to each sub-violation that no run has covered yet."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from drivora_service.feedback.lawbreaker import law_of
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.aims import Aim
from drivora_service.search.tester import Evaluation

_COVERED = -1.0
"""Cost of a chosen objective that has reached its target."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Individual:
    """A measured scenario.

    Attributes:
        values: (d,) genes.
        costs: Negated robustness by sub-violation, or the shares of objectives that the campaign
            chose by their names: below 0 it is covered.
        number: Number of its evaluation.
    """

    values: FloatArray
    costs: Mapping[str, float]
    number: int


class Archive:
    """Keeps, for each uncovered sub-violation, the scenario nearest to it."""

    def __init__(self, laws: Collection[str], aims: Sequence[Aim] = ()) -> None:
        """Creates an empty archive.

        Args:
            laws: Laws whose sub-violations count; none: all.
            aims: Objectives that the campaign chose in place of sub-violations.
        """
        self._laws = frozenset(laws)
        self._aims = tuple(aims)
        self._nearest: dict[str, Individual] = {}
        self._covered: set[str] = set()

    def individual(self, evaluation: Evaluation) -> Individual | None:
        """Returns the individual of an evaluation; ``None`` if it was not measured."""
        if evaluation.measurement is None:
            return None
        costs = self._costs(evaluation.measurement.objectives)
        if not costs:
            return None
        return Individual(values=evaluation.proposal.values, costs=costs, number=evaluation.number)

    def _costs(self, objectives: Mapping[str, float | None]) -> dict[str, float]:
        if self._aims:
            values = {aim: objectives[aim.name] for aim in self._aims}
            return {
                aim.name: _COVERED if aim.is_reached(value) else aim.share(value)
                for aim, value in values.items()
                if value is not None
            }
        return {
            name: cost
            for name, cost in objectives.items()
            if cost is not None and (not self._laws or law_of(name) in self._laws)
        }

    def add(self, individual: Individual) -> None:
        """Retires the sub-violations that a scenario covers, and keeps it where it is nearest.

        Of equally near scenarios the first is kept.
        """
        for name, cost in individual.costs.items():
            if name in self._covered:
                continue
            if cost < 0.0:
                self._covered.add(name)
                self._nearest.pop(name, None)
            elif name not in self._nearest or cost < self._nearest[name].costs[name]:
                self._nearest[name] = individual

    @property
    def covered(self) -> frozenset[str]:
        """The sub-violations that some scenario has covered."""
        return frozenset(self._covered)

    @property
    def nearest(self) -> Mapping[str, Individual]:
        """The scenario nearest to each uncovered sub-violation, in the order of the laws."""
        return self._nearest
