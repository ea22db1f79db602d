"""The parameters of DriveFuzz."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivefuzzParameters:
    """Defaults from Kim et al., "DriveFuzz" (CCS 2022), and its public code.

    Attributes:
        cycles: Number of cycles from one seed, unless a violation ends them (paper: 10).
        mutants: Number of mutants of a cycle (paper: 8).
        nearest: Metres from the ego's start at which a new actor appears, at least (code: 5).
        farthest: The same, at most (code: 40).
        patch_chance: Probability with which a mutant gets a slippery patch (code: 0.25).
        weather_chance: Probability with which a mutant gets another weather (ours).
        tries: Number of draws of an actor until it appears within these distances (ours).
    """

    cycles: Annotated[int, Field(ge=1)] = 10
    mutants: Annotated[int, Field(ge=1)] = 8
    nearest: Annotated[float, Field(ge=0.0)] = 5.0
    farthest: Annotated[float, Field(gt=0.0)] = 40.0
    patch_chance: Annotated[float, Field(ge=0.0, le=1.0)] = 0.25
    weather_chance: Annotated[float, Field(ge=0.0, le=1.0)] = 0.25
    tries: Annotated[int, Field(ge=1)] = 50
