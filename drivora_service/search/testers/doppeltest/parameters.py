"""The parameters of DoppelTest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.search.budget_bounds import within_budget
from drivora_service.search.redrawing import ATTEMPTS, MOST_ATTEMPTS

Share = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class DoppelTestParameters:
    """Defaults are those of the paper, and of its public code where the paper is silent.

    Attributes:
        population: Number of candidates that survive a generation (mu).
        offspring: Number of candidates of a generation (lambda).
        crossover: Probability with which a child has two parents; all others are mutants of one.
        cross_egos: Share of the crossovers that concern the egos.
        cross_walkers: Share of the crossovers that concern the walkers; the rest, the lights.
        remove_ego: Probability with which a mutation of the egos removes one.
        add_ego: Probability with which it adds one; else it redraws place and time of a start.
        remove_walker: Probability with which a mutation of the walkers removes one.
        add_walker: Probability with which it adds one; else it redraws how and when one walks.
        redraws: Number of mutants that are drawn again for one candidate, at most, as they could
            not change the run of any ego (ours; paper and code: 0).
    """

    population: Annotated[int, within_budget(2)] = 10
    offspring: Annotated[int, within_budget(1)] = 10
    crossover: Share = 0.8
    cross_egos: Share = 0.6
    cross_walkers: Share = 0.2
    remove_ego: Share = 0.1
    add_ego: Share = 0.3
    remove_walker: Share = 0.2
    add_walker: Share = 0.2
    redraws: Annotated[int, Field(ge=0, le=MOST_ATTEMPTS)] = ATTEMPTS
