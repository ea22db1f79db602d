"""The parameters of Decictor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

Share = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class DecictorParameters:
    """Defaults from Cheng et al., "Decictor" (ICSE 2025), and its public code.

    Attributes:
        population: Number of scenarios of a generation (paper: 4).
        static_rate: Probability with which obstacles are mutated, and not vehicles and walkers, if
            the space has both (code: 0.5).
        most_added: Greatest number of obstacles that are added at a time; of vehicles and walkers
            it is 1 (code: 4).
        removed_share: Share of the present actors that are removed if none can be added, at least
            one (code: 0.2).
        change_rate: Probability with which each present actor is changed a little (code: 0.5).
        sigma: Standard deviation of such a change, as a share of a gene's range.
        reference_tries: Number of times that the reference is drawn again if an ego does not
            arrive, where the space varies more than actors that may be absent.
    """

    population: Annotated[int, Field(ge=1)] = 4
    static_rate: Share = 0.5
    most_added: Annotated[int, Field(ge=1)] = 4
    removed_share: Share = 0.2
    change_rate: Share = 0.5
    sigma: Annotated[float, Field(gt=0.0)] = 0.05
    reference_tries: Annotated[int, Field(ge=0)] = 10
