"""Parameters of the intelligent driver model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

SpeedFactor = Annotated[float, Field(ge=0.1, le=2.0)]
ReactionTime = Annotated[float, Field(ge=0.0, le=3.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class IdmParameters:
    """Parameters of the agent.

    Attributes:
        speed_factor: Share of the speed limit that it drives where the road is free.
        reaction_time: Seconds by which it notices later what others and signals do.
    """

    speed_factor: SpeedFactor = 1.0
    reaction_time: ReactionTime = 0.0
