"""Parameters of the agent that overtakes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from drivora_service.agents.idm.parameters import SpeedFactor


@dataclass(frozen=True, slots=True, kw_only=True)
class MobilParameters:
    """Parameters of the agent.

    Attributes:
        speed_factor: Share of the speed limit that it drives where the road is free.
        politeness: Weight of what a lane change gains or costs others; 0 is an egoist.
        safe_braking: The hardest that the one behind may have to brake, m/s².
        threshold: What a lane change must gain, m/s².
        bias: What the lane to the right is worth more, m/s².
    """

    speed_factor: SpeedFactor = 1.0
    politeness: Annotated[float, Field(ge=0.0, le=1.0)] = 0.2
    safe_braking: Annotated[float, Field(ge=0.5, le=8.0)] = 4.0
    threshold: Annotated[float, Field(ge=0.0, le=2.0)] = 0.1
    bias: Annotated[float, Field(ge=0.0, le=2.0)] = 0.3
