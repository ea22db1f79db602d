"""The parameters of LawBreaker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field


@dataclass(frozen=True, slots=True, kw_only=True)
class LawbreakerParameters:
    """Defaults from Sun et al., "LawBreaker" (ASE 2022); the others are ours.

    Attributes:
        laws: Names of the laws whose sub-violations are searched for; none: all that judge runs.
        population: Number of scenarios of a generation (paper: 20).
        generations: Number of generations after which a new population is drawn (paper: 20).
        crossover_rate: Probability with which a child is crossed with a second parent.
        mutation_rate: Probability with which a child is mutated; one that equals its parent always
            is.
        tournament: Number of scenarios of which the second parent is the one nearest to the
            violation.
    """

    laws: tuple[str, ...] = ()
    population: Annotated[int, Field(ge=2)] = 20
    generations: Annotated[int, Field(ge=1)] = 20
    crossover_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    mutation_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    tournament: Annotated[int, Field(ge=1)] = 2
