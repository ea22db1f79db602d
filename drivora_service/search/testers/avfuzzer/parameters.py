"""The parameters of AVFuzzer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.search.redrawing import ATTEMPTS


@dataclass(frozen=True, slots=True, kw_only=True)
class AvfuzzerParameters:
    """Defaults from Li et al., "AV-FUZZER" (ISSRE 2020), and its public code.

    Attributes:
        population: Number of scenarios of a generation (paper: 4).
        crossover_rate: Probability with which a pair exchanges an actor (paper: 0.4).
        mutation_rate: Probability with which a scenario is mutated (paper: 0.4).
        stall: Number of generations over which the mean of the best costs is taken; if it is no
            worse than the best cost of the next generation, the search restarts (code: 5).
        restart_candidates: Number of scenarios drawn at a restart; those furthest from all past
            populations become the next one (code: 1,000).
        local_after: Number of generations after a start or restart without local searches
            (code: 2).
        local_generations: Number of generations of a local search (code: 5).
        local_factor: Mutation rate of a local search over that of the search (code: 1.5).
        local_mutates_all: Whether a local search begins by mutating all its copies (code: yes); if
            not, its first generation is bred as every other (paper).
        redraws: Number of mutants that are drawn again for one candidate, at most, as they could
            not change the run of any ego (ours; paper and code: 0).
    """

    population: Annotated[int, Field(ge=2)] = 4
    crossover_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.4
    mutation_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.4
    stall: Annotated[int, Field(ge=1)] = 5
    restart_candidates: Annotated[int, Field(ge=1)] = 1000
    local_after: Annotated[int, Field(ge=0)] = 2
    local_generations: Annotated[int, Field(ge=0)] = 5
    local_factor: Annotated[float, Field(ge=0.0)] = 1.5
    local_mutates_all: bool = True
    redraws: Annotated[int, Field(ge=0)] = ATTEMPTS
