"""The parameters of SAMOTA."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.search.budget_bounds import MANY, within_budget

Share = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class SamotaParameters:
    """Defaults from Ul Haq et al., "SAMOTA" (ICSE 2022), and MOSA, which it builds upon.

    "MOSA" is Panichella et al. (ICST 2015) with its tool; where nothing is named, the value is
    ours. The reference page says why.

    Attributes:
        initial: Number of candidates of the adaptive random initialisation.
        pool: Number of random draws of which the initialisation takes the one farthest from all
            before (Chen et al., "Adaptive random testing", 2004: 10).
        threshold: Value of an objective at and below which it is covered (feedback: 0).
        population: Number of candidates of a population on the surrogates (MOSA: 50).
        generations: Number of generations of the global search on the surrogates.
        seeded: Share of the first population taken from the simulated candidates nearest to a
            violation (SAMOTA: 0).
        crossover: Probability with which two parents exchange genes (MOSA, SAMOTA: 0.75).
        tournament: Number of candidates of which a parent is the best (MOSA, SAMOTA: 10).
        step: Standard deviation of a magnitude's change as a share of its range.
        training: Greatest number of evaluations to train the global surrogates with.
        folds: Parts of the training set, each predicted from the others to weight the surrogates.
        components: Number of latent directions of the inputs for Kriging (Bouhlel et al., 2016: 1
            to 4).
        top: Share of the evaluations, nearest to a violation, that is clustered (SAMOTA: 0.2).
        cluster: Least size of a cluster (HDBSCAN: 5).
        local_generations: Number of generations of the search inside a cluster.
        local_population: Number of candidates of that search.
    """

    initial: Annotated[int, within_budget(1)] = 30
    pool: Annotated[int, Field(ge=1, le=1000)] = 10
    threshold: float = 0.0
    population: Annotated[int, Field(ge=4, le=1000)] = 50
    generations: Annotated[int, Field(ge=1, le=1000)] = 20
    seeded: Share = 0.5
    crossover: Share = 0.75
    tournament: Annotated[int, Field(ge=1, le=1000)] = 10
    step: Annotated[float, Field(ge=0.0)] = 0.1
    training: Annotated[int, Field(ge=20, le=2000)] = 200
    folds: Annotated[int, Field(ge=2, le=100)] = 3
    components: Annotated[int, Field(ge=1, le=100)] = 4
    top: Share = 0.2
    cluster: Annotated[int, Field(ge=2, le=MANY)] = 5
    local_generations: Annotated[int, Field(ge=1, le=1000)] = 20
    local_population: Annotated[int, Field(ge=4, le=1000)] = 20
